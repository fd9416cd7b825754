#include "pliant/simulation/simulation.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/collider_mesh.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/simulation/bodies.hpp"
#include "pliant/simulation/player.hpp"

namespace pliant {
namespace {

// A cache, maps and what holds a static surface are checked against the shape, which is made for
// that.
Result<CheckedShape> check_shape(const Surface& surface, const Scene& scene,
                                 bool are_channels_sound, const RunContext& context) {
  if (!surface.is_animated() && surface.maps.empty() && surface.holds.empty() &&
      surface.solver.region != SolvedRegion::All)
    return check_rest_shape(surface, scene.origin, context);
  auto made = make_rest_shape(surface, scene.origin, context);
  if (!made) return fail(made.error());
  if (surface.is_animated()) {
    if (auto moves = animate(*made, surface, scene, context); !moves) return fail(moves.error());
  }
  if (are_channels_sound) {
    std::vector<Error> errors = check_against_shape(scene, surface, made->shape);
    if (!errors.empty()) return fail(as_one(std::move(errors), scene.origin.file));
  }
  return CheckedShape{std::move(made->memory), std::move(made->shape.note),
                      left_out_text(surface.name, made->shape.mesh.left_out)};
}

// What `work` returns, given what a simulation leaves of the memory.
template <class Work>
auto beside(const Simulation& simulation, const SimulationOptions& options, const Work& work)
    -> decltype(work(RunContext())) {
  MemoryBudget memory(options.max_memory);
  MemoryShare surfaces(&memory);
  const std::size_t bytes = simulation.surface_memory();
  if (!surfaces.try_resize(std::min(options.max_memory, bytes))) {
    return fail(ErrorCode::OutOfMemory, "simulating the surfaces " + surfaces.complaint(bytes));
  }
  return work(RunContext{.memory = &memory,
                         .shelf = options.shelf,
                         .should_stop = options.should_stop,
                         .progressed = options.progressed});
}

}  // namespace

Result<Simulation> Simulation::make(Scene scene, const SimulationOptions& options) {
  PLIANT_EXPECTS(options.threads >= 1 && is_available(options.solver));
  if (auto sound = check_to_simulate(scene, options.should_stop); !sound)
    return fail(sound.error());
  auto player = std::make_unique<Player>(std::move(scene), options);
  if (auto made = player->make_bodies(); !made) return fail(made.error());
  return Simulation(std::move(player));
}

Result<std::vector<SceneNote>> Simulation::check(const Scene& scene,
                                                 const SimulationOptions& options) {
  std::vector<Error> errors = problems_of(scene, options.should_stop);
  if (!errors.empty()) return fail(as_one(std::move(errors), scene.origin.file));

  errors = check_channels(scene, {}, options.should_stop);
  const bool are_sound = errors.empty();
  if (!are_sound && errors.front().code == ErrorCode::Interrupted) return interrupted_at_start();
  MemoryBudget memory(options.max_memory);
  const RunContext context{.memory = &memory, .should_stop = options.should_stop};
  std::vector<CheckedShape> shapes;  // of all surfaces together
  std::vector<SceneNote> notes;
  for (const Surface& surface : scene.surfaces) {
    if (context.is_stopped()) return interrupted_at_start();
    auto checked = check_shape(surface, scene, are_sound, context);
    if (!checked) {
      if (checked.error().code == ErrorCode::Interrupted) return interrupted_at_start();
      errors.push_back(std::move(checked.error()));
      continue;
    }
    for (const std::string& text : {checked->note, checked->left_out})
      if (auto note = note_on(surface, text, scene.origin)) notes.push_back(*note);
    shapes.push_back(*std::move(checked));
  }
  std::vector<MemoryShare> meshes;
  for (const Collider& collider : scene.colliders) {
    if (!std::holds_alternative<ClosedMesh>(collider.shape) || context.is_stopped()) continue;
    meshes.emplace_back(&memory);
    auto mesh = find_collider_mesh(collider, scene, context, meshes.back());
    if (!mesh) errors.push_back(std::move(mesh.error()));
  }
  if (context.is_stopped()) return interrupted_at_start();
  if (!errors.empty()) return fail(as_one(std::move(errors), scene.origin.file));
  return notes;
}

Simulation::Simulation(std::unique_ptr<Player> player) : player_(std::move(player)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

FrameSequence Simulation::frames() const { return {scene().start, scene().end}; }

Result<Frame> Simulation::at(int frame, Frame reuse) {
  return player_->at(frame, std::move(reuse));
}

Result<FrameReport> Simulation::report(int frame, ReportDetail detail) {
  return player_->report(frame, detail);
}

std::vector<std::shared_ptr<const ColliderMesh>> Simulation::collider_meshes() const {
  std::vector<std::shared_ptr<const ColliderMesh>> meshes;
  for (std::size_t k = 0; k < scene().colliders.size(); ++k)
    meshes.push_back(player_->sampling().mesh(k));
  return meshes;
}

const BodyState& Simulation::state(std::size_t surface) const {
  PLIANT_EXPECTS(surface < player_->bodies().size());
  return player_->bodies().all()[surface]->state();
}

Result<std::string> Simulation::state_bytes(int frame) { return player_->state_bytes(frame); }

Result<int> Simulation::restore(std::string_view state_bytes) {
  return player_->restore(state_bytes);
}

const Scene& Simulation::scene() const { return player_->scene(); }

std::span<const RestShape> Simulation::rest_shapes() const {
  return player_->bodies().rest_shapes();
}

Force Simulation::in_world(const Force& force, int frame) const {
  return pliant::in_world(scene(), force, frame, player_->sampling().carriers());
}

Group Simulation::in_world(const Group& group, int frame) const {
  return pliant::in_world(scene(), group, frame, player_->sampling().carriers());
}

std::vector<Warning> Simulation::warnings() const { return player_->warnings(); }

std::size_t Simulation::surface_memory() const { return player_->bodies().surface_memory(); }

std::size_t Simulation::reserved_memory() const {
  const MemoryBudget& memory = player_->bodies().memory();
  return memory.total() - memory.available();
}

SolverCounts Simulation::solver_counts() const { return player_->bodies().solver_counts(); }

FrameCounts Simulation::frame_counts() const { return player_->frame_counts(); }

SolverChoice Simulation::solver() const { return player_->bodies().solver(); }

Profile Simulation::profile() const { return player_->bodies().profile(); }

Result<std::vector<Preview>> preview_forces(const Simulation& simulation,
                                            const SimulationOptions& options) {
  return beside(simulation, options, [&](const RunContext& context) {
    return preview_forces(simulation.scene(), simulation.rest_shapes(), context);
  });
}

Result<std::optional<Preview>> preview_slowest(const Simulation& simulation, std::size_t surface,
                                               const SimulationOptions& options) {
  return beside(simulation, options, [&](const RunContext& context) {
    return preview_slowest(simulation.scene(), simulation.rest_shapes()[surface], surface, context);
  });
}

Result<PlayedPeak> play_forces(const Simulation& simulation, std::size_t surface, double until,
                               const SimulationOptions& options) {
  return beside(simulation, options, [&](const RunContext& context) {
    return play_forces(simulation.scene(), simulation.rest_shapes()[surface], surface, until,
                       context);
  });
}

Result<Suggestion> suggest_material(const Simulation& simulation, const MotionGoals& goals,
                                    const SimulationOptions& options) {
  return beside(simulation, options, [&](const RunContext& context) {
    return suggest_material(simulation.scene(), simulation.rest_shapes(), goals, context);
  });
}

}  // namespace pliant
