#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/replay/comparison.hpp"
#include "pliant/replay/log.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

// Recording what a scene computes, bit for bit, and comparing later. SPEC 10; docs/replay.md.

struct ReplayOptions {
  /// A log is verified by the solver that it was recorded with, whatever this says.
  SimulationOptions simulation = {};

  /// Where what meshes refer to lies, as `load_scene` takes it.
  std::string root = {};

  /// Records no further than to this frame; none: to the scene's last one.
  std::optional<int> last_frame = {};

  /// Records whole states at every such frame from the first one on; 0: hashes only.
  int states_every = 0;

  /// Goes on after the first difference.
  bool keeps_going = false;

  /// Told of each frame that is done, and of how many there are.
  std::function<void(long frame_count)> frame_done = [](long) {};
};

/// Simulates a scene and writes the log, which appears whole or not at all.
/// Errors: those of `load_scene`, `Simulation::make` and `report`; Unreadable; Unwritable;
/// InvalidInput where the log would take the place of the scene or of a file that it names, or of
/// something that is no regular file, or where `last_frame` is none of the scene's.
Result<ReplayHeader> record_replay(const std::string& scene_file, const std::string& log_file,
                                   const ReplayOptions& options = {});

/// Simulates what a log recorded, and compares: the scene file that is given, else the one that was
/// recorded, else, where that is not there, its text in the log. Meshes are looked for from the
/// scene's folder. Errors: as `record_replay`, with what the log knows of their cause; InvalidInput
/// for a log that was changed or cut short, naming its line.
Result<ReplayVerdict> verify_replay(const std::string& log_file,
                                    const std::optional<std::string>& scene_file = {},
                                    const ReplayOptions& options = {});

/// Compares two logs; states where both have them. Errors: as `verify_replay` for its log.
Result<ReplayVerdict> compare_replays(const std::string& log_file,
                                      const std::string& other_log_file,
                                      const ReplayOptions& options = {});

}  // namespace pliant
