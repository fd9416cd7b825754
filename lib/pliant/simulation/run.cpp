#include "pliant/simulation/run.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"

namespace pliant {
namespace {

struct Extent {
  bool is_finite = true;
  double peak_displacement = 0;
};

// Whether all nodes are finite in world space, and their largest distance from rest there. One pass
// over the nodes, in parallel lanes.
Extent extent_of(const Transform& transform, const Field& positions, const Field& rest) {
  constexpr int lanes = 32;
  alignas(64) double largest[lanes] = {};     // squared distance
  alignas(64) double not_finite[lanes] = {};  // 0, or NaN after the first value that is not finite
  const Matrix3d& a = transform.linear;
  const Eigen::Index count = positions.rows();
  for (Eigen::Index first = 0; first < count; first += lanes) {
    const int width = static_cast<int>(std::min<Eigen::Index>(lanes, count - first));
    alignas(64) double squares[lanes] = {};
    for (int k = 0; k < 3; ++k) {
      const double ax = a(k, 0), ay = a(k, 1), az = a(k, 2), moved = transform.translation[k];
      const double* const x = &positions(first, 0);
      const double* const y = &positions(first, 1);
      const double* const z = &positions(first, 2);
      const double* const rest_x = &rest(first, 0);
      const double* const rest_y = &rest(first, 1);
      const double* const rest_z = &rest(first, 2);
      for (int n = 0; n < width; ++n) {
        const double world = (x[n] * ax + y[n] * ay + z[n] * az) + moved;
        const double way =
            (x[n] - rest_x[n]) * ax + (y[n] - rest_y[n]) * ay + (z[n] - rest_z[n]) * az;
        not_finite[n] += world - world;
        squares[n] += way * way;
      }
    }
    for (int n = 0; n < lanes; ++n) largest[n] = squares[n] > largest[n] ? squares[n] : largest[n];
  }
  return {std::all_of(not_finite, not_finite + lanes, [](double x) { return x == 0; }),
          std::sqrt(*std::max_element(largest, largest + lanes))};
}

}  // namespace

Simulation::Run::Run(Scene scene, const SimulationOptions& options)
    : scene_(std::move(scene)),
      sampling_(scene_),
      memory_(options.max_memory),
      threads_(options.threads),
      frame_(scene_.start),
      furthest_frame_(scene_.start),
      cache_(scene_.start, options.checkpoint_bytes, &memory_),
      store_(options.store),
      solver_(options.solver),
      most_lanes_(options.most_lanes),
      should_stop_(options.should_stop),
      profiles_(options.profile ? scene_.surfaces.size() : 0) {}

std::vector<Error> Simulation::Run::add_bodies() {
  std::vector<Error> errors;
  for (const Surface& surface : scene_.surfaces) {
    if (should_stop_ && should_stop_()) break;
    MemoryShare share(&memory_);
    auto rest_shape = make_rest_shape(surface, scene_.origin, share, should_stop_);
    if (!rest_shape) {
      errors.push_back(std::move(rest_shape.error()));
      continue;
    }
    add_body(surface, *std::move(rest_shape), std::move(share));
  }
  stepped_.resize(bodies_.size());
  return errors;
}

void Simulation::Run::add_body(const Surface& surface, RestShape rest_shape, MemoryShare share) {
  const SolverSettings& solver = surface.solver;
  const GridMapping& mapping = rest_shape.mapping;
  // Several surfaces are solved in parallel; a single one uses all threads.
  ThreadPool* const threads = scene_.surfaces.size() == 1 ? &threads_ : nullptr;
  const BodySettings settings{solver.stepping, solver.reference, solver.measure, solver.combine,
                              solver.release};
  keys_.emplace_back(rest_key(mapping.grid, mapping.rest, settings, solver_));
  bodies_.emplace_back(mapping.grid, mapping.rest, settings,
                       SolverCache(solver_, &memory_, threads, most_lanes_));
  rest_shapes_.push_back(std::move(rest_shape));
  shares_.push_back(std::move(share));
}

// The error with its surface and frame.
Error Simulation::Run::located(Error error, const Surface& surface, int frame) const {
  if (error.code == ErrorCode::Interrupted) {  // no surface caused it
    return {ErrorCode::Interrupted, fmt::format("interrupted at frame {}", frame)};
  }
  error.message = fmt::format("surface \"{}\", frame {}: {}", surface.name, frame, error.message);
  error.file = scene_.origin.file;
  error.line = scene_.origin.line_of(surface.name);
  return error;
}

// Advances to a frame of the range; back to the start if that fails.
Result<void> Simulation::Run::reach(int frame) {
  if (frame < scene_.start || frame > scene_.end) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("frame {} is outside the scene's frames {} to {}", frame, scene_.start,
                            scene_.end));
  }
  // On failure some bodies may have stepped and others not: rewind, so that the next call is valid.
  // Only custom forces throw.
  Result<void> reached;
  try {
    reached = go_to(frame);
  } catch (...) {
    rewind(scene_.start);
    throw;
  }
  if (!reached) {
    rewind(scene_.start);
    return reached;
  }
  return {};
}

