#include "pliant/simulation/simulation.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/simulation/run.hpp"

namespace pliant {
namespace {

// All errors as one: those of the scene's file first, those of a file in the order of lines,
// without duplicates.
tl::unexpected<Error> fail_with_all(std::vector<Error> errors, const SceneOrigin& origin) {
  std::vector<Error> all;
  for (Error& error : errors) {
    std::vector<Error> others = std::exchange(error.others, {});
    all.push_back(std::move(error));
    std::move(others.begin(), others.end(), std::back_inserter(all));
  }
  const auto place = [&](const Error& error) {
    return std::tuple(error.file != origin.file, std::string_view(error.file), error.line);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Error& a, const Error& b) { return place(a) < place(b); });
  std::set<std::tuple<std::string_view, int, std::string_view>> seen;
  std::vector<Error> distinct;
  for (const Error& error : all) {
    if (seen.emplace(error.file, error.line, error.message).second) distinct.push_back(error);
  }
  Error first = distinct.front();
  first.others.assign(distinct.begin() + 1, distinct.end());
  return fail(std::move(first));
}

tl::unexpected<Error> interrupted() {
  return fail(ErrorCode::Interrupted, "interrupted before the first frame");
}

}  // namespace

Result<Simulation> Simulation::make(Scene scene, const SimulationOptions& options) {
  PLIANT_EXPECTS(options.threads >= 1 && is_available(options.solver));
  std::vector<Error> errors = check_scene(scene);
  if (scene.surfaces.empty()) {
    errors.push_back({.code = ErrorCode::InvalidInput,
                      .message = "the scene has no surface to simulate",
                      .file = scene.origin.file});
  }
  if (!errors.empty()) return fail_with_all(std::move(errors), scene.origin);

  errors = check_channels(scene, {}, options.should_stop);
  auto run = std::make_unique<Run>(std::move(scene), options);
  std::vector<Error> mesh_errors = run->add_bodies();
  std::move(mesh_errors.begin(), mesh_errors.end(), std::back_inserter(errors));
  if (options.should_stop && options.should_stop()) return interrupted();
  if (!errors.empty()) return fail_with_all(std::move(errors), run->scene().origin);
  return Simulation(std::move(run));
}

Result<void> Simulation::check(const Scene& scene, const SimulationOptions& options) {
  std::vector<Error> errors = check_scene(scene);
  if (!errors.empty()) return fail_with_all(std::move(errors), scene.origin);

  errors = check_channels(scene, {}, options.should_stop);
  MemoryBudget memory(options.max_memory);
  std::vector<MemoryShare> shares;  // of all surfaces together
  for (const Surface& surface : scene.surfaces) {
    if (options.should_stop && options.should_stop()) return interrupted();
    shares.emplace_back(&memory);
    auto checked = check_rest_shape(surface, scene.origin, shares.back(), options.should_stop);
    if (!checked) errors.push_back(std::move(checked.error()));
  }
  if (options.should_stop && options.should_stop()) return interrupted();
  if (!errors.empty()) return fail_with_all(std::move(errors), scene.origin);
  return {};
}

Simulation::Simulation(std::unique_ptr<Run> run) : run_(std::move(run)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

FrameSequence Simulation::frames() const { return {scene().start, scene().end}; }

Result<Frame> Simulation::at(int frame, Frame reuse) { return run_->at(frame, std::move(reuse)); }

Result<FrameReport> Simulation::report(int frame) { return run_->report(frame); }

const BodyState& Simulation::state(std::size_t surface) const { return run_->state(surface); }

Result<std::string> Simulation::state_bytes(int frame) { return run_->state_bytes(frame); }

Result<int> Simulation::restore(std::string_view state_bytes) { return run_->restore(state_bytes); }

const Scene& Simulation::scene() const { return run_->scene(); }

std::span<const RestShape> Simulation::rest_shapes() const { return run_->rest_shapes(); }

std::vector<Warning> Simulation::warnings() const { return run_->warnings(); }

std::size_t Simulation::surface_memory() const { return run_->surface_memory(); }

SolverCounts Simulation::solver_counts() const { return run_->solver_counts(); }

FrameCounts Simulation::frame_counts() const { return run_->frame_counts(); }

Profile Simulation::profile() const { return run_->profile(); }

}  // namespace pliant
