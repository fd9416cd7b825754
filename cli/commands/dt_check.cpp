#include "cli/commands/dt_check.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace pliant::cli {
namespace {

// Half of the step that a frame is divided into.
double half_step(const Scene& scene, const Surface& surface, int frame) {
  const double length = frame_length(scene, surface, frame);
  const double dt = surface.solver.dt.at(frame)[0];
  if (length == 0) return dt / 2;
  return divide_interval(length, dt, surface.solver.stepping).length / 2;
}

Error of_second_run(Error error) {
  error.message = "--check-dt, at half the time step: " + error.message;
  return error;
}

Channel<1> half_steps(const Scene& scene, const Surface& surface) {
  const SolverSettings& solver = surface.solver;
  if (!solver.dt.is_animated() && !solver.time_scale.is_animated())
    return half_step(scene, surface, scene.start);
  CurveKeys<1> curve;
  const FrameSpan frames = sampled_frames(scene, surface);
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    Key<1> key{.frame = double(frame), .value = {half_step(scene, surface, frame)}};
    key.next.kind = Interpolation::Kind::Step;
    curve.keys.push_back(key);
  }
  return Curve<1>::make(std::move(curve)).value();
}

}  // namespace

Result<DtCheck> DtCheck::make(const Scene& scene, SimulationOptions options) {
  Scene half = scene;
  for (Surface& surface : half.surfaces) surface.solver.dt = half_steps(scene, surface);
  options.profile = false;
  options.exact_parts = 2;
  auto simulation = Simulation::make(std::move(half), options);
  if (!simulation) return fail(of_second_run(simulation.error()));
  return DtCheck(*std::move(simulation));
}

Result<void> DtCheck::advance(const Frame& frame) {
  auto reached = simulation_.at(frame.number(), std::move(frame_));
  if (!reached) return fail(of_second_run(reached.error()));
  frame_ = *std::move(reached);
  return {};
}

void DtCheck::compare(const Frame& frame, std::span<const std::size_t> surfaces) {
  for (const std::size_t k : surfaces) {
    const Field apart = frame.surfaces()[k].positions() - frame_.surfaces()[k].positions();
    const double farthest = longest_vector(apart).length;
    if (farthest <= difference_) continue;
    difference_ = farthest;
    at_ = frame.number();
  }
}

std::string DtCheck::to_text(double peak_displacement) const {
  if (difference_ == 0) return "at half the time step all positions are the same";
  const std::string share = peak_displacement > 0
                                ? fmt::format("{:.3g} of the peak displacement at most, ",
                                              difference_ / peak_displacement)
                                : "at most ";
  return fmt::format("at half the time step positions differ by {}{:.6g} at frame {}", share,
                     difference_, at_);
}

}  // namespace pliant::cli
