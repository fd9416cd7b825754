#include "cli/terminal/memory_limit.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

std::optional<std::size_t> least(std::optional<std::size_t> one, std::optional<std::size_t> other) {
  if (!one || !other) return one ? one : other;
  return std::min(*one, *other);
}

// The number that begins a file; none for "max". A number larger than any machine's memory stands
// for no limit, and does no harm.
std::optional<std::size_t> number_in_file(const std::string& file) {
  std::size_t number = 0;
  if (std::ifstream(file) >> number && number > 0) return number;
  return {};
}

// A file system of control groups that limit memory.
struct Groups {
  std::string root;   // the group that is mounted
  std::string place;  // where
  bool is_first_version = false;
};

// A line of mountinfo: ID PARENT DEVICE ROOT PLACE OPTIONS [FIELD…] - TYPE SOURCE OPTIONS.
std::optional<Groups> parse_mount(const std::string& line) {
  const std::size_t dash = line.find(" - ");
  if (dash == std::string::npos) return {};
  std::istringstream head(line.substr(0, dash)), tail(line.substr(dash + 3));
  std::string skipped, type, source, options;
  Groups groups;
  head >> skipped >> skipped >> skipped >> groups.root >> groups.place;
  tail >> type >> source >> options;
  if (!head || !tail) return {};
  groups.is_first_version = type == "cgroup";
  const bool limits_memory =
      type == "cgroup2" ||
      (type == "cgroup" && ("," + options + ",").find(",memory,") != std::string::npos);
  if (!limits_memory) return {};
  return groups;
}

// The group of this process: of a line ID:CONTROLLERS:PATH, whose controllers are empty in the
// second version.
std::optional<std::string> group_in(const std::string& root, bool is_first_version) {
  std::ifstream file(root + "/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool fits = is_first_version
                          ? ("," + controllers + ",").find(",memory,") != std::string::npos
                          : controllers.empty();
    if (fits) return line.substr(second + 1);
  }
  return {};
}

// A group's path below the one that is mounted. What is not below it, as in a container that sees
// only its own group, counts as that one.
std::string path_within(const Groups& groups, std::string group) {
  if (groups.root != "/") {
    const bool is_below =
        group == groups.root || std::string_view(group).starts_with(groups.root + "/");
    group = is_below ? group.substr(groups.root.size()) : "";
  }
  if (group.find("/..") != std::string::npos) group.clear();  // outside of its namespace
  while (group.ends_with('/')) group.pop_back();
  return group;
}

std::optional<std::size_t> mebibytes(const char* text) {
  const auto number = text == nullptr ? std::nullopt : to_integer(text);
  if (!number || *number <= 0) return {};
  return static_cast<std::size_t>(*number) << 20U;
}

}  // namespace

std::optional<std::size_t> memory_of_groups(const std::string& root) {
  std::optional<std::size_t> limit;
  std::ifstream mounts(root + "/proc/self/mountinfo");
  for (std::string line; std::getline(mounts, line);) {
    const auto groups = parse_mount(line);
    if (!groups) continue;
    const auto group = group_in(root, groups->is_first_version);
    if (!group) continue;
    const char* const name = groups->is_first_version ? "/memory.limit_in_bytes" : "/memory.max";
    // Each group around it limits it too.
    for (std::string path = path_within(*groups, *group);;) {
      limit =
          least(limit, number_in_file(fmt::format("{}{}{}{}", root, groups->place, path, name)));
      if (path.empty()) break;
      path.resize(path.find_last_of('/'));
    }
  }
  return limit;
}

std::optional<std::size_t> memory_of_slurm_job(
    const std::function<const char*(const char*)>& value_of) {
  if (value_of("SLURM_JOB_ID") == nullptr) return {};
  auto of_processors = mebibytes(value_of("SLURM_MEM_PER_CPU"));
  const char* const processors = value_of("SLURM_CPUS_ON_NODE");
  const auto count = processors == nullptr ? std::nullopt : to_integer(processors);
  if (of_processors && count && *count > 0) *of_processors *= static_cast<std::size_t>(*count);
  return least(mebibytes(value_of("SLURM_MEM_PER_NODE")), of_processors);
}

std::size_t default_memory(std::size_t machine, std::optional<std::size_t> limit, std::size_t own) {
  const std::size_t of_machine = machine / 4 * 3;
  if (!limit) return of_machine;
  const std::size_t usable = *limit / 5 * 4, used = memory_of_program + own;
  // Of a limit that the program alone nearly reaches, a fifth: what it has is an upper bound.
  return std::min(of_machine, std::max(*limit / 5, usable > used ? usable - used : 0));
}

}  // namespace pliant::cli
