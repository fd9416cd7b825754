#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands/frame_range.hpp"
#include "cli/commands/solver_option.hpp"
#include "cli/sweep/sweep.hpp"
#include "cli/sweep/sweep_memory.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/files/writer.hpp"

namespace pliant::cli {
namespace {

// The most bytes of a table of takes.
constexpr std::size_t largest_table = std::size_t{1} << 30U;

// The options that belong to making a sweep.
constexpr std::string_view making_options[] = {"--out",     "--set",      "--vary",   "--sample",
                                               "--takes",   "--frames",   "--solver", "--write",
                                               "--dry-run", "--make-only"};

// The options that belong to running its takes.
constexpr std::string_view running_options[] = {"--part", "--retry", "--engine"};

// K/P
Result<SweepPart> parse_part(const std::optional<std::string>& text) {
  if (!text) return SweepPart{};
  const std::size_t slash = text->find('/');
  const auto part = to_integer(text->substr(0, slash));
  const auto count =
      slash == std::string::npos ? std::nullopt : to_integer(text->substr(slash + 1));
  if (part && count && *part >= 0 && *part < *count)
    return SweepPart{static_cast<std::size_t>(*part), static_cast<std::size_t>(*count)};
  return invalid(fmt::format("--part {}: must be K/P with integers 0 <= K < P", printable(*text)));
}

Result<SweepRequest> request_of(const SweepRunOptions& options) {
  SweepRequest request{.scenes = options.what, .root = options.root.value_or("")};
  for (const std::string& scene : options.what) {
    if (auto file = check_scene_is_file(scene, "a sweep names the file of its scene"); !file)
      return fail(file.error());
  }
  if (const auto folder = folder_of(options.root); !folder) return fail(folder.error());
  const auto solver = parse_solver(options.solver);
  if (!solver) return fail(solver.error());
  request.solver = *solver;
  if (options.frames) {
    const auto frames = parse_frame_range(*options.frames);
    if (!frames) return fail(frames.error());
    request.frames = FrameSpan{frames->first, frames->last};
  }
  if (options.write) {
    request.write = options.write->starts_with('.') ? *options.write : "." + *options.write;
    if (auto known = check_ending("takes" + request.write); !known)
      return invalid("--write " + printable(*options.write) + ": " + known.error().message);
    request.write = ending_of("takes" + request.write);
  }
  request.variation.scene_count = options.what.size();
  request.variation.set = options.set;
  request.variation.vary = options.vary;
  if (options.sample) {
    const auto count = to_integer(*options.sample);
    if (!count || *count < 1)
      return invalid(
          fmt::format("--sample {}: must be an integer >= 1", printable(*options.sample)));
    request.variation.samples = static_cast<std::size_t>(*count);
  }
  if (options.takes) {
    auto table = read_file(*options.takes, largest_table, &was_interrupted);
    if (!table) return fail(table.error());
    request.variation.table = *std::move(table);
    request.variation.table_name = *options.takes;
  }
  return request;
}

// Tells the columns of --takes that say nothing about a scene.
void note_columns(const Takes& takes, const SweepRunOptions& options) {
  constexpr std::size_t most_told = 12, longest_name = 60;
  const std::span<const std::string> names = takes.columns_left_out();
  if (names.empty()) return;
  std::vector<std::string> told;
  for (const std::string& name : names.first(std::min(names.size(), most_told)))
    told.push_back(shortened(printable(name), longest_name));
  print(stderr,
        fmt::format("{}: note: {} left out, whose heads are not of the form NAME.ATTRIBUTE: {}{}\n",
                    printable(*options.takes), counted(names.size(), "column"),
                    fmt::join(told, ", "), names.size() > most_told ? ", …" : ""));
}

int print_plan(const SweepRequest& request, const SweepRunOptions& options) {
  const auto sweep = SweepFolder::plan(request, &was_interrupted);
  if (!sweep) return report(sweep.error());
  note_columns(sweep->takes(), options);
  const auto written =
      write_table(*sweep, request.scenes, {}, [](std::string_view text) -> Result<void> {
        print_bytes(stdout, text);
        if (was_interrupted()) return interrupted();
        return {};
      });
  return written ? exit_done : report(written.error());
}

void tell_memory(std::size_t count, const SimulationOptions& resources) {
  const TakesAtOnce at_once = takes_at_once(count, resources.threads, resources.max_memory);
  print(stderr, fmt::format("{} at once, up to {} each\n", counted(at_once.count, "take"),
                            bytes_text(at_once.memory)));
}

int run_takes(const SweepFolder& folder, const SweepRunOptions& options, const SweepPart& part) {
  const SimulationOptions resources =
      simulation_options(options.resources, memory_of_records(folder.sweep()));
  std::optional<Progress> progress;
  std::size_t failures = 0;
  const auto ran =
      folder.run({.threads = resources.threads,
                  .max_memory = resources.max_memory,
                  .should_stop = resources.should_stop,
                  .part = part,
                  .retry = options.retries,
                  .begin =
                      [&](std::size_t count) {
                        if (!options.is_quiet && count > 0) tell_memory(count, resources);
                        progress.emplace(static_cast<int>(count), options.is_quiet, "takes");
                      },
                  .take_done =
                      [&](const TakeOutcome& outcome) {
                        if (!outcome.measures)
                          progress->add_note(fmt::format(", {} failed", ++failures));
                        progress->advance();
                      }});
  progress.reset();
  const bool is_interrupted = !ran && ran.error().code == ErrorCode::Interrupted;
  if (is_interrupted) {
    return report(with_kept(ran.error(),
                            "takes that ended are kept, and the same command runs "
                            "those that are missing"));
  }
  if (!ran) return report(ran.error());
  return tell_status(folder, options.is_quiet, part, options.part);
}

bool is_folder(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::is_directory(name, ignored);
}

// The sweep of the folder given, or made of the scenes given.
Result<SweepFolder> sweep_of(const CLI::App& run, const SweepRunOptions& options) {
  if (!options.out) {
    if (options.what.size() != 1 || !is_folder(options.what.front()))
      return invalid("-o DIR is missing: the folder of the sweep");
    for (const std::string_view option : making_options) {
      if (run.count(std::string(option)) > 0)
        return invalid(
            fmt::format("{}: {} is a sweep already, whose arguments do not change; "
                        "make another one of a SCENE with -o DIR",
                        option, printable(options.what.front())));
    }
    return open_sweep(options.what.front(), options.root);
  }
  const auto request = request_of(options);
  if (!request) return fail(request.error());
  return SweepFolder::make(*options.out, *request, &was_interrupted);
}

// What is wrong with a submission, before a sweep is made for it.
Result<void> check_engine(const CLI::App& run, const SweepRunOptions& options) {
  const std::string& folder = options.out ? *options.out : options.what.front();
  if (auto ready = check_slurm(run, options.slurm, folder); !ready) return ready;
  if (!options.slurm.parts || !options.out) return {};
  const auto request = request_of(options);
  if (!request) return fail(request.error());
  const auto sweep = SweepFolder::plan(*request, &was_interrupted);
  if (!sweep) return fail(sweep.error());
  return check_slurm_parts(options.slurm, sweep->takes().count());
}

int submit_takes(const SweepFolder& folder, const SweepRunOptions& options) {
  if (!options.out) {  // otherwise `check_engine` has asked
    const auto fits = check_slurm_parts(options.slurm, folder.sweep().takes().count());
    if (!fits) return report(fits.error());
  }
  SlurmOptions slurm = options.slurm;
  if (!options.out && options.root) slurm.root = folder.request().root;
  return run_on_slurm(folder, slurm, options.resources, options.retries, options.is_quiet);
}

}  // namespace

void add_sweep_run(CLI::App& sweep, SweepRunOptions& options) {
  CLI::App* run = sweep.add_subcommand(
      "run", "Make a sweep in a folder and run its takes; or run those that are missing");
  run->add_option("SCENE|DIR", options.what, "Scene files, or the folder of a sweep")->required();
  run->add_option("-o,--out", options.out, "Folder of the sweep, new or the same as before");
  add_changes(*run, options.set);
  run->add_option(
         "--vary", options.vary,
         "An axis, as often as needed, of a PATH of --set (=, *=, +=): a,b,c; A:B:N, numbers; "
         "A:B:N:log; A..B, integers; A:B, to --sample")
      ->type_name("PATH=VALUES")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  run->add_option("--sample", options.sample,
                  "Number of points (Sobol') for all intervals A:B together");
  run->add_option("--takes", options.takes,
                  "Table of takes in place of --vary: a CSV with a header of PATHs, a row a take");
  run->add_option("--frames", options.frames,
                  "Frames to measure and write, A:B or one frame; all by default");
  add_solver(*run, options.solver);
  run->add_option("--write", options.write,
                  "Also write each take's animation, in the format of this ending, such as .npy");
  add_root(*run, options.root);
  run->add_option("--part", options.part,
                  "Run only takes t with t mod P = K, 0 <= K < P: one job of a batch engine")
      ->type_name("K/P");
  add_slurm(*run, options.slurm);
  run->add_flag("--make-only", options.makes_only, "Make the sweep, and run no take");
  run->add_flag("--dry-run", options.is_dry, "Print the takes as a table; make and run nothing");
  run->add_flag("--retry", options.retries, "Run takes that failed again");
  add_threads(*run, options.resources);
  add_memory(*run, options.resources);
  run->add_flag("--quiet", options.is_quiet, "No progress and no summary");
}

int run_sweep_run(const CLI::App& run, const SweepRunOptions& options) {
  catch_interrupts();
  const auto part = parse_part(options.part);
  if (!part) return report(part.error());
  for (const std::string_view option : running_options) {
    if ((options.makes_only || options.is_dry) && run.count(std::string(option)) > 0)
      return report(invalid(fmt::format("{}: no take is run with {}", option,
                                        options.is_dry ? "--dry-run" : "--make-only"))
                        .value());
  }
  if (options.is_dry && options.out) {
    const auto request = request_of(options);
    return request ? print_plan(*request, options) : report(request.error());
  }
  if (const auto ready = check_engine(run, options); !ready) return report(ready.error());
  const auto folder = sweep_of(run, options);
  if (!folder) return report(folder.error());
  note_columns(folder->sweep().takes(), options);
  if (options.slurm.engine) return submit_takes(*folder, options);
  if (!options.makes_only) return run_takes(*folder, options, *part);
  if (!options.is_quiet)
    print(stdout, fmt::format("{}: {}\n", printable(folder->folder()),
                              counted(folder->sweep().takes().count(), "take")));
  return exit_done;
}

}  // namespace pliant::cli
