#include "pliant/region/triangles/triangle_cut.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stoppable_sort.hpp"

namespace pliant {
namespace {

using Place = std::array<double, 2>;

Place on_the_way(const Place& a, const Place& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
}

// A side of a cell that may share its slope with others. Those with the same line do: an edge of
// faces, the way from a corner to the centre of its face, or one inside a triangle.
struct Joint {
  int line = 0;
  int cell = 0;
  int side = 0;
};

// The most triangles of a face that form a block: eliminating within one takes the cube of that.
constexpr int most_in_block = 8;

// Of a side on the rim of the region: its slope is given.
constexpr int no_line = -1;

struct Point {
  int node = -1;  // index into the level set's nodes; -1: none
  CutPoint cut = {};
  bool is_free = false;
};

// The cells of a region, before they are separated into patches. Points are numbered in the order
// in which cells meet them.
class Cutting {
 public:
  Cutting(const TriangleSurface& surface, const LevelSet& level_set,
          const std::vector<bool>& is_border, Border border, std::span<const std::uint8_t> held)
      : surface_(surface),
        level_set_(level_set),
        is_border_(is_border),
        border_(border),
        held_(held),
        node_points_(level_set.nodes.size(), -1),
        lines_(
            std::make_unique_for_overwrite<int[]>(static_cast<std::size_t>(surface.edge_count()))) {
    const auto each_edge = [&](const auto& f) {
      for (const int face : level_set.faces) {
        for (const int edge : surface.edges_of(face)) f(edge);
      }
    };
    each_edge([&](int edge) { lines_[edge] = -1; });
    each_edge([&](int edge) {
      if (lines_[edge] < 0) edges_.push_back(edge);
      lines_[edge] = 0;
    });
    std::sort(edges_.begin(), edges_.end());
    for (std::size_t k = 0; k < edges_.size(); ++k) lines_[edges_[k]] = static_cast<int>(k);
    // One line for each edge and each corner's way to the centre.
    rim_points_.assign(edges_.size() + level_set.corners.size(), -1);
    inner_lines_ = static_cast<int>(rim_points_.size());
  }

  // Unfinished if it is stopped.
  void run(StopPoll& poll) {
    for (std::size_t k = 0; k < level_set_.faces.size(); ++k) {
      if (poll.after(1000)) return;
      centre_point_ = -1;
      const int face = level_set_.faces[k];
      const int first = surface_.triangle_starts[face];
      const int count = surface_.triangle_starts[face + 1] - first;
      const std::size_t cells_before = cells.size();
      bool is_whole = 4 <= count && count <= most_in_block;
      for (int n = 0; n < count; ++n)
        is_whole = cut(k, n, surface_.triangles[first + n]) && is_whole;
      for (std::size_t cell = cells_before; cell < cells.size(); ++cell) {
        block_count_ += cell == cells_before || !is_whole ? 1 : 0;
        blocks.push_back(block_count_);
      }
    }
    sort_joints();
  }

  std::vector<Point> points;
  std::vector<TriangleCell> cells;
  std::vector<int> blocks;    // the block of each cell
  std::vector<Joint> joints;  // by line, then by cell

  // How many sides of cells lie on a line if all its triangles have a part in the region there.
  int sides_on(int line) const {
    return line < static_cast<int>(edges_.size()) ? surface_.edge_sides[edges_[line]] : 2;
  }

 private:
  // A triangle while it is cut. Side k goes from corner k to the next.
  struct Triangle {
    std::array<int, 3> ends = {};  // as in CutPoint::of
    std::array<double, 3> phi = {};
    std::array<Place, 3> places = {};
    std::array<int, 3> lines = {};  // of the sides
    int number = 0;                 // of the surface
  };

  struct Corner {
    int point;
    Place place;
  };

