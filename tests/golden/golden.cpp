// Verifies every golden replay with this build: with the kernels of every width that the machine
// has, and with several numbers of threads, each at least once; with --lanes with every width and
// one thread, with --turns each replay with one width, in turn, with --threads only with three
// threads and the first frames of each, for a sanitizer of threads, with --once in one way only.
// --bless records all of them again, and prints new ones and differences.
// docs/replay.md, "Golden replays".
//
// usage: golden SOURCE_FOLDER [--once | --lanes | --turns | --threads | --bless]

#include <algorithm>
#include <array>
#include <atomic>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <locale>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/replay/log_file.hpp"
#include "pliant/replay/replay.hpp"
#include "pliant/scene/read.hpp"

namespace {

namespace fs = std::filesystem;
using namespace pliant;

// Few enough frames for a build without optimisation.
constexpr int most_frames = 24;
constexpr int most_frames_of_large_surfaces = 12;
constexpr int most_watched_frames = 8;
constexpr long most_nodes = 41L * 41;

struct Golden {
  std::string name;  // of the scene in the source folder, without its extension
  fs::path scene;
  fs::path log;
};

// The settings of a run. They must not change a bit.
struct Run {
  int lanes = widest_lanes;
  int threads = 1;
  int frames = std::numeric_limits<int>::max();  // ends after this many

  std::string name() const {
    if (lanes == widest_lanes) return fmt::format("{} threads", threads);
    return fmt::format("{} doubles a vector, {} threads", lanes, threads);
  }
};

// By the program's option.
std::vector<Run> runs_to_do(std::string_view option) {
  if (option == "--once") return {Run{}};
  if (option == "--threads") return {Run{.threads = 3, .frames = most_watched_frames}};
  std::vector<Run> runs;
  for (int k = 0; const PlateKernels* kernels = runnable_kernels(k); ++k) {
    runs.push_back({.lanes = kernels->lanes});
  }
  if (!option.empty()) return runs;
  // Numbers of threads beside widths: a run shows both.
  constexpr std::array threads = {1, 2, 3, 8};
  for (std::size_t k = 0; k < threads.size(); ++k) {
    if (k == runs.size()) runs.push_back(runs[0]);
    runs[k].threads = threads[k];
  }
  return runs;
}

// The golden replays of all examples, and of the reference tests, which cover features that the
// The golden replays of all examples and starters, and of the reference tests, which cover features
// that those do not use; in the order of their names.
std::vector<Golden> find_goldens(const fs::path& source) {
  std::vector<Golden> goldens;
  for (const char* folder : {"examples", "cli/new/starters", "tests/reference/scenes"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source / folder)) {
      if (entry.path().extension() != ".xml") continue;
      if (entry.path().parent_path().filename() == "parts") continue;  // what scenes include
      const fs::path name = entry.path().lexically_relative(source).replace_extension();
      goldens.push_back({name.generic_string(), entry.path(),
                         (source / "tests/golden" / name).replace_extension(".replay")});
    }
  }
  std::sort(goldens.begin(), goldens.end(),
            [](const Golden& a, const Golden& b) { return a.name < b.name; });
  return goldens;
}

// Logs whose scenes no longer exist.
std::vector<fs::path> find_orphans(const fs::path& source, const std::vector<Golden>& goldens) {
  std::vector<fs::path> orphans;
  for (const auto& entry : fs::recursive_directory_iterator(source / "tests/golden")) {
    const auto is_this = [&](const Golden& golden) { return golden.log == entry.path(); };
    if (entry.path().extension() == ".replay" &&
        std::none_of(goldens.begin(), goldens.end(), is_this)) {
      orphans.push_back(entry.path());
    }
  }
  return orphans;
}

void say(const std::string& line) { std::fputs((line + '\n').c_str(), stdout); }

// Whether a golden replay passed, and the lines to print about it.
struct Outcome {
  bool is_well = true;
  std::vector<std::string> lines = {};
};

Outcome outcome_of(const std::string& run, const Result<ReplayVerdict>& verdict) {
  Outcome outcome{.is_well = verdict && verdict->holds()};
  if (outcome.is_well) return outcome;
  for (const std::string& line : verdict ? verdict->lines() : to_lines(verdict.error())) {
    outcome.lines.push_back(fmt::format("{}: {}", run, line));
  }
  return outcome;
}

// Whether this build can play a scene: not every one has OpenSubdiv.
bool can_play(const Golden& golden) {
  const auto scene = load_scene(golden.scene);
  return has_opensubdiv() || !scene ||
         std::none_of(scene->surfaces.begin(), scene->surfaces.end(),
                      [](const Surface& surface) { return surface.subdivision.has_value(); });
}

