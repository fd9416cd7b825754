#include "cli/sweep/slurm.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "cli/terminal/child.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

using namespace std::chrono_literals;

// Variables by which a user narrows what squeue lists and what scancel cancels.
constexpr std::string_view list_settings[] = {"SQUEUE_"}, cancel_settings[] = {"SCANCEL_"};

// Variables that sbatch does not get: one that would have it wait for the array; and, of a job in
// which we run, what it may use, which Slurm does not replace in the new job if that one has its
// memory by another option.
constexpr std::string_view submit_settings[] = {"SBATCH_WAIT=", "SLURM_MEM_PER_"};

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

std::string told(std::string_view line) {
  constexpr std::size_t longest = 1000;
  return printable(shortened(line, longest));
}

// Passes on what a program says, the first lines of it.
class Messages {
 public:
  void operator()(std::string_view line) {
    constexpr int most = 200;
    if (++count_ <= most) print(stderr, told(line) + '\n');
    if (count_ == most + 1) print(stderr, "…\n");
  }

 private:
  int count_ = 0;
};

// The last line is the reason; lines before it tell of attempts.
tl::unexpected<Error> no_answer(std::string_view program, const ProgramEnd& end) {
  std::string_view text = trim(end.errors, ascii_blanks);
  text = text.substr(text.find_last_of('\n') + 1);
  return fail(ErrorCode::Unwritable, text.empty()
                                         ? fmt::format("{} ended with code {}", program, end.code)
                                         : fmt::format("{}: {}", program, told(text)));
}

bool names_no_job(const ProgramEnd& end) {
  return end.errors.find("Invalid job id") != std::string::npos;
}

std::vector<std::string> squeue_of(const SlurmJob& job) {
  std::vector<std::string> words = {"squeue", "--noheader", "--all", "--jobs=" + job.number};
  if (!job.cluster.empty()) words.push_back("--clusters=" + job.cluster);
  return words;
}

// A line of squeue: the number of a job, its state and its script. Without `--states` all jobs are
// listed that have not ended; with it, those are not whose node is being made ready (CONFIGURING).
constexpr const char* listed_format = "--format=%F|%T|%o";

struct Listed {
  std::string_view number, state, file;

  // Its processes end: of a job that is cancelled, or of one that is queued again afterwards.
  bool is_ending() const { return state == "COMPLETING"; }
};

std::optional<Listed> parse_listed(std::string_view line) {
  const std::size_t first = line.find('|'), second = line.find('|', first + 1);
  if (second == std::string_view::npos || !number_in<std::uint64_t>(line.substr(0, first)))
    return {};
  return Listed{line.substr(0, first), line.substr(first + 1, second - first - 1),
                line.substr(second + 1)};
}

bool is_another_here(std::string_view file, const std::string& script) {
  std::error_code ignored;
  return file != script && std::filesystem::exists(file, ignored) &&
         !std::filesystem::equivalent(file, script, ignored);
}

bool is_script_of_a_sweep(std::string_view file) { return file.ends_with("/slurm/job.sh"); }

// Finds jobs by their script.
class Search {
 public:
  explicit Search(const std::string& script) : script_(script) {}

  void add(std::string_view line) {
    const auto listed = parse_listed(line);
    if (!listed || !is_script_of_a_sweep(listed->file) || !is_ours(listed->file)) return;
    if (listed->is_ending()) {
      has_ending_ = true;
      return;
    }
    const auto number = number_in<std::uint64_t>(listed->number);
    least_ = std::min(least_.value_or(*number), *number);
  }

  std::string least() const { return least_ ? std::to_string(*least_) : ""; }
  bool has_ending() const { return has_ending_; }

 private:
  bool is_ours(std::string_view file) {
    if (file == script_) return true;
    const auto [known, is_new] = known_.try_emplace(std::string(file), false);
    std::error_code ignored;
    if (is_new) known->second = std::filesystem::equivalent(file, script_, ignored);
    return known->second;
  }

