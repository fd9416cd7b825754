#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/sweep/request.hpp"
#include "pliant/sweep/sweep.hpp"

namespace pliant {

/// Whether a take was run.
enum class TakeStatus { Missing, Failed, Done };

/// What is known of a take.
struct TakeRecord {
  TakeStatus status = TakeStatus::Missing;
  Measures measures = {};  ///< of a take that is done
  std::string error = {};  ///< of a take that failed, with names of files without their folders
  std::string full_error = {};  ///< the same with the folders
  double seconds = 0;           ///< that it took, by its line

  /// Whether a run is to run it; with `retry` also a take that failed.
  bool is_due(bool retry) const {
    return status == TakeStatus::Missing || (retry && status == TakeStatus::Failed);
  }
};

/// Two lines of the log of one take whose hashes differ.
struct HashConflict {
  std::size_t take = 0;
  std::string host, other_host;
};

/// What the log of a sweep says.
struct SweepStatus {
  std::vector<TakeRecord> takes = {};
  std::vector<HashConflict> conflicts = {};  ///< by take
  std::size_t done = 0;
  std::size_t failed = 0;

  std::size_t missing() const { return takes.size() - done - failed; }
  bool is_complete() const { return done == takes.size() && conflicts.empty(); }
};

/// The takes t with t mod count = part.
struct SweepPart {
  std::size_t part = 0;
  std::size_t count = 1;

  bool has(std::size_t take) const { return take % count == part; }
};

/// How the takes of a folder are run.
struct FolderRun {
  int threads = 1;
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();
  StopRequest should_stop = {};
  SweepPart part = {};
  bool retry = false;  ///< also takes that failed
  /// Called with the number of takes to run, ahead of the first.
  std::function<void(std::size_t count)> begin = {};
  /// Called for each take that ended, one call at a time, from any thread.
  std::function<void(const TakeOutcome&)> take_done = {};
};

/// A sweep in a folder: its takes may be run by any number of processes, on any machines that see
/// it, in parts, again after a kill. The folder is all the state there is. docs/sweeps.md.
class SweepFolder {
 public:
  /// Makes a sweep in a folder that is empty or not there, or opens the one that is there if it is
  /// the same. Errors: those of `load_scene`, `Takes::make` and `Sweep::make`; InvalidInput: a
  /// folder with other files; a sweep with other arguments, scenes or engine, naming the
  /// difference; a name or value that is not UTF-8. Unwritable. Interrupted. Then no folder is
  /// left that was not there.
  static Result<SweepFolder> make(const std::string& folder, const SweepRequest& request,
                                  const StopRequest& should_stop = {});

  /// Opens a sweep. `root`, as in `load_scene`, takes the place of the sweep's own, for a sweep of
  /// a stranger. Errors: InvalidInput, Unreadable: it is none; it has another engine; its scenes
  /// lead to a file outside the root. Interrupted.
  static Result<SweepFolder> open(const std::string& folder, const StopRequest& should_stop = {},
                                  const std::string& root = {});

  /// The sweep of a request without a folder. Errors: as `make`.
  static Result<Sweep> plan(const SweepRequest& request, const StopRequest& should_stop = {});

  SweepFolder(SweepFolder&&) noexcept;
  SweepFolder& operator=(SweepFolder&&) = delete;
  ~SweepFolder();

  const std::string& folder() const;
  const Sweep& sweep() const;
  const SweepRequest& request() const;  ///< without the text of a table

  /// Reads the log. A take is done if a line says so and its files are there. Errors: Unreadable;
  /// Interrupted.
  Result<SweepStatus> status(const StopRequest& should_stop = {}) const;

  /// Runs the takes of a part that are missing, and adds a line to the log for each. Errors:
  /// those of `status`; Unwritable; Interrupted.
  Result<void> run(const FolderRun& options) const;

  /// Checks that a take's meshes, caches and maps are those of the sweep. Errors: Unreadable.
  Result<void> check_inputs(const Scene& scene, const StopRequest& should_stop = {}) const;

  /// Writes `takes.csv`. Errors: Unwritable; Interrupted.
  Result<void> write_table(const SweepStatus& status, const StopRequest& should_stop = {}) const;

  /// Makes a folder in that of the sweep, if it is not there. Errors: InvalidInput: a link is in
  /// its place; Unwritable.
  Result<void> make_inner_folder(const std::string& name) const;

 private:
  class Contents;
  explicit SweepFolder(std::unique_ptr<Contents> contents);
  std::unique_ptr<Contents> contents_;
};

/// Writes the table of a sweep, some rows at a time. Errors: those of `write`.
Result<void> write_table(const Sweep& sweep, const std::vector<std::string>& scenes,
                         const std::vector<TakeRecord>& records,
                         const std::function<Result<void>(std::string_view)>& write);

/// `take 17 (sheet.c=-5, sheet.d=2)`; with several scenes, `scene=FILE` comes first.
std::string title_of(const Sweep& sweep, const std::vector<std::string>& scenes, std::size_t take);

}  // namespace pliant
