#include "cli/terminal/resources.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/memory_limit.hpp"
#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

std::size_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page = sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(page)
                               : std::numeric_limits<std::size_t>::max();
}

std::size_t memory_by_default(std::size_t own) {
  const auto of_job = memory_of_slurm_job([](const char* name) { return std::getenv(name); });
  const auto of_groups = memory_of_groups();
  const auto limit =
      of_job && of_groups ? std::min(*of_job, *of_groups) : (of_job ? of_job : of_groups);
  return default_memory(machine_memory(), limit, own);
}

}  // namespace

CLI::Validator number_from(double least) {
  constexpr double most = 1e9;
  const std::string range = fmt::format("from {} to {:.0f}", least, most);
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto number = to_number(text);
        if (number && *number >= least && *number <= most) return "";
        return fmt::format("{}: must be a number {}", text, range);
      },
      range);
}

CLI::Validator integer_from(int least, int most) {
  const std::string range = fmt::format("from {} to {}", least, most);
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const auto number = to_integer(text);
        return number && *number >= least && *number <= most
                   ? ""
                   : fmt::format("{}: must be an integer {}", text, range);
      },
      range);
}

CLI::Validator file_name() {
  return CLI::Validator(
      [](std::string& text) {
        return text.empty() ? std::string("the name of the file is empty") : std::string();
      },
      "");
}

void add_threads(CLI::App& command, ResourceOptions& options) {
  command
      .add_option("--threads", options.threads,
                  "Number of threads; as many as the machine has by default")
      ->check(integer_from(1, 1024));
}

void add_memory(CLI::App& command, ResourceOptions& options) {
  constexpr double least = 1e-6;  // a kilobyte
  command
      .add_option("--max-memory", options.max_memory,
                  "Most memory to use, in GB; a run that needs more is refused; three quarters of "
                  "the machine's by default, or what a container's limit leaves")
      ->check(number_from(least));
}

SimulationOptions simulation_options(const ResourceOptions& options, std::size_t own) {
  const auto machine_threads = static_cast<int>(std::thread::hardware_concurrency());
  return {.checkpoint_bytes = 0,
          .max_memory = options.max_memory > 0 ? static_cast<std::size_t>(options.max_memory * 1e9)
                                               : memory_by_default(own),
          .threads = options.threads > 0 ? options.threads : std::max(1, machine_threads),
          .should_stop = &was_interrupted};
}

std::size_t part_for_shelf(SimulationOptions& options) {
  const std::size_t part = options.max_memory / 8;
  options.max_memory -= part;
  return part;
}

}  // namespace pliant::cli