  // Whether the whole triangle is one cell.
  bool cut(std::size_t k, int n, const FlatTriangle& shape) {
    const std::span<const int> corners = level_set_.corners_of(k);
    const std::span<const int> edges = surface_.edges_of(level_set_.faces[k]);
    const int size = static_cast<int>(corners.size()), next = (n + 1) % size;
    const int centre = -1 - static_cast<int>(k);
    const int ways = static_cast<int>(edges_.size()) + level_set_.corner_starts[k];
    Triangle triangle;
    triangle.number = surface_.triangle_starts[level_set_.faces[k]] + n;
    if (size == 3) {
      triangle.ends = {corners[0], corners[1], corners[2]};
      triangle.lines = {line_of(edges[0]), line_of(edges[1]), line_of(edges[2])};
    } else {
      triangle.ends = {corners[n], corners[next], centre};
      triangle.lines = {line_of(edges[n]), ways + next, ways + n};
    }
    for (int c = 0; c < 3; ++c) triangle.phi[c] = phi_at(triangle.ends[c]);
    triangle.places = {Place{0, 0}, shape.b, shape.c};

    const auto is_positive = [](double phi) { return phi > 0; };
    const auto is_negative = [](double phi) { return phi < 0; };
    const auto& phi = triangle.phi;
    if (std::none_of(phi.begin(), phi.end(), is_positive)) return false;
    const auto negatives = std::count_if(phi.begin(), phi.end(), is_negative);
    if (negatives == 0) {
      add_cell(triangle, {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)},
               triangle.lines);
    } else if (negatives == 1) {
      cut_off_one(triangle, static_cast<int>(std::find_if(phi.begin(), phi.end(), is_negative) -
                                             phi.begin()));
    } else {
      keep_one(triangle,
               static_cast<int>(std::find_if(phi.begin(), phi.end(), is_positive) - phi.begin()));
    }
    return negatives == 0;
  }

  // Only `corner` lies outside.
  void cut_off_one(const Triangle& triangle, int outer) {
    const int a = (outer + 1) % 3, b = (outer + 2) % 3;
    const Corner at_a = corner(triangle, a), at_b = corner(triangle, b);
    const int ab = triangle.lines[a], from_b = triangle.lines[b], to_a = triangle.lines[outer];
    if (triangle.phi[b] == 0) {
      add_cell(triangle, {at_a, at_b, rim(triangle, a, outer)}, {ab, no_line, to_a});
    } else if (triangle.phi[a] == 0) {
      add_cell(triangle, {at_a, at_b, rim(triangle, b, outer)}, {ab, from_b, no_line});
    } else {
      const Corner from = rim(triangle, b, outer), to = rim(triangle, a, outer);
      Place mean;
      for (int k = 0; k < 2; ++k) {
        mean[k] = 0.25 * (at_a.place[k] + at_b.place[k] + from.place[k] + to.place[k]);
      }
      points.push_back({.cut = {.kind = CutPoint::Kind::Part,
                                .of = {at_a.point, at_b.point, from.point, to.point}},
                        .is_free = true});
      const Corner middle{static_cast<int>(points.size()) - 1, mean};
      const int to_b = inner_lines_, to_from = to_b + 1, to_to = to_b + 2, to_the_a = to_b + 3;
      inner_lines_ += 4;
      add_cell(triangle, {at_a, at_b, middle}, {ab, to_b, to_the_a});
      add_cell(triangle, {at_b, from, middle}, {from_b, to_from, to_b});
      add_cell(triangle, {from, to, middle}, {no_line, to_to, to_from});
      add_cell(triangle, {to, at_a, middle}, {to_a, to_the_a, to_to});
    }
  }

  // Only `inner` lies inside, and the others outside.
  void keep_one(const Triangle& triangle, int inner) {
    const int next = (inner + 1) % 3, last = (inner + 2) % 3;
    add_cell(triangle,
             {corner(triangle, inner), rim(triangle, inner, next), rim(triangle, inner, last)},
             {triangle.lines[inner], no_line, triangle.lines[last]});
  }

  void add_cell(const Triangle& triangle, const std::array<Corner, 3>& corners,
                const std::array<int, 3>& lines) {
    const int cell = static_cast<int>(cells.size());
    const auto& [a, b, c] = corners;
    cells.push_back({.points = {a.point, b.point, c.point},
                     .shape = {{b.place[0] - a.place[0], b.place[1] - a.place[1]},
                               {c.place[0] - a.place[0], c.place[1] - a.place[1]}},
                     .triangle = triangle.number});
    for (int side = 0; side < 3; ++side) {
      if (lines[side] != no_line) joints.push_back({lines[side], cell, side});
    }
  }

  int line_of(int edge) const { return lines_[edge]; }

