#include "pliant/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/simulation/sampling.hpp"
#include "pliant/simulation/stepped.hpp"

namespace pliant {
namespace {

struct Extent {
  bool is_finite = true;
  double peak_displacement = 0;
};

// Whether all nodes are finite in world space, and their largest distance from rest there. In lanes
// beside each other: one pass over the nodes.
Extent extent_of(const Transform& transform, const Field& positions, const Field& rest) {
  constexpr int lanes = 32;
  alignas(64) double largest[lanes] = {};     // squared distance
  alignas(64) double not_finite[lanes] = {};  // 0, or NaN once something was not
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

// All as one: those of the scene's file first, each file's in the order of its lines, each once.
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
  Simulation simulation(std::move(scene), options);
  for (const Surface& surface : simulation.scene_.surfaces) {
    if (options.should_stop && options.should_stop()) return interrupted();
    MemoryShare share(simulation.memory_.get());
    auto rest_shape =
        make_rest_shape(surface, simulation.scene_.origin, share, options.should_stop);
    if (!rest_shape) {
      errors.push_back(std::move(rest_shape.error()));
      continue;
    }
    simulation.add_body(surface, *std::move(rest_shape), std::move(share));
  }
  if (options.should_stop && options.should_stop()) return interrupted();
  if (!errors.empty()) return fail_with_all(std::move(errors), simulation.scene_.origin);
  simulation.stepped_.resize(simulation.bodies_.size());
  if (options.profile) simulation.profiles_.resize(simulation.bodies_.size());
  return simulation;
}

Result<void> Simulation::check(const Scene& scene, const SimulationOptions& options) {
  std::vector<Error> errors = check_scene(scene);
  if (!errors.empty()) return fail_with_all(std::move(errors), scene.origin);

  errors = check_channels(scene, {}, options.should_stop);
  MemoryBudget memory(options.max_memory);
  std::vector<MemoryShare> shares;  // what surfaces would take together
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

Simulation::Simulation(Scene scene, const SimulationOptions& options)
    : scene_(std::move(scene)),
      sampling_(std::make_unique<SceneSampling>(scene_)),
      memory_(std::make_unique<MemoryBudget>(options.max_memory)),
      frame_(scene_.start),
      furthest_frame_(scene_.start),
      cache_(scene_.start, options.checkpoint_bytes, memory_.get()),
      store_(options.store),
      threads_(std::make_unique<ThreadPool>(options.threads)),
      solver_(options.solver),
      most_lanes_(options.most_lanes),
      should_stop_(options.should_stop) {}

Simulation::Simulation(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

// Member by member the budget would go ahead of the bodies that give back to it.
Simulation& Simulation::operator=(Simulation&& other) noexcept {
  if (this != &other) {
    std::destroy_at(this);
    std::construct_at(this, std::move(other));
  }
  return *this;
}

void Simulation::add_body(const Surface& surface, RestShape rest_shape, MemoryShare share) {
  const SolverSettings& solver = surface.solver;
  const GridMapping& mapping = rest_shape.mapping;
  // Surfaces go at the same time; a single one has the threads to itself.
  ThreadPool* const threads = scene_.surfaces.size() == 1 ? threads_.get() : nullptr;
  const BodySettings settings{solver.stepping, solver.reference, solver.measure, solver.combine,
                              solver.release};
  keys_.emplace_back(rest_key(mapping.grid, mapping.rest, settings, solver_));
  bodies_.emplace_back(mapping.grid, mapping.rest, settings,
                       SolverCache(solver_, memory_.get(), threads, most_lanes_));
  rest_shapes_.push_back(std::move(rest_shape));
  shares_.push_back(std::move(share));
}

// The error with the surface and the frame that it befell.
Error Simulation::located(Error error, const Surface& surface, int frame) const {
  if (error.code == ErrorCode::Interrupted) {  // no surface is at fault
    return {ErrorCode::Interrupted, fmt::format("interrupted at frame {}", frame)};
  }
  error.message = fmt::format("surface \"{}\", frame {}: {}", surface.name, frame, error.message);
  error.file = scene_.origin.file;
  error.line = scene_.origin.line_of(surface.name);
  return error;
}

// To a frame of the range, or back to the start where that fails.
Result<void> Simulation::reach(int frame) {
  if (frame < scene_.start || frame > scene_.end) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("frame {} is outside the scene's frames {} to {}", frame, scene_.start,
                            scene_.end));
  }
  // When it fails, some bodies may have stepped and others not: start over, so that the next call
  // is sound. What is thrown is a custom force's.
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

Result<FrameReport> Simulation::report(int frame) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  std::vector<Result<SurfaceReport>> surfaces(bodies_.size());
  threads_->for_each(bodies_.size(), [&](std::size_t k) { surfaces[k] = report_of(k); });
  FrameReport report{frame, {}};
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!surfaces[k]) return fail(located(surfaces[k].error(), scene_.surfaces[k], frame));
    report.surfaces.push_back(*std::move(surfaces[k]));
  }
  return report;
}

