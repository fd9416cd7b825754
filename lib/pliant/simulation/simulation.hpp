#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/profile.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/feedback/frame_report.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/feedback/suggestion.hpp"
#include "pliant/feedback/warnings.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame.hpp"
#include "pliant/simulation/frame_sequence.hpp"

namespace pliant {

class ColliderMesh;
class Shelf;
class StateStore;

/// Options of a simulation's run. Only the solver changes results, by 2e-9 of their size at
/// most: docs/model.md.
struct SimulationOptions {
  /// Memory for kept states, so that earlier frames are quick to reach: see `FrameCache` for the
  /// cost of a frame. [bytes]
  std::size_t checkpoint_bytes = std::size_t{256} << 20;

  /// Memory that surfaces, solvers and kept states may use together; more is refused before it is
  /// allocated. Kept states are dropped if solvers need the memory. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();

  /// Threads that work on several surfaces at the same time, or on the parts of a single one, the
  /// caller's among them. >= 1
  int threads = 1;

  /// The solver. Requires: available in this build.
  SolverChoice solver = SolverChoice::Auto;

  /// The parts of each step that `Integrator::Exact` chooses: more, to see the error that it
  /// leaves. >= 1
  int exact_parts = 1;

  /// Whether times are measured for `Simulation::profile`.
  bool profile = false;

  /// The most doubles per vector of the solver's kernels, as far as the machine offers a choice:
  /// for tests that it changes no bit.
  int most_lanes = widest_lanes;

  /// Called before every surface is read, while assimp reads one, and before every time step, from
  /// any of the threads. If it returns true, `make` and `at` fail with Interrupted.
  StopRequest should_stop = {};

  /// Called after each round in which the cycle of a surface with a loop is looked for, from any of
  /// the threads: with its name, the number of the round, and the gap as a share of the largest
  /// displacement.
  std::function<void(std::string_view surface, int round, double gap)> round_done = {};

  /// Called during the long work of previews and suggestions: what is worked at, and how much of it
  /// is done.
  ProgressReport progressed = {};

  /// Stores states beyond this simulation, so that another simulation, of the same or an edited
  /// scene, need not solve unchanged frames again. Outlives the simulation; null: states are not
  /// stored.
  StateStore* store = nullptr;

  /// Shares rest shapes, sparse factors and slowest vibrations with other simulations, previews and
  /// suggestions. Outlives the simulation; null: all are made anew.
  Shelf* shelf = nullptr;
};

/// How frames were reached, counted each time the simulation advances by a frame.
struct FrameCounts {
  int solved = 0;  ///< frames for which at least one surface was solved
  int read = 0;    ///< frames whose moving surfaces were all read from the store
};

/// All bodies of a scene over its frames. Thesis 5.3; SPEC 6.
///
/// The output of a frame is the mesh before that frame's solve: at the start frame it is the rest
/// mesh, unless there is a preroll, and the first motion shows one frame later. Frames are computed
/// in order from the first one, whatever the order of the calls, so their bits do not depend on
/// that order. Different simulations may be used in different threads; a single one is not
/// thread-safe.
class Simulation {
 public:
  /// Reads the meshes, finds the grids and checks every channel at every frame of the range.
  /// Errors: every problem found, with file and line if the scene is from a file; OutOfMemory if a
  /// surface is larger than `max_memory`; Interrupted.
  static Result<Simulation> make(Scene scene, const SimulationOptions& options = {});

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Checks that `make` would succeed, as far as possible without making the scene's sheets: reads
  /// its mesh files and checks all channels. A scene without a surface is valid. Returns notes on
  /// how its meshes are read. Errors: as `make`.
  static Result<std::vector<SceneNote>> check(const Scene& scene,
                                              const SimulationOptions& options = {});

  /// The scene's frames, start to end.
  FrameSequence frames() const;