  const std::string& script_;
  std::map<std::string, bool> known_;
  std::optional<std::uint64_t> least_;
  bool has_ending_ = false;
};

enum class Activity { None, Ending, Active };

// Of a job whose script is that of a sweep: its number may be used again. A script that is here and
// another than `script` is that of another sweep: of the one that this folder is a copy of.
Result<Activity> activity_of(const SlurmJob& job, const std::string& script) {
  std::vector<std::string> words = squeue_of(job);
  words.emplace_back(listed_format);
  Activity found = Activity::None;
  const auto end = run_program(
      words, {.dropped = list_settings,
              .take_line =
                  [&](std::string_view line) {
                    const auto listed = parse_listed(line);
                    if (!listed || !is_script_of_a_sweep(listed->file) ||
                        is_another_here(listed->file, script))
                      return;
                    found =
                        std::max(found, listed->is_ending() ? Activity::Ending : Activity::Active);
                  },
              .should_stop = &was_interrupted});
  if (!end) return fail(end.error());
  if (end->code != 0 && !names_no_job(*end)) return no_answer("squeue", *end);
  return found;
}

enum class Presence { There, Gone, Unknown };

Result<Presence> look_for(const SlurmJob& job, bool& has_run) {
  bool is_there = false;
  const auto note = [&](std::string_view line) {
    // With clusters, a line names the cluster.
    const std::string_view state = trim(line, ascii_blanks);
    is_there |= !state.empty() && state.find(':') == std::string_view::npos;
    has_run |= state == "RUNNING";
  };
  std::vector<std::string> words = squeue_of(job);
  words.emplace_back("--format=%T");
  const auto end = run_program(
      words, {.dropped = list_settings, .take_line = note, .should_stop = &was_interrupted});
  if (!end && (end.error().code == ErrorCode::Interrupted || !is_on_path("squeue")))
    return fail(end.error());
  if (!end) return Presence::Unknown;
  if (end->code != 0) return names_no_job(*end) ? Presence::Gone : Presence::Unknown;
  return is_there ? Presence::There : Presence::Gone;
}

// False: interrupted.
bool sleep_for(std::chrono::milliseconds time, const std::function<void()>& meanwhile = {}) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    if (was_interrupted()) return false;
    if (meanwhile) meanwhile();
    std::this_thread::sleep_for(50ms);
  }
  return !was_interrupted();
}

}  // namespace

std::optional<SlurmJob> parse_slurm_job(std::string_view text) {
  constexpr std::size_t longest = 200;
  text = trim(text, ascii_blanks);
  const std::size_t end = std::min(text.find(';'), text.size());
  if (!number_in<std::uint64_t>(text.substr(0, end)) || text.size() > longest) return {};
  const std::string_view cluster = text.substr(std::min(end + 1, text.size()));
  if (printable(cluster) != cluster || cluster.find(' ') != std::string_view::npos) return {};
  return SlurmJob{std::string(text.substr(0, end)), std::string(cluster)};
}

Result<std::size_t> max_array_size(std::chrono::seconds patience) {
  std::optional<std::size_t> size;
  const auto take = [&](std::string_view line) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos ||
        trim(line.substr(0, equals), ascii_blanks) != "MaxArraySize")
      return;
    size = number_in<std::size_t>(trim(line.substr(equals + 1), ascii_blanks));
  };
  const auto end =
      run_program({"scontrol", "show", "config"},
                  {.take_line = take, .patience = patience, .should_stop = &was_interrupted});
  if (!end) return fail(end.error());
  if (end->code != 0) return no_answer("scontrol", *end);
  if (!size) return fail(ErrorCode::Unwritable, "scontrol show config does not name MaxArraySize");
  return *size;
}