  bool is_held_at(int node) const {
    return (border_ != Border::Free && is_border_[node]) || (!held_.empty() && held_[node] != 0);
  }

  // By line; those of a line stay in the order of their cells.
  void sort_joints() {
    std::vector<int> starts(static_cast<std::size_t>(inner_lines_) + 1, 0);
    for (const Joint& joint : joints) ++starts[joint.line + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<Joint> sorted(joints.size());
    for (const Joint& joint : joints) sorted[starts[joint.line]++] = joint;
    joints.swap(sorted);
  }

  double phi_at(int end) const {
    return end >= 0 ? level_set_.at_nodes[end] : level_set_.at_centres[-1 - end];
  }

  Corner corner(const Triangle& triangle, int k) {
    const int end = triangle.ends[k];
    int& point = end >= 0 ? node_points_[end] : centre_point_;
    if (point < 0) {
      point = static_cast<int>(points.size());
      Point made{.node = std::max(end, -1), .is_free = triangle.phi[k] > 0};
      if (end < 0) made.cut = {.kind = CutPoint::Kind::Centre, .face = -1 - end};
      const bool is_held = end >= 0 && is_held_at(level_set_.nodes[end]);
      made.is_free = made.is_free && !is_held;
      points.push_back(made);
    }
    return {point, triangle.places[k]};
  }

  // The point of the rim between a corner inside and one outside.
  Corner rim(const Triangle& triangle, int inner, int outer) {
    const int side = outer == (inner + 1) % 3 ? inner : outer;
    const double t = triangle.phi[inner] / (triangle.phi[inner] - triangle.phi[outer]);
    int& point = rim_points_[triangle.lines[side]];
    if (point < 0) {
      point = static_cast<int>(points.size());
      points.push_back({.cut = {.kind = CutPoint::Kind::Rim,
                                .of = {triangle.ends[inner], triangle.ends[outer]},
                                .t = t}});
    }
    return {point, on_the_way(triangle.places[inner], triangle.places[outer], t)};
  }

  const TriangleSurface& surface_;
  const LevelSet& level_set_;
  const std::vector<bool>& is_border_;
  Border border_;
  std::span<const std::uint8_t> held_;
  std::vector<int> edges_;        // of each line, as far as lines are edges
  std::vector<int> node_points_;  // the point of each node, -1: none yet
  std::unique_ptr<int[]> lines_;  // of the edges of all faces; the rest is not set
  std::vector<int> rim_points_;   // the point on each line, likewise
  int centre_point_ = -1;         // of the present face
  int inner_lines_ = 0;           // the next line inside a triangle
  int block_count_ = 0;
};

// The patch of each cell, in the order of their first cells.
std::vector<int> patches_of(const Cutting& cutting, int& count) {
  std::vector<int> parents(cutting.points.size());
  std::iota(parents.begin(), parents.end(), 0);
  const auto first_of = [&](int point) {
    while (parents[point] != point) point = parents[point] = parents[parents[point]];
    return point;
  };
  for (const TriangleCell& cell : cutting.cells) {
    const int first = first_of(cell.points[0]);
    for (const int other : {cell.points[1], cell.points[2]}) parents[first_of(other)] = first;
  }
  std::vector<int> numbers(parents.size(), -1), patches;
  count = 0;
  for (const TriangleCell& cell : cutting.cells) {
    int& number = numbers[first_of(cell.points[0])];
    if (number < 0) number = count++;
    patches.push_back(number);
  }
  return patches;
}

// The order of a patch's points: free nodes, all else that is free, held nodes, and the rest.
int rank_of(const Point& point) { return (point.is_free ? 0 : 2) + (point.node < 0 ? 1 : 0); }

// Separates the cells of a cutting into patches.
class Separating {
 public:
  Separating(const Cutting& cutting, Border border) : cutting_(cutting), border_(border) {
    int count = 0;
    cell_patches_ = patches_of(cutting, count);
    patches.resize(count);
  }