  /// One frame, in any order. Cost: the solves from the latest kept or current frame before it;
  /// once the run has been played through, less than one interval of the `FrameCache`, and none if
  /// the store has the frame. Errors: InvalidInput outside `frames()`; NotFinite, SolverFailed,
  /// OutOfMemory, Interrupted, naming surface and frame; NotFinite also if a custom force returns
  /// an invalid value, naming the force. Exceptions of a custom force pass to the caller.
  ///
  /// The frame reuses the memory of `reuse`, an earlier frame or an empty one. Playing on with it
  /// allocates nothing while regions keep their shape, except for checkpoints, stores, custom
  /// functions, recovering nodes, and solvers with sparse factors.
  Result<Frame> at(int frame, Frame reuse = {});

  /// The solve at a frame, in any order: regions, forces, steps. A surface that is not solved at
  /// the frame has an empty report. The last frame's solve is reported too, although no frame shows
  /// it. Cost and errors: as `at`.
  Result<FrameReport> report(int frame, ReportDetail detail = ReportDetail::Counts);

  /// The state of a surface, by its index in the scene, at the frame of the last `report`; before
  /// any, at the first frame.
  const BodyState& state(std::size_t surface) const;

  /// The mesh of each collider that is one, null of the others: what `DrawnCollider` draws.
  std::vector<std::shared_ptr<const ColliderMesh>> collider_meshes() const;

  /// The state at a frame as sealed bytes, to continue in another process with `restore`. Cost and
  /// errors: as `at`.
  Result<std::string> state_bytes(int frame);

  /// Restores the state of `state_bytes`, and returns its frame; later frames have the same bits as
  /// without. Errors: InvalidInput if the bytes are damaged, or the state is not that of this scene
  /// at that frame under this engine and solver: all inputs up to the frame must be the same, later
  /// ones may differ. A custom force without a key cannot be checked; the caller is responsible for
  /// it. Warnings then lack those of frames that were not computed here.
  Result<int> restore(std::string_view state_bytes);

  const Scene& scene() const;

  /// The surfaces at rest, in the order of the scene.
  std::span<const RestShape> rest_shapes() const;

  /// A force or group of the scene as it is in the world at a frame, with constant places and
  /// directions; itself if it follows nothing.
  Force in_world(const Force& force, int frame) const;
  Group in_world(const Group& group, int frame) const;

  /// The warnings of the frames computed or read so far, each cause once with its frames. A warning
  /// about something that never happens, such as a force that selects nothing, says that it is
  /// about these frames if they are not all.
  std::vector<Warning> warnings() const;

  /// The solver of the options.
  SolverChoice solver() const;

  /// The memory of the surfaces and a frame of each, without their solvers' factors. [bytes]
  std::size_t surface_memory() const;

  /// The memory that its surfaces and their solvers have reserved now, by the count that
  /// `max_memory` limits. [bytes]
  std::size_t reserved_memory() const;

  /// The work of all surfaces' solvers so far.
  SolverCounts solver_counts() const;

  FrameCounts frame_counts() const;

  /// The times of the frames computed so far, by stage, summed over surfaces that were solved in
  /// parallel; empty without `SimulationOptions::profile`. A caller may add its own stages.
  Profile profile() const;

 private:
  class Player;

  explicit Simulation(std::unique_ptr<Player> player);

  std::unique_ptr<Player> player_;  // null once moved from
};

/// Previews the forces of a simulation, as `preview_forces` of feedback/preview.hpp, within
/// `options.max_memory`. Errors: further OutOfMemory.
Result<std::vector<Preview>> preview_forces(const Simulation& simulation,
                                            const SimulationOptions& options = {});

/// Previews the slowest vibration of a surface, as `preview_slowest` of feedback/preview.hpp,
/// within `options.max_memory`. Errors: further OutOfMemory.
Result<std::optional<Preview>> preview_slowest(const Simulation& simulation, std::size_t surface,
                                               const SimulationOptions& options = {});

/// Plays a surface's animation, as `play_forces` of feedback/preview.hpp, within
/// `options.max_memory`. Errors: further OutOfMemory.
Result<PlayedPeak> play_forces(const Simulation& simulation, std::size_t surface, double until,
                               const SimulationOptions& options = {});

/// Finds numbers for a motion, as `suggest_material` of feedback/suggestion.hpp, within
/// `options.max_memory`. Errors: further OutOfMemory.
Result<Suggestion> suggest_material(const Simulation& simulation, const MotionGoals& goals,
                                    const SimulationOptions& options = {});

}  // namespace pliant
