#include "cli/sweep/sweep_slurm.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/sweep/slurm.hpp"
#include "cli/sweep/slurm_script.hpp"
#include "cli/sweep/sweep.hpp"
#include "cli/sweep/sweep_memory.hpp"
#include "cli/terminal/child.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/shell_word.hpp"
#include "cli/terminal/usage.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/sweep/watch.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::size_t usual_array_size = 1001;  // Slurm's default
constexpr double part_seconds = 600;            // that a part should take

// Absolute, without "." and "/" at its end. A name is not resolved unless it must be: the nodes may
// know a folder by the link only.
Result<std::string> absolute_folder(const std::string& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder, error);
  if (!error && std::ranges::find(path, fs::path("..")) != path.end())
    path = fs::weakly_canonical(path, error);
  if (error) return fail(ErrorCode::Unreadable, error.message(), folder);
  fs::path plain;
  for (const fs::path& word : path)
    if (word != "." && !word.empty()) plain /= word;
  return plain.string();
}

Result<std::string> own_executable() {
  std::error_code error;
  const fs::path file = fs::read_symlink("/proc/self/exe", error);
  if (!error && fs::exists(file, error)) return file.string();
  return fail(ErrorCode::Unreadable, "--engine slurm: the file of this program is not found");
}

// The end of the indices of an array. What is written only may go to a cluster that this machine
// does not reach.
Result<std::size_t> largest_array(const SlurmOptions& options) {
  const auto size = max_array_size(options.writes_only ? 10s : 120s);
  if (size && *size == 0)
    return fail(ErrorCode::Unwritable, "this Slurm allows no job arrays (MaxArraySize=0)");
  if (size || (options.writes_only && !was_interrupted())) return size.value_or(usual_array_size);
  return fail(size.error());
}

// The takes to submit, and the parts that have some.
struct Due {
  std::vector<std::size_t> parts;
  std::vector<std::size_t> takes;  // of each of these parts

  std::size_t take_count(const std::vector<std::size_t>& chosen) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (std::ranges::binary_search(chosen, parts[k])) count += takes[k];
    return count;
  }
};

Due due_of(const SweepStatus& status, std::size_t parts, bool retries) {
  std::vector<std::size_t> counts(parts);
  for (std::size_t take = 0; take < status.takes.size(); ++take)
    if (status.takes[take].is_due(retries)) ++counts[take % parts];
  Due due;
  for (std::size_t part = 0; part < parts; ++part) {
    if (counts[part] == 0) continue;
    due.parts.push_back(part);
    due.takes.push_back(counts[part]);
  }
  return due;
}

// What a user's options of sbatch say that ours must know.
struct UserOptions {
  std::string array = {};  // list of parts
  bool has_memory_per_other = false;
  bool waits = false;
};

UserOptions read_user_options(const std::vector<std::string>& sbatch) {
  UserOptions found;
  for (std::size_t k = 0; k < sbatch.size(); ++k) {
    const std::string& word = sbatch[k];
    if (word.starts_with("--array=")) {
      found.array = word.substr(8);
    } else if ((word == "--array" || word == "-a") && k + 1 < sbatch.size()) {
      found.array = sbatch[k + 1];
    } else if (word.starts_with("-a")) {
      found.array = word.substr(2);
    }
    found.has_memory_per_other |= word.starts_with("--mem-per-");
    found.waits |= word == "--wait" || word == "-W";
  }
  return found;
}

// Errors: InvalidInput: a word that is no option, nor the value of the one before it. For sbatch it
// would be the script to submit.
Result<void> check_are_options(const std::vector<std::string>& sbatch) {
  bool may_be_value = false;
  for (const std::string& word : sbatch) {
    const bool is_option = word.starts_with('-') && word != "-" && word != "--";
    if (!is_option && !may_be_value)
      return invalid(fmt::format(
          "--sbatch {}: is not an option of sbatch, such as --partition=short", printable(word)));
    const bool has_value = word.starts_with("--") ? word.find('=') != std::string::npos
                                                  : word.size() > std::string_view("-p").size();
    may_be_value = is_option && !has_value;
  }
  return {};
}

// Over NFS a folder may be seen as it was up to a minute ago, until it is changed from here.
void see_anew(const fs::path& folder) {
  std::error_code ignored;
  if (fs::is_directory(fs::symlink_status(folder, ignored)))
    (void)AtomicFile::create(folder / "seen");
}

// Shows on a terminal how far the takes of a job are while it is waited for.
class WaitingBar {
 public:
  // For the takes that are true, `count` of them, of the sweep in a folder. Begins before a job
  // runs.
  WaitingBar(const std::string& folder, std::vector<bool> takes, std::size_t count, bool is_quiet)
      : progress_(static_cast<int>(count), is_quiet, "takes") {
    if (count == 0 || !progress_.is_shown()) return;
    if (auto watch = SweepWatch::begin(folder, std::move(takes), &was_interrupted))
      watch_.emplace(*std::move(watch));
  }