  // Unfinished if it is stopped.
  void run(StopPoll& poll) {
    number_points(poll);
    if (poll.after(0)) return;
    cell_places_.reserve(cutting_.cells.size());
    for (std::size_t k = 0; k < cutting_.cells.size(); ++k) {
      if (poll.after(32)) return;
      TriangleCells& cells = patches[cell_patches_[k]].cells;
      const bool goes_on = k > 0 && cutting_.blocks[k] == cutting_.blocks[k - 1];
      if (!goes_on) cells.block_starts.push_back(0);
      cells.block_starts.back() = static_cast<int>(cells.cells.size()) + 1;
      cell_places_.push_back(static_cast<int>(cells.cells.size()));
      cells.cells.push_back(cutting_.cells[k]);
      for (int& point : cells.cells.back().points) point = places_[point];
    }
    const std::vector<Joint>& joints = cutting_.joints;
    for (std::size_t k = 0, end = 0; k < joints.size(); k = end) {
      if (poll.after(16)) return;
      while (end < joints.size() && joints[end].line == joints[k].line) ++end;
      join(std::span(joints).subspan(k, end - k));
    }
  }

  std::vector<TrianglePatch> patches;

 private:
  void number_points(StopPoll& poll) {
    std::vector<int> point_patches(cutting_.points.size(), -1);
    for (std::size_t k = 0; k < cutting_.cells.size(); ++k) {
      for (const int point : cutting_.cells[k].points) point_patches[point] = cell_patches_[k];
    }
    std::vector<int> order(cutting_.points.size());
    std::iota(order.begin(), order.end(), 0);
    const bool is_sorted = sort_unless_stopped(order, poll, [&](int a, int b) {
      const Point &p = cutting_.points[a], &q = cutting_.points[b];
      return std::tuple(rank_of(p), p.node, a) < std::tuple(rank_of(q), q.node, b);
    });
    if (!is_sorted) return;
    places_.resize(cutting_.points.size());
    for (const int k : order) {
      const Point& point = cutting_.points[k];
      TrianglePatch& patch = patches[point_patches[k]];
      places_[k] = patch.cells.point_count++;
      patch.cells.free_points += point.is_free ? 1 : 0;
      patch.free_nodes += rank_of(point) == 0 ? 1 : 0;
      if (point.node >= 0) {
        patch.points.push_back(point.node);
        continue;
      }
      patch.points.push_back(-1 - static_cast<int>(patch.cut_points.size()));
      patch.cut_points.push_back(point.cut);
    }
    for (TrianglePatch& patch : patches) {
      for (CutPoint& point : patch.cut_points) {
        if (point.kind != CutPoint::Kind::Part) continue;
        for (int& corner : point.of) corner = places_[corner];
      }
    }
  }

  // Gives the sides on one line their slopes.
  void join(std::span<const Joint> joints) {
    const int count = static_cast<int>(joints.size());
    const int whole = cutting_.sides_on(joints[0].line);
    const bool is_given = count < whole || (whole == 1 && border_ == Border::Clamped);
    if (is_given) return;
    TriangleCells& cells = patches[cell_patches_[joints[0].cell]].cells;
    const int first = cells.slope_count;
    cells.slope_count += std::max(count - 1, 1);
    for (int k = 0; k < count; ++k) {
      const bool is_last = k > 0 && k == count - 1;
      slope_of(joints[k]) = is_last ? SideSlope{first, count - 1, -1} : SideSlope{first + k, 1, 1};
    }
  }

  SideSlope& slope_of(const Joint& joint) {
    TriangleCells& cells = patches[cell_patches_[joint.cell]].cells;
    return cells.cells[cell_places_[joint.cell]].slopes[joint.side];
  }

  const Cutting& cutting_;
  Border border_;
  std::vector<int> cell_patches_;  // the patch of each cell
  std::vector<int> cell_places_;   // its place among the cells of its patch
  std::vector<int> places_;        // the place of each point among those of its patch
};

}  // namespace

CutCounts TrianglePatch::counts(const LevelSet& level_set) const {
  CutCounts counts{.cells = static_cast<int>(cells.cells.size())};
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k] < 0) continue;
    counts.inside_nodes += level_set.at_nodes[points[k]] > 0 ? 1 : 0;
    counts.held_nodes += static_cast<int>(k) >= cells.free_points ? 1 : 0;
  }
  return counts;
}

