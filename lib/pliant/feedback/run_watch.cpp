#include "pliant/feedback/run_watch.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/feedback/scene_look.hpp"

namespace pliant {
namespace {

double largest_distance(const Field& positions, const Field& rest) {
  double largest = 0;  // squared
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const double x = positions(k, 0) - rest(k, 0), y = positions(k, 1) - rest(k, 1),
                 z = positions(k, 2) - rest(k, 2);
    const double square = x * x + y * y + z * z;
    largest = square > largest ? square : largest;
  }
  return std::sqrt(largest);
}

}  // namespace

RunWatch::RunWatch(const Scene& scene, std::span<const RestShape> shapes) {
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const Surface& surface = scene.surfaces[k];
    const RestShape& shape = shapes[k];
    Watched& one = surfaces_.emplace_back();
    one.name = surface.name;
    if (!is_solved(surface)) continue;
    const bool is_whole = surface.solver.region == SolvedRegion::All;
    one.freezes = !is_whole && surface.solver.release == Release::Freeze;
    one.diagonal = (shape.rest.colwise().maxCoeff() - shape.rest.colwise().minCoeff()).norm();
    if (!is_whole) continue;
    one.loose = loose_pieces_of(surface, shape);
    for (const int piece : one.loose) {
      if (piece < 0) continue;
      one.node_counts.resize(std::max(one.node_counts.size(), static_cast<std::size_t>(piece) + 1));
      ++one.node_counts[static_cast<std::size_t>(piece)];
    }
    one.sums.resize(one.node_counts.size());
  }
}

void RunWatch::look(std::size_t surface, int frame, double frame_length, bool is_solved,
                    const Body& body, const Field& before, WarningLog& log) {
  using enum Warning::Kind;
  Watched& one = surfaces_[surface];
  if (is_solved) {
    if (!one.has_moved) one.has_moved = body.state().positions != body.rest();
    if (one.freezes)
      one.peak = std::max(one.peak, largest_distance(body.state().positions, body.rest()));
    if (!one.sums.empty() && flies_away(one, body)) log.add(FliesAway, one.name, {}, frame);
  }
  if (one.freezes && one.was_solved && freezes(one, frame_length, is_solved, body, before))
    log.add(FrozenMoving, one.name, {}, frame);
  one.was_solved = is_solved;
}

// Whether the mean displacement of a piece that nothing holds is above the surface's diagonal.
bool RunWatch::flies_away(Watched& one, const Body& body) {
  std::ranges::fill(one.sums, Vector3d::Zero());
  const Field &positions = body.state().positions, &rest = body.rest();
  for (std::size_t node = 0; node < one.loose.size(); ++node) {
    if (one.loose[node] < 0) continue;
    const auto k = static_cast<Eigen::Index>(node);
    one.sums[static_cast<std::size_t>(one.loose[node])] +=
        (positions.row(k) - rest.row(k)).transpose();
  }
  for (std::size_t piece = 0; piece < one.sums.size(); ++piece)
    if (one.sums[piece].norm() > one.diagonal * one.node_counts[piece]) return true;
  return false;
}

// Whether a node that the last step moved stays from now on, though it is away from rest and would
// go on.
bool RunWatch::freezes(const Watched& one, double frame_length, bool is_solved, const Body& body,
                       const Field& before) {
  constexpr double share = 0.01;  // of the peak
  const double least = share * one.peak;
  const BodyState& state = body.state();
  // A step without a solve leaves the velocities as they were.
  const Field& earlier = is_solved ? before : state.velocities;
  for (Eigen::Index k = 0; k < earlier.rows(); ++k) {
    const double vx = earlier(k, 0), vy = earlier(k, 1), vz = earlier(k, 2);
    if (vx == 0 && vy == 0 && vz == 0) continue;
    if (is_solved && (state.velocities(k, 0) != 0 || state.velocities(k, 1) != 0 ||
                      state.velocities(k, 2) != 0)) {
      continue;
    }
    if (std::sqrt(vx * vx + vy * vy + vz * vz) * frame_length > least &&
        (state.positions.row(k) - body.rest().row(k)).norm() > least)
      return true;
  }
  return false;
}

}  // namespace pliant