  // To be called often: looks at the log now and then. `is_running`: the job has begun.
  void look(bool is_running) {
    constexpr int share = 20;  // of the time, spent looking
    const auto begin = Clock::now();
    if (!watch_ || begin < next_) return;
    // What cannot be read now may be at the next look.
    (void)watch_->look(&was_interrupted);
    if ((is_running || watch_->ended() > 0) && !has_begun_) {
      has_begun_ = true;
      progress_.begin_again();
    }
    const std::size_t failed = watch_->failed();
    progress_.add_note(!has_begun_ ? ", queued"
                                   : (failed > 0 ? fmt::format(", {} failed", failed) : ""));
    progress_.reach(static_cast<int>(watch_->ended()));
    const auto end = Clock::now();
    next_ = end + std::max<Clock::duration>(1s, share * (end - begin));
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<SweepWatch> watch_;  // null: nothing is shown
  Progress progress_;
  bool has_begun_ = false;
  Clock::time_point next_ = {};
};

// One sweep on its way to Slurm.
class Submission {
 public:
  Submission(const SweepFolder& folder, const SlurmOptions& options,
             const ResourceOptions& resources, bool retries, bool is_quiet)
      : folder_(folder),
        options_(options),
        resources_(simulation_options(resources)),
        user_(read_user_options(options.sbatch)),
        threads_(std::max(1, resources.threads)),
        max_memory_(resources.max_memory),
        retries_(retries),
        is_quiet_(is_quiet) {}

  int run() {
    const auto ran = run_steps();
    if (ran) return *ran;
    if (job_.number.empty())
      return report(with_kept(ran.error(), "nothing is submitted; takes that ended are kept"));
    Error error = ran.error();
    error.message +=
        fmt::format("; job {} goes on; pliant sweep status tells how far it is", job_.number);
    return report(error);
  }

 private:
  Result<int> run_steps() {
    auto status = folder_.status(&was_interrupted);
    if (!status) return fail(status.error());
    if (!has_due(*status)) return tell_status(folder_, is_quiet_);
    auto absolute = absolute_folder(folder_.folder());
    if (!absolute) return fail(absolute.error());
    name_ = *std::move(absolute);
    if (!options_.writes_only) {
      if (auto free = check_no_job(); !free) return fail(free.error());
    }
    if (!options_.parts) {
      if (const int code = run_take_0(*status); code != exit_done) return code;
      status = folder_.status(&was_interrupted);
      if (!status) return fail(status.error());
      if (!has_due(*status)) return tell_status(folder_, is_quiet_);
    }
    const auto words = prepare(*status);
    if (!words) return fail(words.error());
    if (options_.writes_only) {
      print(stdout, shell_line(*words) + '\n');
      return exit_done;
    }
    std::optional<WaitingBar> bar;  // from before the job may run
    if (options_.waits) {
      std::vector<bool> takes = submitted_takes(*status);
      const auto count = static_cast<std::size_t>(std::ranges::count(takes, true));
      bar.emplace(name_, std::move(takes), count, is_quiet_);
    }
    if (auto sent = send(*words); !sent) return fail(sent.error());
    if (!options_.waits) return exit_done;
    const auto waited = wait_for(job_, [&](bool has_run) { bar->look(has_run); });
    bar.reset();
    if (!waited) return fail(waited.error());
    for (const char* name : {"log", "takes"}) see_anew(fs::path(name_) / name);
    const int code = tell_status(folder_, is_quiet_);
    if (code != exit_done)
      print(stderr, fmt::format("job {} has ended; what its parts said is in {}/slurm/{}_*.log\n",
                                job_.number, printable(folder_.folder()), job_.number));
    return code;
  }

  bool has_due(const SweepStatus& status) const {
    return std::ranges::any_of(status.takes,
                               [&](const TakeRecord& take) { return take.is_due(retries_); });
  }

  std::string script() const { return name_ + "/slurm/job.sh"; }
  std::string record() const { return name_ + "/slurm/job"; }

  Result<void> check_no_job() const {
    constexpr std::size_t longest = 1000;
    std::error_code ignored;
    std::optional<SlurmJob> known;
    if (fs::is_regular_file(record(), ignored))
      known = parse_slurm_job(read_file(record(), longest).value_or(""));
    const auto active = active_job(script(), known);
    if (!active) return fail(active.error());
    if (active->empty()) return {};
    return fail(ErrorCode::Unwritable,
                fmt::format("{}: job {} of this sweep is queued or running; scancel {} ends it",
                            printable(folder_.folder()), *active, *active));
  }

