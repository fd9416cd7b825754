#include "pliant/region/region.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/region/box_places.hpp"
#include "pliant/region/closed_boxes.hpp"

namespace pliant {
namespace {

// The region that each force acts in; -1: none.
void find_regions_of_forces(Selection& selection, Combine how) {
  const bool is_one = how != Combine::Islands;
  for (ForceSelection& force : selection.forces)
    force.region = is_one && !selection.regions.empty() ? 0 : -1;
  if (is_one) return;
  BoxPlaces places(selection.grid);
  for (std::size_t k = 0; k < selection.regions.size(); ++k)
    places.insert(selection.regions[k].box, static_cast<int>(k));
  for (ForceSelection& force : selection.forces) {
    const auto selector = static_cast<std::size_t>(force.selector);
    const Box& own = selection.forces[selector].deformation;
    if (own.is_empty()) continue;
    const std::vector<int> met = places.meeting(own);
    const auto found = std::ranges::find_if(met, [&](int region) {
      return holds(selection.grid, selection.regions[static_cast<std::size_t>(region)].box, own);
    });
    PLIANT_EXPECTS(found != met.end());
    force.region = *found;
  }
}

// Lists the forces of each region.
void list_forces(Selection& selection) {
  std::vector<int>& starts = selection.member_starts;
  starts.assign(selection.regions.size() + 1, 0);
  for (const ForceSelection& force : selection.forces) {
    if (force.region >= 0) ++starts[static_cast<std::size_t>(force.region) + 1];
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<int> next(starts.begin(), starts.end() - 1);
  selection.members.resize(static_cast<std::size_t>(starts.back()));
  for (std::size_t k = 0; k < selection.forces.size(); ++k) {
    const int region = selection.forces[k].region;
    if (region < 0) continue;
    selection.members[next[static_cast<std::size_t>(region)]++] = static_cast<int>(k);
  }
}

// Calls f(load) with this force's load on each interior node in its box, until f returns false. The
// loads of a program's own force are computed for `at_once` nodes, and for more each time.
template <class F>
void visit_loads(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force,
                 const Box& box, std::span<const Patch> patches, std::size_t at_once, const F& f) {
  bool goes_on = true;
  std::vector<int> asked;
  const auto ask = [&] {
    const std::vector<Vector3d> loads = nodes.loads_on(asked, force);
    goes_on = std::ranges::all_of(loads, f);
    asked.clear();
    at_once = std::min(32 * at_once, most_asked);
  };
  for (const Patch& patch : patches) {
    for_each_shared(grid, patch.box, box, [&](const Box& inside) {
      for (int j = inside.j0; j <= inside.j1 && goes_on; ++j) {
        for (int i = inside.i0; i <= inside.i1 && goes_on; ++i) {
          if (!patch.holds(i, j)) continue;
          const int node = grid.node_round(i, j);
          if (is_own(force)) {
            asked.push_back(node);
            if (asked.size() == at_once) ask();
          } else {
            goes_on = f(nodes.load_on(node, force));
          }
        }
      }
    });
    if (!goes_on) return;
  }
  if (!asked.empty()) ask();
}

// The box of the nodes found so far, in an open grid.
class OpenReach {
 public:
  explicit OpenReach(const Grid&) {}

  const Box& box() const { return box_; }
  bool covers(const Box& nodes) const { return holds(box_, nodes); }

  // Extends it by those nodes of a row, from (i,j) on, whose distance is less than the radius.
  void include_near(const double* distance, int count, double radius, int i, int j) {
    int first = 0;
    while (first < count && !(distance[first] < radius)) ++first;
    if (first == count) return;
    int last = count - 1;
    while (!(distance[last] < radius)) --last;
    box_.include({i + first, i + last, j, j});
  }

 private:
  Box box_;
};

// The same in a closed grid, where the box is known when all nodes are: it leaves out the longest
// gap.
class ClosedReach {
 public:
  explicit ClosedReach(const Grid& grid) : lines_(grid) {}

  Box box() const { return lines_.box(); }
  bool covers(const Box& nodes) const { return lines_.holds(nodes); }

  void include_near(const double* distance, int count, double radius, int i, int j) {
    for (int k = 0; k < count; ++k) {
      if (distance[k] < radius) lines_.include(i + k, j);
    }
  }

 private:
  LineMarks lines_;
};

// The two boxes of a force, grown tile by tile. A tile that is out of reach, or inside a box
// already, adds nothing to that box, so for a large box few nodes besides its rim are visited.
template <class Reach>
class Selecting {
 public:
  Selecting(const NodeTiles& tiles, const SampledForce& force)
      : tiles_(tiles), force_(force), deformation_(tiles.grid()), pushed_(tiles.grid()) {}

  ForceSelection boxes() {
    run();
    ForceSelection boxes;
    boxes.deformation = deformation_.box();
    boxes.force = pushed_.box();
    return boxes;
  }

 private:
  void run() {
    if (is_own(force_)) {
      ask_all();
      return;
    }
    for (const NodeTiles::Tile& tile : tiles_.tiles()) {
      const double least = least_distance(force_.kind, tile.low, tile.high);
      if (!may_add(tile.box, least)) continue;
      for (int j = tile.box.j0; j <= tile.box.j1; ++j) {
        const Box row{tile.box.i0, tile.box.i1, j, j};
        if (may_add(row, least)) look_at(row);
      }
    }
  }

  // In the order of the nodes: the first unsound answer is the one that is reported.
  void ask_all() {
    const Grid& grid = tiles_.grid();
    const int rows_at_once =
        std::max(1, static_cast<int>(asked_at_once(force_.kind)) / grid.columns);
    std::vector<int> nodes;
    std::vector<double> distance;
    for (int j0 = 0; j0 < grid.rows; j0 += rows_at_once) {
      const int rows = std::min(rows_at_once, grid.rows - j0);
      nodes.resize(std::size_t(rows) * std::size_t(grid.columns));
      std::iota(nodes.begin(), nodes.end(), grid.node(0, j0));
      distance = tiles_.nodes().distances(nodes, force_.kind, std::move(distance));
      for (int row = 0; row < rows; ++row)
        include_near(distance.data() + std::size_t(row) * std::size_t(grid.columns),
                     {0, grid.columns - 1, j0 + row, j0 + row});
    }
  }

  // Whether nodes of `box`, at a distance of `least` or more, can extend one of the boxes.
  bool may_add(const Box& box, double least) const {
    return (least < force_.deformation_radius && !deformation_.covers(box)) ||
           (least < force_.force_radius && !pushed_.covers(box));
  }

  void look_at(const Box& row) {
    const int node = tiles_.grid().node(row.i0, row.j0);
    const Batch points = tiles_.nodes().batch(node, row.columns());
    include_near(distances(force_.kind, points).of, row);
  }

  void include_near(const double* distance, const Box& row) {
    const int count = row.columns();
    deformation_.include_near(distance, count, force_.deformation_radius, row.i0, row.j0);
    pushed_.include_near(distance, count, force_.force_radius, row.i0, row.j0);
  }

  const NodeTiles& tiles_;
  const SampledForce& force_;
  Reach deformation_, pushed_;
};

// The loads of forces that take many nodes, on those of a box. They are asked for all at once, or
// for as many rows as `most_kept` allows.
class OwnLoads {
 public:
  OwnLoads(const Grid& grid, const PlacedNodes& nodes, std::span<const SampledForce> forces,
           const Selection& selection, std::size_t region, const Box& box)
      : grid_(grid), nodes_(nodes), forces_(forces), selection_(selection), box_(box), strip_(box) {
    constexpr std::size_t most_kept = std::size_t{1} << 20U;
    strip_.j1 = box.j0 - 1;
    for (const int k : selection.forces_of(region))
      if (takes_many(forces[k].kind)) own_.push_back({k, {}});
    const std::size_t most =
        std::min(most_asked, most_kept / std::max<std::size_t>(own_.size(), 1));
    rows_at_once_ = std::max(1, static_cast<int>(most) / box.columns());
  }

  // Asks for the loads on row `j`, unless they are there. Requires: j is the next row, or there.
  void ask(int j) {
    if (own_.empty() || j <= strip_.j1) return;
    strip_.j0 = j;
    strip_.j1 = std::min(j + rows_at_once_ - 1, box_.j1);
    for (Own& own : own_) {
      std::vector<int> asked;
      std::vector<std::size_t> places;
      for_each_shared(grid_, strip_, selection_.forces[own.force].force, [&](const Box& inside) {
        for (int row = inside.j0; row <= inside.j1; ++row) {
          for (int i = inside.i0; i <= inside.i1; ++i) {
            asked.push_back(grid_.node_round(i, row));
            places.push_back(place(i, row));
          }
        }
      });
      const std::vector<Vector3d> loads = nodes_.loads_on(asked, forces_[own.force]);
      own.loads.resize(std::size_t(strip_.columns()) * std::size_t(strip_.rows()));
      for (std::size_t n = 0; n < loads.size(); ++n) own.loads[places[n]] = loads[n];
    }
  }

  // Adds those of the n-th of these forces on a row of nodes to `sums`, from index `first` on.
  void add(std::size_t n, const Box& row, int first, Batch& sums) const {
    const Vector3d* const loads = own_[n].loads.data() + place(row.i0, row.j0);
    for (int k = 0; k < row.columns(); ++k) {
      sums.x[first + k] += loads[k].x();
      sums.y[first + k] += loads[k].y();
      sums.z[first + k] += loads[k].z();
    }
  }

 private:
  struct Own {
    int force;
    std::vector<Vector3d> loads;  // on the strip, row by row; only those in its force box are set
  };

  std::size_t place(int i, int j) const {
    return std::size_t(j - strip_.j0) * std::size_t(strip_.columns()) + std::size_t(i - strip_.i0);
  }

  const Grid& grid_;
  const PlacedNodes& nodes_;
  std::span<const SampledForce> forces_;
  const Selection& selection_;
  Box box_, strip_;
  int rows_at_once_ = 1;
  std::vector<Own> own_;
};

// The load on the nodes of a row, from (i,j) on, by the forces of one region; world space.
// Requires: they do not cross a seam; `own` has them.
Batch loads_on(const Grid& grid, const PlacedNodes& nodes, std::span<const SampledForce> forces,
               const Selection& selection, std::size_t region, const OwnLoads& own, int i, int j,
               int count) {
  Batch load;
  load.count = count;
  for (double* component : {load.x, load.y, load.z}) std::fill_n(component, count, 0.0);
  std::size_t own_count = 0;
  for (const int k : selection.forces_of(region)) {
    const ForceSelection& selected = selection.forces[k];
    const Box row{i, i + count - 1, j, j};
    if (takes_many(forces[k].kind)) {
      for_each_shared(grid, row, selected.force,
                      [&](const Box& pushed) { own.add(own_count, pushed, pushed.i0 - i, load); });
      ++own_count;
      continue;
    }
    for_each_shared(grid, row, selected.force, [&](const Box& pushed) {
      nodes.add_loads(grid.node_round(pushed.i0, j), pushed.columns(), forces[k], pushed.i0 - i,
                      load);
    });
  }
  return load;
}

// Calls f(row, load) with the load on the nodes of a box, from `loads_on`, for up to batch_size
// nodes at a time; `row` is counted within the box.
template <class F>
void visit_load_rows(const Grid& grid, const PlacedNodes& nodes,
                     std::span<const SampledForce> forces, const Selection& selection,
                     std::size_t region, const Box& box, const F& f) {
  PLIANT_EXPECTS(nodes.count() == grid.node_count());
  PLIANT_EXPECTS(selection.forces.size() == forces.size() && region < selection.regions.size());
  OwnLoads own(grid, nodes, forces, selection, region, box);
  for (int j = box.j0; j <= box.j1; ++j) {
    own.ask(j);
    for (int i = box.i0; i <= box.i1;) {
      const int end = i < grid.columns ? std::min(box.i1 + 1, grid.columns) : box.i1 + 1;
      const int count = std::min(batch_size, end - i);
      f(Eigen::Index{j - box.j0} * box.columns() + (i - box.i0),
        loads_on(grid, nodes, forces, selection, region, own, i, j, count));
      i += count;
    }
  }
}

}  // namespace

Box Selection::box() const {
  Box all;
  if (grid.is_open()) {
    for (const Region& region : regions) all.include(region.box);
    return all;
  }
  std::vector<Box> boxes;
  for (const Region& region : regions) boxes.push_back(region.box);
  return box_around(grid, boxes);
}

std::span<const Patch> Selection::patches_of_force(std::size_t k) const {
  const int region = forces[k].region;
  if (region < 0) return {};
  return regions[static_cast<std::size_t>(region)].patches;
}

Selection recombined(Selection selection, Combine how, std::vector<Box> others) {
  std::vector<Box> boxes = others;
  for (const ForceSelection& force : selection.forces) boxes.push_back(force.deformation);
  selection.others = std::move(others);
  selection.regions = combine(boxes, how, selection.grid);
  find_regions_of_forces(selection, how);
  list_forces(selection);
  return selection;
}

ForceSelection boxes_of(const NodeTiles& tiles, const SampledForce& force) {
  if (tiles.grid().is_open()) return Selecting<OpenReach>(tiles, force).boxes();
  return Selecting<ClosedReach>(tiles, force).boxes();
}

Selection reselected(Selection earlier, const NodeTiles& tiles,
                     std::span<const SampledForce> forces, Combine how,
                     std::span<const int> selectors, std::span<const Box> others) {
  PLIANT_EXPECTS(selectors.empty() || selectors.size() == forces.size());
  Selection selection = std::move(earlier);
  bool are_same = selection.forces.size() == forces.size() &&
                  std::ranges::equal(selection.others, others) &&
                  (others.empty() || !selection.regions.empty());
  selection.grid = tiles.grid();
  selection.forces.resize(forces.size());
  for (std::size_t k = 0; k < forces.size(); ++k) {
    ForceSelection& selected = selection.forces[k];
    ForceSelection now = boxes_of(tiles, forces[k]);
    now.selector = selectors.empty() ? static_cast<int>(k) : selectors[k];
    now.region = selected.region;
    are_same =
        are_same && now.deformation == selected.deformation && now.selector == selected.selector;
    selected = now;
  }
  if (are_same) return selection;
  return recombined(std::move(selection), how, {others.begin(), others.end()});
}

bool overlaps(const Grid& grid, const Region& region, const Box& force) {
  return std::any_of(region.parts.begin(), region.parts.end(),
                     [&](const Box& part) { return meet(grid, part, force); });
}

Field assemble_load(const Grid& grid, const PlacedNodes& nodes,
                    std::span<const SampledForce> forces, const Selection& selection,
                    std::size_t region, const Box& box, const Matrix3d& to_object, Field reuse) {
  reuse.resize(Eigen::Index{box.columns()} * box.rows(), 3);
  visit_load_rows(grid, nodes, forces, selection, region, box,
                  [&](Eigen::Index row, const Batch& part) {
                    for (int k = 0; k < 3; ++k) {
                      const double ax = to_object(k, 0), ay = to_object(k, 1), az = to_object(k, 2);
                      double* const to = &reuse(row, k);
                      for (int n = 0; n < part.count; ++n)
                        to[n] = part.x[n] * ax + part.y[n] * ay + part.z[n] * az;
                    }
                  });
  return reuse;
}

Push push_of(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
             std::span<const Patch> patches) {
  Push push;
  visit_loads(grid, nodes, force, box, patches, most_asked, [&](const Vector3d& load) {
    push.sum += load;
    push.node_count += !load.isZero(0);
    return true;
  });
  return push;
}

bool pushes(const Grid& grid, const PlacedNodes& nodes, const SampledForce& force, const Box& box,
            std::span<const Patch> patches) {
  if (force.magnitude == 0) return false;
  bool is_felt = false;
  const std::size_t at_once = takes_many(force.kind) ? 32 : 1;  // a call costs more than some loads
  visit_loads(grid, nodes, force, box, patches, at_once, [&](const Vector3d& load) {
    is_felt = !load.isZero(0);
    return !is_felt;
  });
  return is_felt;
}

}  // namespace pliant
