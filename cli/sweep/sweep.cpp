#include "cli/sweep/sweep.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/report.hpp"

namespace pliant::cli {

void add_sweep(CLI::App& app, SweepOptions& options) {
  CLI::App* sweep =
      app.add_subcommand("sweep", "Run a scene many times, each take with other values");
  sweep->require_subcommand(1);
  add_sweep_run(*sweep, options.run);
  CLI::App* status = sweep->add_subcommand(
      "status", "Write the table takes.csv anew, and count the takes that are done");
  status->add_option("DIR", options.status.folder, "Folder of a sweep")->required();
  add_root(*status, options.status.root);
  add_sweep_verify(*sweep, options.verify);
  add_sweep_bake(*sweep, options.bake);
  add_sweep_view(*sweep, options.view);
}

int run_sweep(const CLI::App& app, const SweepOptions& options) {
  const CLI::App& sweep = *app.get_subcommand("sweep");
  if (sweep.got_subcommand("run")) return run_sweep_run(*sweep.get_subcommand("run"), options.run);
  if (sweep.got_subcommand("status")) return run_sweep_status(options.status);
  if (sweep.got_subcommand("verify")) return run_sweep_verify(options.verify);
  if (sweep.got_subcommand("view")) return run_sweep_view(options.view);
  return run_sweep_bake(options.bake);
}

Result<SweepFolder> open_sweep(const std::string& folder, const Root& root) {
  const auto confined = folder_of(root);
  if (!confined) return fail(confined.error());
  return SweepFolder::open(folder, &was_interrupted, confined->string());
}

void print_conflicts(const SweepStatus& status, const SweepPart& part) {
  for (const HashConflict& conflict : status.conflicts) {
    if (!part.has(conflict.take)) continue;
    print(stderr, fmt::format("take {}: hash differs between {} and {}\n", conflict.take,
                              printable(conflict.host), printable(conflict.other_host)));
  }
}

void print_failures(const SweepFolder& folder, const SweepStatus& status, const SweepPart& part) {
  constexpr std::size_t most_named = 10;
  print_conflicts(status, part);
  std::size_t count = 0;
  for (std::size_t take = 0; take < status.takes.size(); ++take) {
    const TakeRecord& record = status.takes[take];
    if (record.status != TakeStatus::Failed || !part.has(take) || ++count > most_named) continue;
    print(stderr, fmt::format("{}: {}\n", title_of(folder.sweep(), folder.request().scenes, take),
                              printable(record.full_error)));
  }
  if (count > most_named)
    print(stderr, fmt::format("{} failed too\n", counted(count - most_named, "other take")));
}

int run_sweep_status(const SweepStatusOptions& options) {
  catch_interrupts();
  const auto folder = open_sweep(options.folder, options.root);
  if (!folder) return report(folder.error());
  return tell_status(*folder);
}

int tell_status(const SweepFolder& folder, bool is_quiet, const SweepPart& part,
                const std::optional<std::string>& part_text) {
  const auto status = folder.status(&was_interrupted);
  if (!status) return report(status.error());
  Result<void> written;
  if (!part_text) written = folder.write_table(*status, &was_interrupted);
  std::size_t count = 0, done = 0, failed = 0;
  for (std::size_t take = 0; take < status->takes.size(); ++take) {
    if (!part.has(take)) continue;
    ++count;
    done += status->takes[take].status == TakeStatus::Done ? 1 : 0;
    failed += status->takes[take].status == TakeStatus::Failed ? 1 : 0;
  }
  if (!is_quiet)
    print(stdout,
          fmt::format("{}: {}{}, {} done, {} failed, {} missing\n", printable(folder.folder()),
                      part_text ? "part " + *part_text + ": " : "", counted(count, "take"), done,
                      failed, count - done - failed));
  print_failures(folder, *status, part);
  if (!written) return report(written.error());
  const bool has_conflict = std::ranges::any_of(
      status->conflicts, [&](const HashConflict& conflict) { return part.has(conflict.take); });
  return done == count && !has_conflict ? exit_done : exit_failed;
}

}  // namespace pliant::cli