  // Runs take 0 unless it has ended before. Returns the exit code.
  int run_take_0(const SweepStatus& status) {
    if (status.takes.front().is_due(retries_)) {
      // In one thread, as parts run it, and more would disturb others on this machine.
      const auto ran = folder_.run({.threads = 1,
                                    .max_memory = resources_.max_memory,
                                    .should_stop = resources_.should_stop,
                                    .part = take_0(),
                                    .retry = retries_});
      if (!ran) return report(with_kept(ran.error(), "nothing is submitted"));
    }
    const auto after = folder_.status(&was_interrupted);
    if (!after) return report(after.error());
    if (after->takes.front().status == TakeStatus::Done) return exit_done;
    print_failures(folder_, *after, take_0());
    print(stderr, "take 0 failed, so nothing is submitted; --parts P submits without running it\n");
    return exit_failed;
  }

  SweepPart take_0() const { return {0, folder_.sweep().takes().count()}; }

  // Writes job.sh. Returns the command line of sbatch.
  Result<std::vector<std::string>> prepare(const SweepStatus& status) {
    const auto largest = largest_array(options_);
    if (!largest) return fail(largest.error());
    const std::size_t takes = status.takes.size();
    const TakeRecord& first = status.takes.front();
    const bool is_timed = first.status == TakeStatus::Done && first.seconds >= 0;
    const double take_seconds = is_timed ? first.seconds : 0;
    const std::size_t most = std::min(takes, *largest);
    parts_ = options_.parts ? static_cast<std::size_t>(*to_integer(*options_.parts))
                            : parts_of(takes, take_seconds, most);
    if (auto fits = check_user_array(*largest); !fits) return fail(fits.error());
    due_ = due_of(status, parts_, retries_);
    const auto executable = own_executable();
    if (!executable) return fail(executable.error());
    SlurmScript text{.executable = *executable,
                     .folder = name_,
                     .name = fs::path(name_).filename().string(),
                     .parts = parts_,
                     .threads = threads_,
                     .max_memory = max_memory_,
                     .root = options_.root,
                     .retries = retries_};
    if (!user_.has_memory_per_other) {
      const auto memory = memory_of_part(folder_.sweep(), threads_, resources_);
      if (!memory) return fail(memory.error());
      text.memory = *memory;
    }
    if (is_timed) text.seconds = static_cast<double>(takes_of_thread(takes)) * take_seconds;
    const std::string list = array_list(due_.parts);
    submitted_ = read_array_list(user_.array.empty() ? list : user_.array, parts_)
                     .value_or(due_.parts);  // a user's list that is none is for sbatch to refuse
    std::vector<std::string> words = {"sbatch", "--parsable", "--array=" + list};
    words.insert(words.end(), options_.sbatch.begin(), options_.sbatch.end());
    words.push_back(script());
    text_ = job_script(text);
    if (auto written = write("job.sh", text_); !written) return fail(written.error());
    return words;
  }

  // A task without a part would only fail.
  Result<void> check_user_array(std::size_t largest) const {
    const auto chosen = read_array_list(user_.array, largest);
    if (!chosen || chosen->empty() || chosen->back() < parts_) return {};
    return invalid(fmt::format("--sbatch --array={}: there is no part {}; the parts are 0 to {}",
                               printable(user_.array), chosen->back(), parts_ - 1));
  }

  // The takes that a thread of a part runs one after the other, at most.
  std::size_t takes_of_thread(std::size_t takes) const {
    const auto threads = static_cast<std::size_t>(threads_);
    const std::size_t takes_of_part = (takes + parts_ - 1) / parts_;
    return (takes_of_part + threads - 1) / threads;
  }

  std::size_t parts_of(std::size_t takes, double take_seconds, std::size_t most) const {
    const double wanted =
        std::ceil(static_cast<double>(takes) * take_seconds / (threads_ * part_seconds));
    if (!(wanted < static_cast<double>(most))) return most;
    return std::max<std::size_t>(1, static_cast<std::size_t>(wanted));
  }

  // A file in the folder `slurm` of the sweep.
  Result<void> write(const std::string& name, std::string_view text) const {
    if (auto made = folder_.make_inner_folder("slurm"); !made) return made;
    return write_file(fs::path(name_) / "slurm" / name, text);
  }