Result<std::string> active_job(const std::string& script, const std::optional<SlurmJob>& known) {
  constexpr auto patience = 5s;  // a node that hangs may be ending a job for hours
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    Search search(script);
    const auto end = run_program({"squeue", "--noheader", "--all", listed_format},
                                 {.dropped = list_settings,
                                  .take_line = [&](std::string_view line) { search.add(line); },
                                  .should_stop = &was_interrupted});
    if (!end) return fail(end.error());
    if (end->code != 0) return no_answer("squeue", *end);
    if (!search.least().empty()) return search.least();
    bool has_ending = search.has_ending();
    if (known) {
      const auto activity = activity_of(*known, script);
      if (!activity) return fail(activity.error());
      if (*activity == Activity::Active) return known->number;
      has_ending |= *activity == Activity::Ending;
    }
    if (!has_ending || std::chrono::steady_clock::now() - begin > patience) return std::string();
    if (!sleep_for(500ms)) return interrupted();
  }
}

Result<SlurmJob> submit(const std::vector<std::string>& words) {
  Messages messages;
  std::optional<SlurmJob> job;
  std::string first;
  const auto take = [&](std::string_view line) {
    if (first.empty()) first = line;
    if (!job) job = parse_slurm_job(line);
  };
  // After an interrupt it has a moment to say whether the job is submitted.
  constexpr auto patience = 3s;
  std::optional<std::chrono::steady_clock::time_point> interrupted;
  const auto should_stop = [&] {
    if (!was_interrupted()) return false;
    const auto now = std::chrono::steady_clock::now();
    if (!interrupted) interrupted = now;
    return now - *interrupted > patience;
  };
  const auto end = run_program(words, {.dropped = submit_settings,
                                       .take_line = take,
                                       .take_message = std::ref(messages),
                                       .patience = 120s,
                                       .should_stop = should_stop});
  if (job) return *job;
  if (!end && is_on_path(words.front())) {
    const bool is_interrupted = end.error().code == ErrorCode::Interrupted;
    return fail(
        ErrorCode::Unwritable,
        fmt::format(
            "{}; squeue tells whether there is a job, and while there is one, none is "
            "submitted beside it",
            is_interrupted ? "interrupted while sbatch gave no answer" : end.error().message));
  }
  if (!end) return fail(end.error());
  if (end->code != 0)
    return fail(ErrorCode::Unwritable,
                fmt::format("sbatch ended with code {}; nothing is submitted", end->code));
  // It was told to be --quiet, or is a program of the site that prints what it likes.
  if (const auto found = active_job(words.back(), {}); found && !found->empty())
    return SlurmJob{*found};
  return fail(ErrorCode::Unwritable,
              first.empty() ? "sbatch printed no number of a job"
                            : fmt::format("sbatch printed \"{}\" in place of the number of a job",
                                          told(first)));
}

void cancel(const SlurmJob& job) {
  std::vector<std::string> words = {"scancel"};
  if (!job.cluster.empty()) words.push_back("--clusters=" + job.cluster);
  words.push_back(job.number);
  Messages messages;
  // What remains is run twice, to the same bits.
  (void)run_program(words, {.dropped = cancel_settings, .take_message = std::ref(messages)});
}

Result<void> wait_for(const SlurmJob& job, const std::function<void(bool)>& meanwhile) {
  constexpr auto longest_pause = 15'000ms;
  constexpr int certain = 2;  // while a job is requeued it may be unseen for a moment
  auto pause = 1'000ms;
  bool has_run = false;
  for (int times_gone = 0;;) {
    const auto presence = look_for(job, has_run);
    if (!presence) return fail(presence.error());
    times_gone = *presence == Presence::Gone ? times_gone + 1 : 0;
    if (times_gone == certain) return {};
    if (!sleep_for(times_gone > 0 ? 1'000ms : pause, [&] { meanwhile(has_run); }))
      return interrupted();
    pause = std::min(pause * 3 / 2, longest_pause);
  }
}

}  // namespace pliant::cli
