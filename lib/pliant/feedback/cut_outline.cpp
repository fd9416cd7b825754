#include "pliant/feedback/cut_outline.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace pliant {
namespace {

using Side = std::array<int, 2>;  // two points of a patch, in ascending order

Side side_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Calls f(side) for each side of each cell.
template <class F>
void each_side(const TrianglePatch& patch, const F& f) {
  for (const TriangleCell& cell : patch.cells.cells) {
    for (int k = 0; k < 3; ++k) f(side_of(cell.points[k], cell.points[(k + 1) % 3]));
  }
}

// The sides of one cell only, in ascending order.
std::vector<Side> sides_of_one_cell(const TrianglePatch& patch) {
  // The other ends of all sides, by their first ends: a few for each.
  std::vector<int> starts(static_cast<std::size_t>(patch.cells.point_count) + 2, 0);
  each_side(patch, [&](const Side& side) { ++starts[side[0] + 2]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<int> ends(3 * patch.cells.cells.size());
  each_side(patch, [&](const Side& side) { ends[starts[side[0] + 1]++] = side[1]; });
  std::vector<Side> single;
  for (int first = 0; first < patch.cells.point_count; ++first) {
    const auto begin = ends.begin() + starts[first], end = ends.begin() + starts[first + 1];
    std::sort(begin, end);
    for (auto same = begin; same != end;) {
      const auto next = std::find_if(same, end, [&](int other) { return other != *same; });
      if (next - same == 1) single.push_back({first, *same});
      same = next;
    }
  }
  return single;
}

// Adds lines between points of a patch, and points between these, as sums of nodes.
class OutlineMaker {
 public:
  OutlineMaker(const TrianglePatch& patch, const LevelSet& level_set, SurfaceLines& lines)
      : patch_(patch), level_set_(level_set), lines_(lines) {}

  int point(int k) { return point(side_of(k, k), 0); }

  // The point at share `t` of a side; always the same one of a side.
  int point(const Side& side, double t) {
    if (const auto found = places_.find(side); found != places_.end()) return found->second;
    sum_.clear();
    add(side[0], 1 - t);
    if (t > 0) add(side[1], t);
    return places_[side] = sum();
  }

  void join(int a, int b) {
    if (a != b) lines_.segments.push_back({a, b});
  }

 private:
  void add(int point, double share) {
    if (patch_.points[point] >= 0) {
      add_end(patch_.points[point], share);
      return;
    }
    const CutPoint& cut = patch_.cut_points[-1 - patch_.points[point]];
    if (cut.kind == CutPoint::Kind::Centre) {
      add_end(-1 - cut.face, share);
    } else if (cut.kind == CutPoint::Kind::Rim) {
      add_end(cut.of[0], share * (1 - cut.t));
      add_end(cut.of[1], share * cut.t);
    } else {
      for (const int corner : cut.of) add(corner, 0.25 * share);
    }
  }

  // `end`: as in `CutPoint::of`.
  void add_end(int end, double share) { sum_[end] += share; }

  // Adds a point that is the sum of these ends.
  int sum() {
    const std::map<int, double> ends = std::exchange(sum_, {});
    for (const auto& [end, share] : ends) {
      if (end < 0) centre(-1 - end);
    }
    if (ends.size() == 1 && ends.begin()->first < 0) return centre(-1 - ends.begin()->first);
    for (const auto& [end, share] : ends) {
      lines_.add_source(end >= 0 ? level_set_.nodes[end] : -1 - centre(-1 - end), share);
    }
    return lines_.add_point();
  }

  // The point of a centre.
  int centre(int face) {
    if (const auto found = centres_.find(face); found != centres_.end()) return found->second;
    const auto corners = level_set_.corners_of(static_cast<std::size_t>(face));
    for (const int corner : corners) {
      lines_.add_source(level_set_.nodes[corner], 1 / static_cast<double>(corners.size()));
    }
    return centres_[face] = lines_.add_point();
  }

  const TrianglePatch& patch_;
  const LevelSet& level_set_;
  SurfaceLines& lines_;
  std::map<Side, int> places_;  // of a point alone: under the point twice
  std::map<int, int> centres_;  // by face
  std::map<int, double> sum_;   // of ends, as in `CutPoint::of`
};

}  // namespace

SurfaceLines outline_of(const TrianglePatch& patch, const LevelSet& level_set) {
  SurfaceLines lines;
  OutlineMaker maker(patch, level_set, lines);
  const auto is_held = [&](int point) { return point >= patch.cells.free_points; };
  for (const auto& [a, b] : sides_of_one_cell(patch)) {
    if (!is_held(a) || !is_held(b)) continue;  // a free border
    const int from = maker.point(a);
    maker.join(from, maker.point(b));
  }
  return lines;
}

SurfaceLines outline_of(std::span<const TrianglePatch> patches, const LevelSet& level_set,
                        std::span<const double> at_nodes) {
  SurfaceLines lines;
  if (std::none_of(at_nodes.begin(), at_nodes.end(), [](double at) { return at > 0; }))
    return lines;
  const std::vector<double> at_centres = means_at_centres(level_set, at_nodes);
  for (const TrianglePatch& patch : patches) {
    const std::vector<double> at = values_at_points(patch, at_nodes, at_centres);
    OutlineMaker maker(patch, level_set, lines);
    // Where the function becomes 0 on the way from a point where it is positive to another one.
    const auto zero = [&](int positive, int other) {
      if (at[other] == 0) return maker.point(other);
      const Side side = side_of(positive, other);
      return maker.point(side, at[side[0]] / (at[side[0]] - at[side[1]]));
    };
    for (const TriangleCell& cell : patch.cells.cells) {
      const auto is_positive = [&](int point) { return at[point] > 0; };
      const auto positives = std::count_if(cell.points.begin(), cell.points.end(), is_positive);
      if (positives == 0 || positives == 3) continue;
      std::array<int, 2> ends = {};
      int count = 0;
      for (int k = 0; k < 3; ++k) {
        const int a = cell.points[k], b = cell.points[(k + 1) % 3];
        if (is_positive(a) == is_positive(b)) continue;
        ends[count++] = is_positive(a) ? zero(a, b) : zero(b, a);
      }
      maker.join(ends[0], ends[1]);
    }
    for (const auto& [a, b] : sides_of_one_cell(patch)) {
      if (at[a] <= 0 && at[b] <= 0) continue;
      const int from = at[a] > 0 ? maker.point(a) : zero(b, a);
      maker.join(from, at[b] > 0 ? maker.point(b) : zero(a, b));
    }
  }
  return lines;
}

}  // namespace pliant
