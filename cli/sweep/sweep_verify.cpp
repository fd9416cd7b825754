#include <map>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/sweep/sweep.hpp"
#include "cli/sweep/sweep_memory.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"

namespace pliant::cli {

void add_sweep_verify(CLI::App& sweep, SweepVerifyOptions& options) {
  CLI::App* verify =
      sweep.add_subcommand("verify", "Run takes that are done again, and compare their hashes");
  verify->add_option("DIR", options.folder, "Folder of a sweep")->required();
  verify->add_option("--every", options.every, "Only every K-th take")
      ->check(integer_from(1, 1'000'000))
      ->type_name("K")
      ->capture_default_str();
  add_root(*verify, options.root);
  add_threads(*verify, options.resources);
  add_memory(*verify, options.resources);
  verify->add_flag("--quiet", options.is_quiet, "No progress and no summary");
}

int run_sweep_verify(const SweepVerifyOptions& options) {
  catch_interrupts();
  const auto folder = open_sweep(options.folder, options.root);
  if (!folder) return report(folder.error());
  const auto status = folder->status(&was_interrupted);
  if (!status) return report(status.error());
  std::vector<std::size_t> takes;
  const auto every = static_cast<std::size_t>(options.every);
  for (std::size_t take = 0; take < status->takes.size(); take += every) {
    if (status->takes[take].status == TakeStatus::Done) takes.push_back(take);
  }
  std::map<std::size_t, std::string> differences;  // of takes, in their order
  std::optional<Progress> progress(std::in_place, static_cast<int>(takes.size()), options.is_quiet,
                                   "takes");
  const SimulationOptions resources =
      simulation_options(options.resources, memory_of_records(folder->sweep()));
  const auto ran = folder->sweep().run(
      takes,
      {.threads = resources.threads,
       .max_memory = resources.max_memory,
       .should_stop = resources.should_stop,
       .check =
           [&](const Scene& scene) { return folder->check_inputs(scene, resources.should_stop); },
       .take_done = [&](const TakeOutcome& outcome) -> Result<void> {
         progress->advance();
         if (!outcome.measures) {
           differences[outcome.take] = to_lines(outcome.measures.error()).front();
         } else if (outcome.measures->hash != status->takes[outcome.take].measures.hash) {
           differences[outcome.take] = "hash differs";
         }
         return {};
       }});
  progress.reset();
  if (takes.empty()) {
    print(stderr,
          fmt::format("pliant: error: {}: no take to verify is done\n", printable(options.folder)));
    return exit_failed;
  }
  for (const auto& [take, difference] : differences)
    print(stdout, fmt::format("take {}: {}\n", take, printable(difference)));
  if (!ran) return report(ran.error());
  if (!differences.empty()) return exit_failed;
  if (!options.is_quiet)
    print(stdout, fmt::format("{}: {} verified\n", printable(options.folder),
                              counted(takes.size(), "take")));
  return exit_done;
}

}  // namespace pliant::cli
