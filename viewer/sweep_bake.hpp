#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/sweep/folder.hpp"

namespace pliant::viewer {

inline constexpr std::size_t most_pictured = 100;

/// What the page of a sweep shows.
struct SweepViewPlan {
  std::vector<std::size_t> takes;     ///< that have a picture, ascending
  std::map<std::size_t, int> frames;  ///< of each of them
};

/// At most `most_pictured` takes that are done, evenly spread, each at the frame of its peak or at
/// `frame`. Errors: InvalidInput, naming the frame: a take does not have it; those of
/// `Sweep::scene_of`.
Result<SweepViewPlan> plan_sweep_view(const SweepFolder& folder, const SweepStatus& status,
                                      std::optional<int> frame);

/// The data of a page.
struct SweepBake {
  std::string packed;        ///< a raw deflate stream; docs/viewer.md describes its content [bytes]
  std::size_t pictured = 0;  ///< takes
  std::map<std::size_t, std::string> failed;  ///< why takes have no picture
};

/// How takes are run for their pictures.
struct SweepViewRun {
  int threads = 1;
  std::size_t max_memory = 0;  ///< [bytes]
  StopRequest should_stop = {};
  std::string command = {};              ///< that bakes a take, without its number
  std::function<void()> take_done = {};  ///< called for each, one call at a time
};

/// The name of a folder, printable, without those that it is in, also of `.` and `a/..`; the whole,
/// if it has none.
std::string name_of_folder(const std::string& folder);

/// Runs the takes of the plan up to their frames, and packs their shapes and the table. Errors:
/// Interrupted; OutOfMemory.
Result<SweepBake> bake_sweep(const SweepFolder& folder, const SweepStatus& status,
                             const SweepViewPlan& plan, const SweepViewRun& run);

}  // namespace pliant::viewer
