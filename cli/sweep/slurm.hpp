#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant::cli {

// Slurm, as its own commands tell it. A command that gives no answer is ended: sbatch after 120 s,
// the others after 30 s.

/// A job, or an array of jobs.
struct SlurmJob {
  std::string number;
  std::string cluster = {};  ///< empty: the cluster of the commands
};

/// The job that a text names as `sbatch --parsable` prints it, `123` or `123;cluster`; null: none.
std::optional<SlurmJob> parse_slurm_job(std::string_view text);

/// Slurm's MaxArraySize, which no index of an array reaches. Errors: Unwritable, also if there
/// is no answer for so long; Interrupted.
Result<std::size_t> max_array_size(std::chrono::seconds patience);

/// The number of a job with this script that is queued or running, the least if there are several;
/// empty: there is none. Jobs are told by the file of their script; `known` is asked for by its
/// number too, for jobs that the user does not see in the list, or whose file has another name
/// here. For a job that is ending it waits, five seconds at most: it may be queued again. Errors:
/// Unwritable, with Slurm's message; Interrupted.
Result<std::string> active_job(const std::string& script, const std::optional<SlurmJob>& known);

/// Submits a job by this command line of sbatch, the script last. Messages of sbatch go to stderr,
/// printable, 200 lines at most. Errors: Unwritable: sbatch refused it, or gives no answer.
Result<SlurmJob> submit(const std::vector<std::string>& words);

/// Cancels a job, if that is possible.
void cancel(const SlurmJob& job);

/// Waits until no task of a job is queued, running or completing. As long as Slurm does not answer
/// the job counts as running. `meanwhile` is called some twenty times a second, with whether a task
/// was seen to run. Errors: Interrupted; Unwritable: there is no squeue.
Result<void> wait_for(const SlurmJob& job, const std::function<void(bool has_run)>& meanwhile);

}  // namespace pliant::cli
