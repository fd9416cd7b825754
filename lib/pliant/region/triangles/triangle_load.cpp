#include "pliant/region/triangles/triangle_load.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pliant {
namespace {

// The integrals of a triangle's hats over the part of it where a linear function, given at its
// corners, is positive; in units of its area.
std::array<double, 3> hats_where_positive(const std::array<double, 3>& at) {
  constexpr std::array<double, 3> whole = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const auto positives = std::count_if(at.begin(), at.end(), [](double g) { return g > 0; });
  if (positives == 0) return {0, 0, 0};
  if (positives == 3) return whole;
  // The corner that is alone, and how far its part reaches towards the others.
  const bool is_positive = positives == 1;
  int alone = 0;
  while ((at[alone] > 0) != is_positive) ++alone;
  const int next = (alone + 1) % 3, last = (alone + 2) % 3;
  const double to_next = at[alone] / (at[alone] - at[next]);
  const double to_last = at[alone] / (at[alone] - at[last]);
  const double third = to_next * to_last / 3;
  std::array<double, 3> part;
  part[alone] = third * (1 + (1 - to_next) + (1 - to_last));
  part[next] = third * to_next;
  part[last] = third * to_last;
  if (is_positive) return part;
  return {whole[0] - part[0], whole[1] - part[1], whole[2] - part[2]};
}

}  // namespace

bool TriangleLoads::compute(const SampledForce& force) {
  loads_.resize(patches_.size());
  bool reaches = false;
  if (force.force_radius > 0) {
    at_nodes_ = depths_of(measured_, level_set_.nodes, force.kind, force.force_radius,
                          std::move(at_nodes_));
    reaches = std::any_of(at_nodes_.begin(), at_nodes_.end(), [](double at) { return at > 0; });
  }
  if (reaches) at_centres_ = means_at_centres(level_set_, at_nodes_, std::move(at_centres_));
  struct Pushed {
    std::size_t patch;
    int row;
    double area;
  };
  std::vector<Pushed> pushed;
  std::vector<int> nodes;
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    const TrianglePatch& patch = patches_[k];
    loads_[k] = Field::Zero(patch.free_nodes, 3);
    if (!reaches) continue;
    const std::vector<double> areas = areas_on(patch);
    for (int n = 0; n < patch.free_nodes; ++n) {
      if (areas[n] == 0) continue;
      pushed.push_back({k, n, areas[n]});
      nodes.push_back(level_set_.nodes[patch.points[n]]);
    }
  }
  const std::vector<Vector3d> loads = measured_.loads_on(nodes, force);
  for (std::size_t n = 0; n < loads.size(); ++n)
    loads_[pushed[n].patch].row(pushed[n].row) = (pushed[n].area * loads[n]).transpose();
  return !nodes.empty();
}

// The area on which the force acts, shared out to the free nodes.
std::vector<double> TriangleLoads::areas_on(const TrianglePatch& patch) const {
  const std::vector<double> at = values_at_points(patch, at_nodes_, at_centres_);
  std::vector<double> areas(patch.points.size(), 0);
  for (const TriangleCell& cell : patch.cells.cells) {
    const auto& [a, b, c] = cell.points;
    const std::array<double, 3> hats = hats_where_positive({at[a], at[b], at[c]});
    const double area = std::abs(cell.shape.signed_area());
    for (int k = 0; k < 3; ++k) areas[cell.points[k]] += area * hats[k];
  }
  return shared_out(patch, level_set_, std::move(areas));
}

Push TriangleLoads::push() const {
  Push push;
  for (const Field& loads : loads_) {
    for (Eigen::Index n = 0; n < loads.rows(); ++n) {
      if (loads.row(n).isZero(0)) continue;
      push.sum += loads.row(n).transpose();
      ++push.node_count;
    }
  }
  return push;
}

}  // namespace pliant