Result<FrameReport> Simulation::Run::report(int frame) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  std::vector<Result<SurfaceReport>> surfaces(bodies_.size());
  threads_.for_each(bodies_.size(), [&](std::size_t k) { surfaces[k] = report_of(k); });
  FrameReport report{frame, {}};
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!surfaces[k]) return fail(located(surfaces[k].error(), scene_.surfaces[k], frame));
    report.surfaces.push_back(*std::move(surfaces[k]));
  }
  return report;
}

// The report at the bodies' present frame.
Result<SurfaceReport> Simulation::Run::report_of(std::size_t index) const {
  const Surface& surface = scene_.surfaces[index];
  SurfaceReport report;
  if (is_idle(surface, frame_)) return report;
  const SurfaceInputs inputs = sample_inputs(scene_, sampling_, index, frame_);
  const Body& body = bodies_[index];
  const auto step = body.look(inputs.body);
  if (!step) return fail(step.error());
  report.is_solved = step->is_solved;
  report.steps = step->steps;
  report.unknown_count = step->unknown_count();
  report.recovering = step->recovering;
  report.settled = static_cast<int>(step->settling.size());
  report.regions = step->selection.regions;
  for (const auto& patches : step->patches) report.region_is_solved.push_back(!patches.empty());
  const Field nodes = body.measured_nodes(inputs.body.transform);
  for (std::size_t k = 0; k < inputs.body.forces.size(); ++k) {
    const SampledForce& force = inputs.body.forces[k];
    const ForceSelection& selection = step->selection.forces[k];
    report.forces.push_back(
        {std::string(inputs.sources[k].name), inputs.sources[k].kind,
         std::make_shared<SampledForce>(force), selection,
         push_of(body.grid(), nodes, force, selection.force, step->patches_of_force(k))});
  }
  if (std::string fault = inputs.faults->first(); !fault.empty()) {
    return fail(ErrorCode::NotFinite, std::move(fault));
  }
  return report;
}

Result<Frame> Simulation::Run::at(int frame, Frame reuse) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  reuse.number_ = frame;
  reuse.surfaces_.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const StageTimer timer(profile_of(k), Stage::Output);
    const Surface& surface = scene_.surfaces[k];
    const Field& nodes = bodies_[k].state().positions;
    const Transform transform = sample_transform(surface.transform, frame);
    const Extent extent = extent_of(transform, nodes, bodies_[k].rest());
    if (!extent.is_finite) {
      return fail(located({ErrorCode::NotFinite, "a position in world space is not finite"},
                          surface, frame));
    }
    SurfaceFrame& shown = reuse.surfaces_[k];
    shown.name_ = surface.name;
    shown.transform_ = transform;
    shown.peak_displacement_ = extent.peak_displacement;
    shown.object_positions_ =
        rest_shapes_[k].mapping.to_vertices(nodes, std::move(shown.object_positions_));
  }
  return reuse;
}

Result<void> Simulation::Run::go_to(int frame) {
  const std::optional<int> kept = cache_.latest_until(frame);
  if (frame < frame_ || kept > frame_) rewind(frame);
  // Frames not passed before are read one by one, for their warnings.
  if (store_ && frame <= furthest_frame_) read_latest(frame);
  while (frame_ < frame) {
    if (auto stepped = step(); !stepped) return stepped;
    passed_.add(frame_);
    ++frame_;
    keep(frame_ <= furthest_frame_);
    furthest_frame_ = std::max(furthest_frame_, frame_);
  }
  return {};
}

// After going back once, a request for a frame shortly before is likely.
void Simulation::Run::keep(bool is_going_back) {
  const bool is_wanted = is_going_back ? cache_.wants(frame_) : cache_.wants_checkpoint(frame_);
  if (!is_wanted) return;
  const StageTimer timer(profile_of(0), Stage::Checkpoints);
  cache_.keep(frame_, states());
}

// Advances from the output of frame_ to that of the next frame. The surfaces are independent, so
// they may be solved in parallel; their reports are processed in their order.
Result<void> Simulation::Run::step() {
  step_surfaces();
  bool is_solved = false, is_read = false;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Surface& surface = scene_.surfaces[k];
    if (surface.enabled) warnings_.expect(Warning::Kind::NeverStarts, surface.name, {}, frame_);
    const Stepped& stepped = stepped_[k];
    if (!stepped.is_stepped) continue;
    warnings_.happened(Warning::Kind::NeverStarts, surface.name, {});
    if (std::string fault = stepped.inputs.faults->first(); !fault.empty()) {
      return fail(located({ErrorCode::NotFinite, std::move(fault)}, surface, frame_));
    }
    if (!stepped.outcome) return fail(located(stepped.outcome.error(), surface, frame_));
    add_facts(warnings_, surface.name, frame_, stepped.inputs, stepped.facts);
    (stepped.is_read ? is_read : is_solved) = true;
  }
  frame_counts_.solved += is_solved ? 1 : 0;
  frame_counts_.read += is_read && !is_solved ? 1 : 0;
  return {};
}