Outcome verify(const Golden& golden, const std::vector<Run>& runs) {
  if (!can_play(golden)) return {.lines = {"skipped: this build has no OpenSubdiv"}};
  for (const Run& run : runs) {
    std::atomic<int> done = 0;
    ReplayOptions options{.simulation = {.threads = run.threads, .most_lanes = run.lanes}};
    options.simulation.should_stop = [&] { return done >= run.frames; };
    options.frame_done = [&](long) { ++done; };
    const auto verdict = verify_replay(golden.log, golden.scene, options);
    if (!verdict && verdict.error().code == ErrorCode::Interrupted) continue;  // these agree
    Outcome outcome = outcome_of(run.name(), verdict);
    if (!outcome.is_well) return outcome;
  }
  return {};
}

// The last frame to record of a scene.
Result<int> last_frame(const Golden& golden) {
  auto scene = load_scene(golden.scene);
  if (!scene) return fail(scene.error());
  const auto simulation = Simulation::make(*std::move(scene));
  if (!simulation) return fail(simulation.error());
  long nodes = 0;
  for (const RestShape& shape : simulation->rest_shapes()) nodes += shape.rest.rows();
  const int frames = nodes > most_nodes ? most_frames_of_large_surfaces : most_frames;
  return std::min(simulation->scene().end, simulation->scene().start + frames - 1);
}

// Describes the differences from a golden replay.
std::vector<std::string> description(const ReplayVerdict& verdict) {
  std::vector<std::string> lines = verdict.causes;
  lines.insert(lines.end(), verdict.mismatches.begin(), verdict.mismatches.end());
  if (verdict.differences.empty()) return lines;
  std::set<int> frames;
  double largest = 0;
  for (const ReplayDifference& difference : verdict.differences) {
    frames.insert(difference.frame);
    if (difference.peaks) {
      largest = std::max(largest, std::abs((*difference.peaks)[1] - (*difference.peaks)[0]));
    }
  }
  lines.push_back(verdict.differences.front().message());
  lines.push_back(fmt::format("{} of {} frames differ, peak displacements by {:.3g} at most",
                              frames.size(), verdict.frame_count, largest));
  return lines;
}

Outcome bless(const Golden& golden) {
  const auto last = last_frame(golden);
  if (!last) return outcome_of("scene", fail(last.error()));
  const bool is_new = !fs::exists(golden.log);
  const fs::path before = fs::path(golden.log).replace_extension(".before");
  fs::create_directories(golden.log.parent_path());
  if (!is_new) fs::rename(golden.log, before);
  const auto recorded = record_replay(golden.scene, golden.log, {.last_frame = *last});
  if (!recorded) {
    if (!is_new) fs::rename(before, golden.log);
    return outcome_of("record", fail(recorded.error()));
  }
  if (is_new) return {.lines = {fmt::format("new, {} frames", recorded->frame_count())}};
  const auto verdict = compare_replays(before, golden.log, {.keeps_going = true});
  fs::remove(before);
  if (!verdict) return {.lines = outcome_of("before", verdict).lines};
  return {.lines = description(*verdict)};
}

// Uses the user's locale, as an embedding program may.
void take_locale() {
  if (!std::setlocale(LC_ALL, "")) return;  // not installed
  std::locale::global(std::locale(""));
}

}  // namespace

int main(int count, char* arguments[]) {
  take_locale();
  const std::string_view option = count == 3 ? arguments[2] : "";
  const bool blesses = option == "--bless";
  constexpr std::array options = {"--once", "--lanes", "--turns", "--threads", "--bless"};
  if (count != 2 && std::find(options.begin(), options.end(), option) == options.end()) {
    std::fputs("usage: golden SOURCE_FOLDER [--once | --lanes | --turns | --threads | --bless]\n",
               stderr);
    return 2;
  }
  const fs::path source = arguments[1];
  const std::vector<Golden> goldens = find_goldens(source);
  const std::vector<Run> runs = runs_to_do(option);
  std::vector<Outcome> outcomes(goldens.size());
  ThreadPool threads(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  threads.for_each(goldens.size(), [&](std::size_t k) {
    const bool is_in_turn = option == "--turns";
    const std::vector<Run> its = is_in_turn ? std::vector{runs[k % runs.size()]} : runs;
    outcomes[k] = blesses ? bless(goldens[k]) : verify(goldens[k], its);
  });

  int failed = 0;
  for (std::size_t k = 0; k < goldens.size(); ++k) {
    for (const std::string& line : outcomes[k].lines) {
      say(fmt::format("{}: {}", goldens[k].name, line));
    }
    if (!outcomes[k].is_well) ++failed;
  }
  const int passed = static_cast<int>(goldens.size()) - failed;
  for (const fs::path& orphan : find_orphans(source, goldens)) {
    say(fmt::format("{}: no scene of that name{}", orphan.string(), blesses ? ", removed" : ""));
    if (blesses) {
      fs::remove(orphan);
    } else {
      ++failed;
    }
  }
  if (failed > 0 && !blesses) {
    say("script/test --bless records the logs that differ again, and prints by how much");
  }
  say(fmt::format("{} passed, {} failed", passed, failed));
  return failed == 0 && passed > 0 ? 0 : 1;
}
