#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/replay/comparison.hpp"
#include "pliant/replay/log.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

// Recording the results of a scene, bit for bit, and comparing them later. SPEC 10; docs/replay.md.

struct ReplayOptions {
  /// To verify a log, the solver that recorded it is used instead of the one given here.
  SimulationOptions simulation = {};

  /// The folder for all files that the scene leads to, as in `load_scene`.
  std::string root = {};

  /// Changes to make in the scene ahead of recording it, as `--set` takes them: `PATH=TEXT`,
  /// `PATH*=K`, `PATH+=V`. A log has them, and they are made again to verify it.
  std::vector<std::string> changes = {};

  /// Records up to this frame; nullopt: up to the scene's last one.
  std::optional<int> last_frame = {};

  /// Records whole states at every n-th frame, from the first one on; 0: hashes only.
  int states_every = 0;

  /// Continues after the first difference.
  bool keeps_going = false;

  /// Called after each frame, with the total number of frames.
  std::function<void(long frame_count)> frame_done = {};
};

/// Simulates a scene and writes the log, which appears whole or not at all. Errors: those of
/// `load_scene`, `Simulation::make` and `report`; Unreadable; Unwritable; InvalidInput if the log
/// would replace the scene, a file that it names, or anything that is not a regular file, or if
/// `last_frame` is not a frame of the scene.
Result<ReplayHeader> record_replay(const std::string& scene_file, const std::string& log_file,
                                   const ReplayOptions& options = {});

/// The same for a simulation of a program, whose scene may be one that no file can contain: with
/// meshes as arrays and functions as forces. The log has the scene as text if it can be written;
/// meshes are named relative to the log's folder. `options.simulation` is not used, but for its
/// threads.
Result<ReplayHeader> record_replay(Simulation& simulation, const std::string& log_file,
                                   const ReplayOptions& options = {});

/// Simulates the recorded run again, and compares. Uses the given scene file; without one, the
/// recorded file; if that does not exist, the scene text in the log. Meshes are looked up in the
/// scene's folder. Errors: as `record_replay`, with causes known from the log; InvalidInput for a
/// log that was changed or truncated, naming its line.
Result<ReplayVerdict> verify_replay(const std::string& log_file,
                                    const std::optional<std::string>& scene_file = {},
                                    const ReplayOptions& options = {});

/// Compares a recorded run with a simulation of a program. Errors: those of `Simulation::report`;
/// as `verify_replay` for its log; InvalidInput if the log was recorded with another solver.
Result<ReplayVerdict> verify_replay(const std::string& log_file, Simulation& simulation,
                                    const ReplayOptions& options = {});

/// Compares two logs, and their states if both have them. Errors: as `verify_replay` for its log.
Result<ReplayVerdict> compare_replays(const std::string& log_file,
                                      const std::string& other_log_file,
                                      const ReplayOptions& options = {});

}  // namespace pliant
