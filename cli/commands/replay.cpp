#include "cli/commands/replay.hpp"

#include <filesystem>
#include <limits>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/core/text.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

// Runs `work` with its options and shows a progress bar.
template <class Work>
auto with_progress(const ReplayCommandOptions& options, const Work& work) {
  std::optional<Progress> progress;
  ReplayOptions replay;
  replay.root = options.root.value_or("");
  replay.changes = options.changes;
  replay.simulation = simulation_options(options.resources);
  replay.simulation.round_done = round_line(options.is_quiet);
  replay.last_frame = options.last_frame;
  replay.states_every = options.states_every;
  replay.keeps_going = options.keeps_going;
  replay.frame_done = [&](long frame_count) {
    if (!progress) progress.emplace(static_cast<int>(frame_count), options.is_quiet);
    progress->advance();
  };
  return work(replay);
}

int record(const ReplayCommandOptions& options) {
  catch_interrupts();
  if (auto file = check_scene_is_file(options.scene, "a log names the file of its scene"); !file) {
    return report(file.error());
  }
  if (auto place = check_output_file("-o", options.log); !place) return report(place.error());
  const auto recorded = with_progress(options, [&](const ReplayOptions& replay) {
    return record_replay(options.scene, options.log, replay);
  });
  if (!recorded) return report(with_kept(recorded.error(), "no log was written"));
  if (!options.is_quiet) {
    print(stdout, fmt::format("{}: {}, {} recorded\n", printable(options.log),
                              counted(recorded->frame_count(), "frame"),
                              counted(recorded->surfaces.size(), "surface")));
  }
  return exit_done;
}

// Differences go to stdout as data, possible causes to stderr as notes.
int tell(const ReplayCommandOptions& options, const Result<ReplayVerdict>& verdict,
         std::string_view done) {
  if (!verdict) {
    return report(with_kept(verdict.error(), options.keeps_going
                                                 ? "the differences found before are not printed"
                                                 : "all frames compared before agree"));
  }
  const std::string log = printable(options.log);
  for (const std::string& cause : verdict->causes) {
    print(stderr, fmt::format("{}: note: {}\n", log, printable(cause)));
  }
  for (const std::string& mismatch : verdict->mismatches) {
    print(stdout, fmt::format("{}: {}\n", log, printable(mismatch)));
  }
  for (const ReplayDifference& difference : verdict->differences) {
    print(stdout, fmt::format("{}: {}\n", log, difference.message()));
  }
  if (!verdict->holds()) return exit_failed;
  if (!options.is_quiet) {
    print(stdout,
          fmt::format("{}: {}, all {}\n", log, counted(verdict->frame_count, "frame"), done));
  }
  return exit_done;
}

int verify(const ReplayCommandOptions& options) {
  catch_interrupts();
  if (auto file = check_scene_is_file(options.scene, "verify compares a log with a scene file");
      !file) {
    return report(file.error());
  }
  std::optional<std::filesystem::path> scene;
  if (!options.scene.empty()) scene = options.scene;
  const auto verdict = with_progress(options, [&](const ReplayOptions& replay) {
    return verify_replay(options.log, scene, replay);
  });
  return tell(options, verdict, "as recorded");
}

int diff(const ReplayCommandOptions& options) {
  catch_interrupts();
  const auto verdict = with_progress(options, [&](const ReplayOptions& replay) {
    return compare_replays(options.log, options.other_log, replay);
  });
  return tell(options, verdict, "equal");
}

void add_record(CLI::App& replay, ReplayCommandOptions& options) {
  CLI::App* record =
      replay.add_subcommand("record", "Simulate a scene and write its log: hashes of every frame");
  record->add_option("SCENE", options.scene, "Scene file")->required();
  add_changes(*record, options.changes);
  record->add_option("-o,--out", options.log, "The log, RUN.replay")->required();
  record
      ->add_option("--states", options.states_every,
                   "Also record the whole state every so many frames, so that verify and diff can "
                   "name the node and size of a difference there")
      ->check(integer_from(1));
  record
      ->add_option("--last", options.last_frame, "The last frame to record; the scene's by default")
      ->check(integer_from(std::numeric_limits<int>::min()));
}

void add_verify(CLI::App& replay, ReplayCommandOptions& options) {
  CLI::App* verify = replay.add_subcommand(
      "verify", "Simulate a log's scene again and name the first frame and surface that differ");
  verify->add_option("LOG", options.log, "The log, RUN.replay")->required();
  verify->add_option("SCENE", options.scene,
                     "Scene file; by default the recorded one, or its text in the log if that file "
                     "does not exist");
}

void add_diff(CLI::App& replay, ReplayCommandOptions& options) {
  CLI::App* diff = replay.add_subcommand("diff", "Compare two logs");
  diff->add_option("A", options.log, "A log")->required();
  diff->add_option("B", options.other_log, "Another log")->required();
}

}  // namespace

void add_replay(CLI::App& app, ReplayCommandOptions& options) {
  CLI::App* replay = app.add_subcommand(
      "replay", "Record a run of a scene as a log of hashes, and compare later runs with it");
  replay->require_subcommand(1);
  add_record(*replay, options);
  add_verify(*replay, options);
  add_diff(*replay, options);
  for (const char* compares : {"verify", "diff"}) {
    replay->get_subcommand(compares)->add_flag("--keep-going", options.keeps_going,
                                               "Name all differences, not only the first");
  }
  for (const char* simulates : {"record", "verify"}) {
    add_root(*replay->get_subcommand(simulates), options.root);
    add_threads(*replay->get_subcommand(simulates), options.resources);
    add_memory(*replay->get_subcommand(simulates), options.resources);
  }
  for (const char* any : {"record", "verify", "diff"}) {
    replay->get_subcommand(any)->add_flag("--quiet", options.is_quiet,
                                          "No progress and no success summary");
  }
}

int run_replay(const CLI::App& app, const ReplayCommandOptions& options) {
  if (const auto folder = folder_of(options.root); !folder) return report(folder.error());
  const CLI::App* const replay = app.get_subcommand("replay");
  if (replay->got_subcommand("record")) return record(options);
  if (replay->got_subcommand("verify")) return verify(options);
  return diff(options);
}

}  // namespace pliant::cli
