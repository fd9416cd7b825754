#include <fmt/format.h>

#include "cli/sweep/sweep.hpp"
#include "cli/terminal/counted.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/report.hpp"

namespace pliant::cli {

int run_sweep_status(const SweepStatusOptions& options) {
  catch_interrupts();
  const auto folder = open_sweep(options.folder, options.root);
  if (!folder) return report(folder.error());
  return tell_status(*folder);
}

int tell_status(const SweepFolder& folder, bool is_quiet) {
  const auto status = folder.status(&was_interrupted);
  if (!status) return report(status.error());
  const auto written = folder.write_table(*status, &was_interrupted);
  if (!is_quiet)
    print(stdout, fmt::format("{}: {}, {} done, {} failed, {} missing\n",
                              printable(folder.folder()), counted(status->takes.size(), "take"),
                              status->done, status->failed, status->missing()));
  print_failures(folder, *status);
  if (!written) return report(written.error());
  return status->is_complete() ? exit_done : exit_failed;
}

}  // namespace pliant::cli
