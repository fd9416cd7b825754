#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame.hpp"
#include "pliant/sweep/measures.hpp"
#include "pliant/sweep/takes.hpp"

namespace pliant {

class Shelf;

/// What all takes of a sweep have in common.
struct SweepSettings {
  std::optional<FrameSpan> frames = {};  ///< that are measured and written; none: the scene's
  SolverChoice solver = SolverChoice::Auto;
  std::string root = {};  ///< as in `load_scene`, for files that changes name
};

/// What a take's run may use.
struct TakeRun {
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();  ///< as `SimulationOptions`
  int threads = 1;
  StopRequest should_stop = {};
  Shelf* shelf = nullptr;  ///< what is shared with other takes; null: nothing is
  std::string file = {};   ///< the animation is written to it as by a bake; empty: nowhere
  /// Called with the scene before it is simulated and at the end; an error fails the take.
  std::function<Result<void>(const Scene&)> check = {};
  /// Called with each frame that is measured; false ends the take there, and its measures are those
  /// of the frames so far. An error fails it. Not with a file.
  std::function<Result<bool>(const Simulation&, const Frame&)> watch = {};
};

/// How a take ended.
struct TakeOutcome {
  std::size_t take = 0;
  Result<Measures> measures;
  double seconds = 0;      ///< that it took
  std::size_t memory = 0;  ///< of its surfaces, as `Simulation::surface_memory` [bytes]
};

/// How takes are run.
struct SweepRun {
  int threads = 1;  ///< >= 1: as many takes at once; those left over work inside of takes
  /// Memory for all takes at once. Fewer run at once if it is short, and a take fails for lack of
  /// memory only if all of it does not suffice. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();
  StopRequest should_stop = {};                               ///< called from any thread
  std::function<std::string(std::size_t take)> file_of = {};  ///< `TakeRun::file`; empty: none
  std::function<Result<void>(const Scene&)> check = {};       ///< `TakeRun::check`, from any thread
  /// `TakeRun::watch`, from any thread. A take that begins again with more memory comes again.
  std::function<Result<bool>(std::size_t take, const Simulation&, const Frame&)> watch = {};
  /// Called for each take that ended, one call at a time, from any thread, in any order. An error
  /// ends the run.
  std::function<Result<void>(const TakeOutcome&)> take_done = {};
};

/// How many takes a run begins with at once, and the memory that each of them may use [bytes].
struct TakesAtOnce {
  std::size_t count = 1;
  std::size_t memory = std::numeric_limits<std::size_t>::max();
};
TakesAtOnce takes_at_once(std::size_t takes, int threads, std::size_t max_memory);

/// The least memory with which so many takes at once may use so much each. [bytes]
std::size_t memory_of_takes(std::size_t count, std::size_t each);

/// A scene that is run many times, each take with other values. Immutable: several threads may use
/// one. The bits of a take are those of a simulation of the scene edited so by hand.
/// docs/sweeps.md.
class Sweep {
 public:
  /// Checks each value that a take gives to a path, ahead of all runs; what only a combination of
  /// values makes wrong fails that take.
  ///
  /// Errors: InvalidInput, beginning with the option as typed: a path that a scene does not have,
  /// with the nearest; a value that it does not take, with its rule; frames that a scene does not
  /// have. Interrupted. Requires: as many scenes as the takes have.
  static Result<Sweep> make(std::vector<Scene> scenes, Takes takes, SweepSettings settings = {},
                            const StopRequest& should_stop = {});

  /// The same without checking values.
  static Sweep unchecked(std::vector<Scene> scenes, Takes takes, SweepSettings settings = {});

  const Takes& takes() const { return takes_; }
  const SweepSettings& settings() const { return settings_; }
  std::span<const Scene> scenes() const { return scenes_; }

  /// The scene of a take. Errors: those of `make_changes`. Requires: take < takes().count().
  Result<Scene> scene_of(std::size_t take) const;

  /// The frames of a take that are measured. Errors: InvalidInput: its scene has others.
  Result<FrameSpan> frames_of(const Scene& scene) const;

  /// Runs a take. Errors: those of `scene_of`, `Simulation::make` and `at`, of the writer, and of
  /// `TakeRun::check`; Interrupted.
  TakeOutcome run(std::size_t take, const TakeRun& options) const;

  /// Runs takes. A take that fails stops nothing. Errors: Interrupted; that of `take_done`. An
  /// exception of a force or of a callback ends the run, and passes to the caller.
  /// Requires: each take < takes().count().
  Result<void> run(std::span<const std::size_t> takes, const SweepRun& options) const;

  /// Calls `look_at` with a scene for each file name that some take gives to a mesh or cache, and
  /// with each scene as it is. Errors: those of `look_at`; Interrupted.
  Result<void> for_each_variant(const std::function<Result<void>(const Scene&)>& look_at,
                                const StopRequest& should_stop = {}) const;

 private:
  Sweep(std::vector<Scene> scenes, Takes takes, SweepSettings settings);

  Result<void> check_values(const StopRequest& should_stop) const;
  Result<void> check_table(const Scene& scene) const;
  Result<void> check_frames(const StopRequest& should_stop) const;

  std::vector<Scene> scenes_;
  Takes takes_;
  SweepSettings settings_;
};

}  // namespace pliant
