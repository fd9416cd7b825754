#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/profile.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame.hpp"
#include "pliant/simulation/frame_report.hpp"
#include "pliant/simulation/frame_sequence.hpp"
#include "pliant/simulation/rest_shape.hpp"
#include "pliant/simulation/warnings.hpp"

namespace pliant {

class FrameStore;

/// How a simulation runs; none of it but the solver changes a result, and that by some 1e-9 of it
/// at most: docs/model.md.
struct SimulationOptions {
  /// Memory for kept states, so that going back in time is quick: `FrameCache` tells what a frame
  /// then costs. [bytes]
  std::size_t checkpoint_bytes = std::size_t{256} << 20;

  /// Memory that surfaces, solvers and kept states may take together; what does not fit is refused
  /// before it is allocated. Kept states give way to solvers. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();

  /// Threads that work on several surfaces at the same time, or on the parts of a single one, the
  /// caller's among them. >= 1
  int threads = 1;

  /// Who solves. Requires: available in this build.
  SolverChoice solver = SolverChoice::Auto;

  /// Whether `Simulation::profile` is kept.
  bool profile = false;

  /// Doubles in the solver's vectors, as far as the machine lets us choose: to show that they
  /// change no bit.
  int most_lanes = widest_lanes;

  /// Asked ahead of every surface that is read, while assimp reads one, and ahead of every time
  /// step, by any of the threads;
  /// `make` and `at` then fail with Interrupted.
  StopRequest should_stop = {};

  /// Where states are kept beyond this simulation, so that another one, of the same scene or of an
  /// edited one, need not solve again what is the same. Outlives the simulation; none: nowhere.
  FrameStore* store = nullptr;
};

/// What it took to get at frames, each time one was gone to from the frame before it.
struct FrameCounts {
  int solved = 0;  ///< frames for which a surface was stepped
  int read = 0;    ///< frames for which all that moves came out of the store
};

/// All bodies of a scene over its frames. Thesis 5.3; SPEC 6.
///
/// The output of a frame is the mesh before that frame's solve: at the start frame it is the rest
/// mesh, and the first motion shows one frame later. Frames are computed in order from the scene's
/// first one, whatever order they are asked for in, so they have the same bits in any order.
/// Two simulations may run in two threads; one may not.
class Simulation {
 public:
  /// Reads the meshes, finds the grids and checks every channel at every frame of the range.
  /// Errors: every problem found, with file and line where the scene came from a file; OutOfMemory
  /// where a surface is larger than `max_memory`; Interrupted.
  static Result<Simulation> make(Scene scene, const SimulationOptions& options = {});

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Whether `make` would succeed, as far as it is known without making the sheets of the scene:
  /// reads its mesh files and looks at all channels. A scene without a surface is all right.
  /// Errors: as `make`.
  static Result<void> check(const Scene& scene, const SimulationOptions& options = {});

  /// The scene's frames, start to end.
  FrameSequence frames() const;

  /// One frame, in any order. Cost: the solves between it and the latest kept or current frame
  /// ahead; once the run has been played through, less than one interval of the `FrameCache`, and
  /// none where the store has it. Errors: InvalidInput outside `frames()`; NotFinite, SolverFailed,
  /// OutOfMemory, Interrupted, naming surface and frame; NotFinite also where a custom force gives
  /// no sound answer, naming it too. What a custom force throws goes on to the caller.
  ///
  /// The frame takes the memory of `reuse`, an earlier frame or none. Playing on with it allocates
  /// nothing while regions keep their shape, but for checkpoints, stores, functions of a program's
  /// own, what recovers, and solvers with sparse factors.
  Result<Frame> at(int frame, Frame reuse = {});

  /// What the solve at a frame takes from its mesh, in any order: regions, forces, steps. A surface
  /// that is not solved at the frame has an empty report. The last frame's solve is told of like
  /// any other, though no frame shows it. Cost and errors: as `at`.
  Result<FrameReport> report(int frame);

  /// What a surface, by its index in the scene, hands on at the frame that `report` last gave; at
  /// the first one ahead of any.
  const BodyState& state(std::size_t surface) const;

  /// The state at a frame as sealed bytes, to go on from in another process: `restore`. Cost and
  /// errors: as `at`.
  Result<std::string> state_bytes(int frame);

  /// Goes to the frame whose `state_bytes` these are, and gives its number; frames from there on
  /// have the same bits as without. Errors: InvalidInput where the bytes are damaged, or the state
  /// is not this scene's at that frame under this engine and solver: what acts until then must be
  /// the same, what comes later need not. Of a custom force without a key nothing is known; whoever
  /// restores answers for it. Warnings then lack those of frames that were never computed here.
  Result<int> restore(std::string_view state_bytes);

  const Scene& scene() const;

  /// The surfaces at rest, in the order of the scene.
  std::span<const RestShape> rest_shapes() const;

  /// What the frames computed, or read, so far gave reason to warn about, each cause once with its
  /// frames. What happens in no frame at all, such as a force that selects nothing, is told once
  /// all frames have been.
  std::vector<Warning> warnings() const;

  /// What the surfaces take, and a frame of each, without their solvers' factors. [bytes]
  std::size_t surface_memory() const;

  /// What the surfaces' solvers had to do so far, added up.
  SolverCounts solver_counts() const;

  FrameCounts frame_counts() const;

  /// How long the frames computed so far took, by stage and added up over surfaces that went at the
  /// same time; nothing without `SimulationOptions::profile`. A caller may add to it what it knows.
  Profile profile() const;

 private:
  class Run;

  explicit Simulation(std::unique_ptr<Run> run);

  std::unique_ptr<Run> run_;  // null once moved from
};

}  // namespace pliant