CutCounts TrianglePatch::counts_of(const std::vector<bool>& within) const {
  const auto is_within = [&](int point) { return points[point] >= 0 && within[points[point]]; };
  CutCounts counts;
  for (int point = 0; point < cells.point_count; ++point) {
    if (!is_within(point)) continue;
    ++counts.inside_nodes;
    counts.held_nodes += point >= cells.free_points ? 1 : 0;
  }
  for (const TriangleCell& cell : cells.cells) {
    counts.cells += std::any_of(cell.points.begin(), cell.points.end(), is_within) ? 1 : 0;
  }
  return counts;
}

Result<std::vector<TrianglePatch>> cut_out(const TriangleSurface& surface,
                                           const LevelSet& level_set,
                                           const std::vector<bool>& is_border, Border border,
                                           const StopRequest& should_stop,
                                           std::span<const std::uint8_t> held) {
  StopPoll poll(should_stop);
  Cutting cutting(surface, level_set, is_border, border, held);
  cutting.run(poll);
  if (poll.after(0)) return interrupted();
  Separating separating(cutting, border);
  separating.run(poll);
  for (TrianglePatch& patch : separating.patches) {
    if (poll.after(100 * patch.cells.cells.size())) return interrupted();
    std::vector<double> areas(static_cast<std::size_t>(patch.cells.point_count), 0);
    for (const TriangleCell& cell : patch.cells.cells) {
      const double third = std::abs(cell.shape.signed_area()) / 3;
      for (const int point : cell.points) areas[point] += third;
    }
    patch.masses = shared_out(patch, level_set, std::move(areas));
  }
  if (poll.after(0)) return interrupted();
  return std::move(separating.patches);
}

std::vector<double> shared_out(const TrianglePatch& patch, const LevelSet& level_set,
                               std::vector<double> at_points) {
  const auto each_cut_point = [&](CutPoint::Kind kind, const auto& hand_on) {
    for (std::size_t k = 0; k < patch.points.size(); ++k) {
      if (patch.points[k] >= 0) continue;
      const CutPoint& point = patch.cut_points[-1 - patch.points[k]];
      if (point.kind == kind) hand_on(point, at_points[k]);
    }
  };
  each_cut_point(CutPoint::Kind::Part, [&](const CutPoint& point, double share) {
    for (const int corner : point.of) at_points[corner] += 0.25 * share;
  });
  std::vector<int> places(level_set.nodes.size(), -1);  // of the free nodes among the points
  for (int k = 0; k < patch.free_nodes; ++k) places[patch.points[k]] = k;
  each_cut_point(CutPoint::Kind::Centre, [&](const CutPoint& point, double share) {
    const std::span<const int> corners = level_set.corners_of(static_cast<std::size_t>(point.face));
    for (const int corner : corners) {
      if (places[corner] < 0) continue;
      at_points[places[corner]] += share / static_cast<double>(corners.size());
    }
  });
  at_points.resize(static_cast<std::size_t>(patch.free_nodes));
  return at_points;
}

std::vector<double> values_at_points(const TrianglePatch& patch, std::span<const double> at_nodes,
                                     std::span<const double> at_centres) {
  const auto at_end = [&](int end) { return end >= 0 ? at_nodes[end] : at_centres[-1 - end]; };
  std::vector<double> at(patch.points.size());
  const auto each_point = [&](const auto& f) {
    for (std::size_t k = 0; k < patch.points.size(); ++k) f(k, patch.points[k]);
  };
  each_point([&](std::size_t k, int point) {
    if (point >= 0) {
      at[k] = at_nodes[point];
      return;
    }
    const CutPoint& cut = patch.cut_points[-1 - point];
    if (cut.kind == CutPoint::Kind::Centre) {
      at[k] = at_centres[cut.face];
    } else if (cut.kind == CutPoint::Kind::Rim) {
      const double from = at_end(cut.of[0]), to = at_end(cut.of[1]);
      at[k] = from + cut.t * (to - from);
    }
  });
  each_point([&](std::size_t k, int point) {
    if (point >= 0 || patch.cut_points[-1 - point].kind != CutPoint::Kind::Part) return;
    const std::array<int, 4>& of = patch.cut_points[-1 - point].of;
    at[k] = 0.25 * (at[of[0]] + at[of[1]] + at[of[2]] + at[of[3]]);
  });
  return at;
}

}  // namespace pliant
