#include "resources.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "interrupt.hpp"
#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

// The machine's memory, or the limit of the container. [bytes]
std::size_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page = sysconf(_SC_PAGESIZE);
  std::size_t memory = pages > 0 && page > 0
                           ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(page)
                           : std::numeric_limits<std::size_t>::max();
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::size_t limit = 0;
    if (std::ifstream(file) >> limit && limit > 0) memory = std::min(memory, limit);
  }
  return memory;
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

void add_threads(CLI::App& command, ResourceOptions& options) {
  command
      .add_option("--threads", options.threads,
                  "Number of threads; as many as the machine has by default")
      ->check(CLI::Validator(
          [](std::string& text) -> std::string {
            const auto count = to_integer(text);
            return count && *count >= 1 && *count <= 1024
                       ? ""
                       : text + ": must be an integer from 1 to 1024";
          },
          "from 1 to 1024"));
}

void add_memory(CLI::App& command, ResourceOptions& options) {
  constexpr double least = 1e-6;  // a kilobyte
  command
      .add_option("--max-memory", options.max_memory,
                  "Most memory to use, in GB; a run that needs more is refused before it "
                  "allocates; three quarters of the machine's memory by default")
      ->check(number_from(least));
}

SimulationOptions simulation_options(const ResourceOptions& options) {
  const auto machine_threads = static_cast<int>(std::thread::hardware_concurrency());
  return {.checkpoint_bytes = 0,
          .max_memory = options.max_memory > 0 ? static_cast<std::size_t>(options.max_memory * 1e9)
                                               : machine_memory() / 4 * 3,
          .threads = options.threads > 0 ? options.threads : std::max(1, machine_threads),
          .should_stop = &was_interrupted};
}

}  // namespace pliant::cli