  Result<void> send(const std::vector<std::string>& words) {
    if (was_interrupted()) return interrupted();
    const auto job = submit(words);
    if (!job) return fail(job.error());
    // Of two submissions at once each sees the other's job now: the one with the lesser number
    // stays. sbatch may have read the other's script, which divides the takes in another way.
    const auto other = active_job(script(), {});
    const bool is_later = other && !other->empty() && is_less(*other, job->number);
    if (is_later || read_file(script(), text_.size()).value_or("") != text_) {
      cancel(*job);
      return fail(ErrorCode::Unwritable,
                  fmt::format("{}: {} was submitted at the same time; job {} is cancelled",
                              printable(folder_.folder()),
                              is_later ? fmt::format("job {} of this sweep", *other)
                                       : std::string("another job of this sweep"),
                              job->number));
    }
    job_ = *job;
    print(stdout, fmt::format("submitted {}: {} parts, {} takes\n{}\n", job_.number,
                              submitted_.size(), due_.take_count(submitted_), shell_line(words)));
    // For a job that the list does not show. Without this file the list is all there is.
    const std::string known = job_.cluster.empty() ? job_.number : job_.number + ';' + job_.cluster;
    (void)write("job", known + '\n');
    return {};
  }

  std::vector<bool> submitted_takes(const SweepStatus& status) const {
    std::vector<bool> takes(status.takes.size());
    for (std::size_t take = 0; take < takes.size(); ++take)
      takes[take] = status.takes[take].is_due(retries_) &&
                    std::ranges::binary_search(submitted_, take % parts_);
    return takes;
  }

  static bool is_less(const std::string& one, const std::string& other) {
    return one.size() != other.size() ? one.size() < other.size() : one < other;
  }

  const SweepFolder& folder_;
  const SlurmOptions& options_;
  SimulationOptions resources_;
  UserOptions user_;
  int threads_;
  double max_memory_;  // as typed [GB]; 0: not
  bool retries_;
  bool is_quiet_;
  std::string name_;  // of the folder, absolute
  std::string text_;  // of job.sh
  std::size_t parts_ = 1;
  Due due_;
  std::vector<std::size_t> submitted_;  // parts
  SlurmJob job_ = {};
};

}  // namespace

void add_slurm(CLI::App& run, SlurmOptions& options) {
  run.add_option("--engine", options.engine,
                 "Submit the takes that are missing as one job array to this batch engine")
      ->check(one_of({"slurm"}));
  run.add_option("--parts", options.parts,
                 "With --engine: number of parts, in place of the one by which a part takes about "
                 "ten minutes; no take is run here");
  run.add_option("--sbatch", options.sbatch,
                 "With --engine: an option of sbatch, as often as needed, which wins over those of "
                 "pliant")
      ->type_name("OPTION")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  run.add_flag("--no-submit", options.writes_only,
               "With --engine: write DIR/slurm/job.sh, and print the command that submits it");
  run.add_flag("--wait", options.waits, "With --engine: wait until the job has ended");
}

Result<void> check_slurm(const CLI::App& run, const SlurmOptions& options,
                         const std::string& folder) {
  if (!options.engine) {
    for (const char* option : {"--parts", "--sbatch", "--no-submit", "--wait"})
      if (run.count(option) > 0) return invalid(fmt::format("{}: needs --engine slurm", option));
    return {};
  }
  if (run.count("--part") > 0)
    return invalid("--part: --engine slurm divides the takes into parts by itself");
  if (options.writes_only && options.waits)
    return invalid("--wait: nothing is submitted with --no-submit");
  if (read_user_options(options.sbatch).waits)
    return invalid("--sbatch --wait: to wait for the array, give --wait of pliant");
  if (auto are = check_are_options(options.sbatch); !are) return are;
  if (options.parts) {
    const auto parts = to_integer(*options.parts);
    if (!parts || *parts < 1)
      return invalid(fmt::format("--parts {}: must be an integer >= 1", printable(*options.parts)));
  }
  const auto absolute = absolute_folder(folder);
  if (!absolute) return fail(absolute.error());
  if (const auto reason = wrong_slurm_folder(*absolute); !reason.empty())
    return invalid(fmt::format("{}: {}", printable(*absolute), reason));
  if (!options.writes_only && !is_on_path("sbatch"))
    return invalid(
        "--engine slurm: there is no sbatch on the PATH; submit from a machine of the cluster");
  return {};
}

Result<void> check_slurm_parts(const SlurmOptions& options, std::size_t takes) {
  if (!options.parts) return {};
  const auto parts = static_cast<std::size_t>(*to_integer(*options.parts));
  if (parts > takes)
    return invalid(
        fmt::format("--parts {}: must be at most {}, the number of takes", parts, takes));
  const auto largest = largest_array(options);
  if (!largest) return fail(largest.error());
  if (parts > *largest)
    return invalid(
        fmt::format("--parts {}: must be at most {}, Slurm's MaxArraySize", parts, *largest));
  return {};
}

int run_on_slurm(const SweepFolder& folder, const SlurmOptions& options,
                 const ResourceOptions& resources, bool retries, bool is_quiet) {
  return Submission(folder, options, resources, retries, is_quiet).run();
}

}  // namespace pliant::cli