// Of the frame that the bodies hold.
Result<SurfaceReport> Simulation::report_of(std::size_t index) const {
  const Surface& surface = scene_.surfaces[index];
  SurfaceReport report;
  if (is_idle(surface, frame_)) return report;
  const SurfaceInputs inputs = sample_inputs(scene_, *sampling_, index, frame_);
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
        {std::string(inputs.sources[k].name), inputs.sources[k].kind, force, selection,
         push_of(body.grid(), nodes, force, selection.force, step->patches_of_force(k))});
  }
  if (std::string fault = inputs.faults->first(); !fault.empty()) {
    return fail(ErrorCode::NotFinite, std::move(fault));
  }
  return report;
}

Result<Frame> Simulation::at(int frame, Frame reuse) {
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

Result<void> Simulation::go_to(int frame) {
  const std::optional<int> kept = cache_.latest_until(frame);
  if (frame < frame_ || kept > frame_) rewind(frame);
  // Frames that were never passed are read one by one, for what they leave for warnings.
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

// Who goes back once is likely to go back a little further next.
void Simulation::keep(bool is_going_back) {
  const bool is_wanted = is_going_back ? cache_.wants(frame_) : cache_.wants_checkpoint(frame_);
  if (!is_wanted) return;
  const StageTimer timer(profile_of(0), Stage::Checkpoints);
  cache_.keep(frame_, states());
}

// From the output of frame_ to that of the next frame. The surfaces know nothing of each other, so
// they may go at the same time; what they report is looked at in their order.
Result<void> Simulation::step() {
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
    if (!stepped.report) return fail(located(stepped.report.error(), surface, frame_));
    add_facts(warnings_, surface.name, frame_, stepped.inputs, stepped.facts);
    (stepped.is_read ? is_read : is_solved) = true;
  }
  frame_counts_.solved += is_solved ? 1 : 0;
  frame_counts_.read += is_read && !is_solved ? 1 : 0;
  return {};
}

void Simulation::step_surfaces() {
  threads_->for_each(bodies_.size(), [this](std::size_t k) { step_surface(k); });
  const auto lacks_memory = [](const Stepped& stepped) {
    return stepped.is_stepped && !stepped.report &&
           stepped.report.error().code == ErrorCode::OutOfMemory;
  };
  // Kept frames are worth less than the next one.
  if (std::any_of(stepped_.begin(), stepped_.end(), lacks_memory) && cache_.give_way()) {
    threads_->for_each(bodies_.size(), [&](std::size_t k) {
      if (lacks_memory(stepped_[k])) step_surface(k);
    });
  }
}

void Simulation::step_surface(std::size_t index) {
  Stepped& stepped = stepped_[index];
  const Surface& surface = scene_.surfaces[index];
  stepped.is_stepped = !is_idle(surface, frame_);
  stepped.is_read = false;
  if (!stepped.is_stepped) return;
  StageTimer sampling(profile_of(index), Stage::Sampling);
  stepped.inputs = sample_inputs(scene_, *sampling_, index, frame_, std::move(stepped.inputs));
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

void Simulation::solve_surface(std::size_t index) {
  Stepped& stepped = stepped_[index];
  StepReport former = stepped.report ? std::exchange(*stepped.report, {}) : StepReport{};
  stepped.report =
      bodies_[index].step(stepped.inputs.body, should_stop_, std::move(former), profile_of(index));
  if (!stepped.report) return;
  stepped.facts = facts_of(stepped.inputs, *stepped.report, scene_.surfaces[index].solver.combine,
                           std::move(stepped.facts));
}

Profile* Simulation::profile_of(std::size_t surface) {
  return profiles_.empty() ? nullptr : &profiles_[surface];
}

Profile Simulation::profile() const {
  Profile all;
  for (const Profile& profile : profiles_) all.add(profile);
  return all;
}

// Whether nothing can act on a surface at a frame: the next one is like this one.
bool Simulation::is_idle(const Surface& surface, int frame) const {
  return !surface.enabled || frame < start_frame(surface);
}

std::vector<Warning> Simulation::warnings() const {
  const auto& ranges = passed_.ranges();
  const bool is_complete =
      scene_.start == scene_.end || (ranges.size() == 1 && ranges.front().first == scene_.start &&
                                     ranges.front().second == scene_.end - 1);
  std::vector<Warning> warnings = warnings_.warnings(is_complete);
  // Who writes combine="box" out knows what it does.
  std::erase_if(warnings, [&](const Warning& warning) {
    return warning.kind == Warning::Kind::ForcesApart &&
           scene_.origin.lines.contains(warning.surface + ".combine");
  });
  for (Warning& warning : warnings) {
    warning.is_group = std::any_of(scene_.groups.begin(), scene_.groups.end(),
                                   [&](const Group& group) { return group.name == warning.force; });
  }
  return warnings;
}

// Back to a kept frame, or to the start, where all is at rest.
void Simulation::rewind(int frame) {
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

std::vector<BodyState> Simulation::states() const {
  std::vector<BodyState> states;
  for (const Body& body : bodies_) states.push_back(body.state());
  return states;
}

const BodyState& Simulation::state(std::size_t surface) const {
  PLIANT_EXPECTS(surface < bodies_.size());
  return bodies_[surface].state();
}

int Simulation::start_frame(const Surface& surface) const {
  return std::max(scene_.start, surface.solver.start_frame.value_or(scene_.start));
}

std::size_t Simulation::surface_memory() const {
  std::size_t bytes = 0;
  for (const MemoryShare& share : shares_) bytes += share.bytes();
  return bytes;
}

SolverCounts Simulation::solver_counts() const {
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
