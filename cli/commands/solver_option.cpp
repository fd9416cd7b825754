#include "cli/commands/solver_option.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/terminal/usage.hpp"

namespace pliant::cli {

void add_solver(CLI::App& command, std::string& solver) {
  command
      .add_option(
          "--solver", solver,
          "Solver of the plates: in sine space, by a sparse factor of ours or CHOLMOD's, or "
          "the one that suits each region")
      ->check(one_of({"auto", "spectral", "supernodal", "cholmod"}))
      ->capture_default_str();
}

Result<SolverChoice> parse_solver(const std::string& name) {
  const auto choice = solver_choice(name);
  if (choice && is_available(*choice)) return *choice;
  return fail(ErrorCode::InvalidInput,
              fmt::format("--solver {}: this build does not have it (PLIANT_WITH_CHOLMOD is off); "
                          "use auto, spectral or supernodal",
                          name));
}

}  // namespace pliant::cli