void Simulation::Run::step_surfaces() {
  threads_.for_each(bodies_.size(), [this](std::size_t k) { step_surface(k); });
  const auto lacks_memory = [](const Stepped& stepped) {
    return stepped.is_stepped && !stepped.outcome &&
           stepped.outcome.error().code == ErrorCode::OutOfMemory;
  };
  // Drop kept frames to make room for the next one.
  if (std::any_of(stepped_.begin(), stepped_.end(), lacks_memory) && cache_.give_way()) {
    threads_.for_each(bodies_.size(), [&](std::size_t k) {
      if (lacks_memory(stepped_[k])) step_surface(k);
    });
  }
}

void Simulation::Run::step_surface(std::size_t index) {
  Stepped& stepped = stepped_[index];
  const Surface& surface = scene_.surfaces[index];
  stepped.is_stepped = !is_idle(surface, frame_);
  stepped.is_read = false;
  if (!stepped.is_stepped) return;
  StageTimer sampling(profile_of(index), Stage::Sampling);
  stepped.inputs = sample_inputs(scene_, sampling_, index, frame_, std::move(stepped.inputs));
  std::optional<Hash> next;
  if (store_) {
    KeyChain& keys = keys_[index];
    if (keys.length() == frame_ + 1 - scene_.start) keys.append(&stepped.inputs, frame_);
    next = key(index, frame_ + 1);
  }
  sampling.stop();
  if (next && read_surface(index, *next)) return;
  solve_surface(index);
  if (next) write_surface(index, *next);
}

void Simulation::Run::solve_surface(std::size_t index) {
  Stepped& stepped = stepped_[index];
  Body& body = bodies_[index];
  stepped.outcome = body.step(stepped.inputs.body, should_stop_, profile_of(index));
  if (!stepped.outcome) return;
  stepped.facts = facts_of(stepped.inputs, body.last_step(), scene_.surfaces[index].solver.combine,
                           std::move(stepped.facts));
}

Profile* Simulation::Run::profile_of(std::size_t surface) {
  return profiles_.empty() ? nullptr : &profiles_[surface];
}

Profile Simulation::Run::profile() const {
  Profile all;
  for (const Profile& profile : profiles_) all.add(profile);
  return all;
}

// Whether a surface is not solved at a frame, so its state does not change.
bool Simulation::Run::is_idle(const Surface& surface, int frame) const {
  return !surface.enabled || frame < start_frame(surface);
}

std::vector<Warning> Simulation::Run::warnings() const {
  const auto& ranges = passed_.ranges();
  const bool is_complete =
      scene_.start == scene_.end || (ranges.size() == 1 && ranges.front().first == scene_.start &&
                                     ranges.front().second == scene_.end - 1);
  std::vector<Warning> warnings = warnings_.warnings(is_complete);
  // An author who writes combine="box" explicitly needs no warning.
  std::erase_if(warnings, [&](const Warning& warning) {
    return warning.kind == Warning::Kind::ForcesApart &&
           scene_.origin.gives(warning.surface, "combine");
  });
  for (Warning& warning : warnings) {
    warning.is_group = std::any_of(scene_.groups.begin(), scene_.groups.end(),
                                   [&](const Group& group) { return group.name == warning.force; });
  }
  return warnings;
}

// Goes back to a kept frame, or to the start, where all bodies are at rest.
void Simulation::Run::rewind(int frame) {
  const std::optional<int> kept = cache_.latest_until(frame);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (kept) {
      bodies_[k].restore(cache_.use(*kept)[k]);
    } else {
      bodies_[k].reset();
    }
  }
  frame_ = kept.value_or(scene_.start);
}

std::vector<BodyState> Simulation::Run::states() const {
  std::vector<BodyState> states;
  for (const Body& body : bodies_) states.push_back(body.state());
  return states;
}

const BodyState& Simulation::Run::state(std::size_t surface) const {
  PLIANT_EXPECTS(surface < bodies_.size());
  return bodies_[surface].state();
}

int Simulation::Run::start_frame(const Surface& surface) const {
  return std::max(scene_.start, surface.solver.start_frame.value_or(scene_.start));
}

std::size_t Simulation::Run::surface_memory() const {
  std::size_t bytes = 0;
  for (const MemoryShare& share : shares_) bytes += share.bytes();
  return bytes;
}

SolverCounts Simulation::Run::solver_counts() const {
  SolverCounts total;
  for (const Body& body : bodies_) {
    const SolverCounts counts = body.solver_counts();
    total.analyses += counts.analyses;
    total.factorizations += counts.factorizations;
    total.solves += counts.solves;
  }
  return total;
}

}  // namespace pliant
