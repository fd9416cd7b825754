#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/step_facts.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/feedback/run_watch.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/states/scene_states.hpp"

namespace pliant {

/// What `check_scene` finds; if anything, also what is wrong with channels at the first frame,
/// since those of others may not be known. Internal to simulation.
std::vector<Error> problems_of(const Scene& scene, const StopRequest& should_stop = {});

/// Checks that `check_scene` finds nothing, and that there is a surface. Internal to simulation.
Result<void> check_to_simulate(const Scene& scene, const StopRequest& should_stop = {});

/// The error of a run that was stopped while it was made.
tl::unexpected<Error> interrupted_at_start();

/// All bodies of a scene, and their step from one frame to the next. It does not know which frame
/// its bodies are at, nor what came before. Internal to simulation.
class Bodies {
 public:
  /// One surface's step; reused to avoid allocations.
  struct Step {
    bool is_solved_now = false;  ///< false: the surface is disabled, or starts later
    bool is_read = false;        ///< read from the store, not solved
    bool is_again = false;       ///< a cycle begins, once more or for the first time: not solved
    int frame = 0;               ///< whose inputs it uses
    SurfaceInputs inputs;
    Result<void> outcome;
    StepFacts facts;
    Field velocities_before = {};  ///< of a step that was read
  };

  /// Requires: scene and sampling outlive it. `make_all` gives sampling the animated shapes.
  Bodies(const Scene& scene, SceneSampling& sampling, const SimulationOptions& options);

  /// Checks every channel at every frame of the scene, reads the meshes and makes a body of each.
  /// Errors: those of all channels and meshes; Interrupted.
  Result<void> make_all();

  /// Steps all surfaces from the output of a frame to that of the next, several of them at the same
  /// time. `states`: where steps are read and written; null: nowhere. If memory is short,
  /// `give_way` may release some and return true; then the surfaces that lacked it try again.
  void step(int frame, SceneStates* states, const std::function<bool()>& give_way);

  /// Adds all surfaces to the states of this scene, in their order.
  void add_to(SceneStates& states) const;

  /// Checks the maps of materials at a frame. Errors: those of `check_maps_at`.
  std::vector<Error> check_maps(int frame) const;

  /// The last step of a surface.
  const Step& last_step(std::size_t surface) const { return steps_[surface]; }

  /// A watch of all surfaces, which `look` then needs.
  RunWatch watch();

  /// Lets the watch look at the last step of a surface. Requires: it is solved now.
  void look(RunWatch& watch, std::size_t surface, int frame, WarningLog& log) const;

  /// The error of its last step, with the surface's name and line, and the frame.
  Result<void> outcome(std::size_t surface) const;

  /// The surfaces as shown at a frame. Errors: NotFinite.
  Result<Frame> output(int frame, Frame reuse);

  /// The solve that `step` would make at a frame. Errors: those of `Body::look` and of custom
  /// forces.
  Result<FrameReport> report(int frame, ReportDetail detail);

  void reset();  ///< all bodies to rest
  void restore(std::vector<BodyState> states);
  std::vector<BodyState> states(std::vector<BodyState> reuse = {}) const;

  std::size_t size() const { return bodies_.size(); }
  std::span<const std::unique_ptr<Body>> all() const { return bodies_; }
  std::span<const RestShape> rest_shapes() const { return rest_shapes_; }
  MemoryBudget& memory() { return memory_; }
  const MemoryBudget& memory() const { return memory_; }
  SolverChoice solver() const { return solver_; }
  std::size_t surface_memory() const;
  SolverCounts solver_counts() const;
  Profile profile() const;
  Profile* profile_of(std::size_t surface);  ///< null: no profiling

 private:
  Result<void> add(const Surface& surface, ReservedShape made);
  void for_each_body(const std::function<void(std::size_t)>& visit);
  void find_drivers();
  void read_colliders(std::vector<Error>& errors);
  Result<void> join_forces(std::span<ReservedShape> made) const;
  Result<void> bind_driven(std::span<ReservedShape> made) const;
  Result<void> show(std::size_t index, int frame, SurfaceFrame& shown) const;
  Result<Field> driven_positions(std::size_t index, int frame, const Transform& transform,
                                 Field reuse) const;
  Result<Field> place_vertices(std::size_t index, int frame, const Field& displacement,
                               Field reuse) const;
  void step(std::size_t index, int frame, SceneStates* states);
  Result<void> begin_cycle(std::size_t index, SceneStates* states);
  Result<BodyState> find_cycle(std::size_t index);
  Error located(Error error, const Surface& surface, int frame) const;

  const Scene& scene_;
  SceneSampling& sampling_;
  MemoryBudget memory_;
  ThreadPool threads_;
  std::vector<MemoryShare> collider_shares_;  // one for each mesh
  std::vector<MemoryShare> shares_;           // one a surface, as the following
  std::vector<RestShape> rest_shapes_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<std::size_t> drivers_;  // the index of the surface that drives each, or its own
  std::vector<Step> steps_;
  std::vector<bool> keeps_velocities_;            // from before each step, also of one that is read
  std::vector<std::optional<BodyState>> cycles_;  // the states at their beginnings, once known
  SolverChoice solver_;
  int exact_parts_;
  RunContext context_;             // of the bodies, each with a profile of its own
  std::vector<Profile> profiles_;  // one a surface; empty: no profiling
  std::function<void(std::string_view, int, double)> round_done_;
};

}  // namespace pliant
