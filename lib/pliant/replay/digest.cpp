#include "pliant/replay/digest.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace pliant {
namespace {

// The input of the solve at a frame, as in docs/replay.md: a line `region solved i0 i1 j0 j1` for
// each part of each region, or a hash of what is cut out of triangles; then, for a body that
// recovers, a byte for each node; then, for one that yields, a hash of its plastic curvatures;
// then, for one that remembers what pushed, a byte for each node, and hashes of loads and tangents.
std::string region_text(const SurfaceReport& report, const BodyState& state) {
  std::string text;
  for (std::size_t k = 0; k < report.regions.size(); ++k) {
    for (const Box& part : report.regions[k].parts) {
      text += fmt::format("{} {} {} {} {} {}\n", k, report.regions[k].is_solved() ? 1 : 0, part.i0,
                          part.i1, part.j0, part.j1);
    }
  }
  if (report.cut) text += fmt::format("{}\n", to_text(*report.cut));
  text.append(state.unsettled.begin(), state.unsettled.end());
  if (const auto count = static_cast<std::size_t>(state.plastic.size()); count > 0) {
    text += fmt::format("{}\n", to_text(hash_of(std::span(state.plastic.data(), count))));
  }
  const auto& [loads, unknowns, tangents] = state.last;
  if (unknowns.empty()) return text;
  text.append(unknowns.begin(), unknowns.end());
  text += fmt::format("{}\n", to_text(hash_of(loads)));
  Field slopes(4, 3);
  const Vector3d* const sides[] = {&tangents.su0, &tangents.su1, &tangents.sv0, &tangents.sv1};
  for (int side = 0; side < 4; ++side) slopes.row(side) = sides[side]->transpose();
  text += fmt::format("{}\n", to_text(hash_of(slopes)));
  return text;
}

double peak_displacement(const Field& positions, const Field& rest) {
  double largest = 0;
  for (Eigen::Index row = 0; row < rest.rows(); ++row) {
    const double x = positions(row, 0) - rest(row, 0);
    const double y = positions(row, 1) - rest(row, 1);
    const double z = positions(row, 2) - rest(row, 2);
    largest = std::max(largest, x * x + y * y + z * z);
  }
  return std::sqrt(largest);
}

}  // namespace

Result<ReplayFrame> digest(Simulation& simulation, int frame, ThreadPool& threads,
                           bool with_states) {
  const auto report = simulation.report(frame);
  if (!report) return fail(report.error());
  const std::size_t count = report->surfaces.size();
  ReplayFrame digests{.number = frame, .surfaces = std::vector<SurfaceDigest>(count)};
  if (with_states) digests.states.resize(count);
  threads.for_each(count, [&](std::size_t k) {
    const BodyState& state = simulation.state(k);
    const RestShape& shape = simulation.rest_shapes()[k];
    // The state of an animated shape holds displacements.
    const Field none = Field::Zero(shape.animation ? shape.rest.rows() : 0, 3);
    const Field& rest = shape.animation ? none : shape.rest;
    digests.surfaces[k] = {hash_of(state.positions), hash_of(state.velocities),
                           hash_of(region_text(report->surfaces[k], state)),
                           peak_displacement(state.positions, rest)};
    if (with_states) digests.states[k] = {state.positions, state.velocities};
  });
  return digests;
}

}  // namespace pliant
