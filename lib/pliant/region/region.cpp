#include "pliant/region/region.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// The region that force k acts in; -1: in none.
int region_of(const Selection& selection, std::size_t k, Combine how) {
  if (selection.regions.empty()) return -1;
  if (how != Combine::Islands) return 0;
  const auto selector = static_cast<std::size_t>(selection.forces[k].selector);
  const Box& own = selection.forces[selector].deformation;
  if (own.is_empty()) return -1;
  const auto found =
      std::find_if(selection.regions.begin(), selection.regions.end(),
                   [&](const Region& region) { return region.box.contains(own.i0, own.j0); });
  PLIANT_EXPECTS(found != selection.regions.end());
  return static_cast<int>(found - selection.regions.begin());
}

// Calls f(load) with what the force gives to each interior node in its box, until f says false.
template <class F>
void visit_loads(const Grid& grid, const Field& nodes, const SampledForce& force, const Box& box,
                 std::span<const Patch> patches, const F& f) {
  for (const Patch& patch : patches) {
    const Box inside = intersection(patch.box, box);
    for (int j = inside.j0; j <= inside.j1; ++j) {
      for (int i = inside.i0; i <= inside.i1; ++i) {
        if (!patch.holds(i, j)) continue;
        if (!f(force_at(force, nodes.row(grid.node(i, j)).transpose()))) return;
      }
    }
  }
}

}  // namespace

Selection recombined(Selection selection, Combine how, std::span<const Box> others) {
  std::vector<Box> boxes(others.begin(), others.end());
  for (const ForceSelection& force : selection.forces) boxes.push_back(force.deformation);
  selection.regions = combine(boxes, how);
  selection.region = {};
  for (const Region& region : selection.regions) selection.region.include(region.box);
  for (std::size_t k = 0; k < selection.forces.size(); ++k) {
    selection.forces[k].region = region_of(selection, k, how);
  }
  return selection;
}

Selection select_region(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces,
                        Combine how, std::span<const int> selectors) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  PLIANT_EXPECTS(selectors.empty() || selectors.size() == forces.size());
  Selection selection;
  selection.forces.reserve(forces.size());
  for (const SampledForce& force : forces) {
    ForceSelection selected;
    const std::size_t k = selection.forces.size();
    selected.selector = selectors.empty() ? static_cast<int>(k) : selectors[k];
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const double delta = distance(force.shape, nodes.row(grid.node(i, j)).transpose());
        if (delta < force.deformation_radius) selected.deformation.include(i, j);
        if (delta < force.force_radius) selected.force.include(i, j);
      }
    }
    selection.forces.push_back(selected);
  }
  return recombined(std::move(selection), how);
}

bool overlaps(const Region& region, const Box& force) {
  return std::any_of(region.parts.begin(), region.parts.end(),
                     [&](const Box& part) { return !intersection(part, force).is_empty(); });
}

Field assemble_load(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces,
                    const Selection& selection, std::size_t region) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  PLIANT_EXPECTS(selection.forces.size() == forces.size() && region < selection.regions.size());
  const Box& all = selection.regions[region].box;
  Field load = Field::Zero(Eigen::Index{all.columns()} * all.rows(), 3);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (selection.forces[k].region != static_cast<int>(region)) continue;
    const Box box = intersection(all, selection.forces[k].force);
    for (int j = box.j0; j <= box.j1; ++j) {
      for (int i = box.i0; i <= box.i1; ++i) {
        const int row = (j - all.j0) * all.columns() + (i - all.i0);
        load.row(row) += force_at(forces[k], nodes.row(grid.node(i, j)).transpose()).transpose();
      }
    }
  }
  return load;
}

Push push_of(const Grid& grid, const Field& nodes, const SampledForce& force, const Box& box,
             std::span<const Patch> patches) {
  Push push;
  visit_loads(grid, nodes, force, box, patches, [&](const Vector3d& load) {
    push.sum += load;
    push.node_count += !load.isZero(0);
    return true;
  });
  return push;
}

bool pushes(const Grid& grid, const Field& nodes, const SampledForce& force, const Box& box,
            std::span<const Patch> patches) {
  if (force.magnitude == 0) return false;
  bool is_felt = false;
  visit_loads(grid, nodes, force, box, patches, [&](const Vector3d& load) {
    is_felt = !load.isZero(0);
    return !is_felt;
  });
  return is_felt;
}

}  // namespace pliant
