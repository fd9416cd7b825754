#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace pliant::cli {

/// What a command has in memory apart from what a run reserves, at most. [bytes]
inline constexpr std::size_t memory_of_program = std::size_t{64} << 20U;

/// The least limit of memory of the control groups that this process is in, and of those around
/// them, in both versions: of a container, a service, a session or a job. `root` stands for the
/// root of the file system. [bytes] None: no group limits it.
std::optional<std::size_t> memory_of_groups(const std::string& root = "");

/// The memory of the Slurm job that this process is in, on this node, by the variables that Slurm
/// sets; `value_of` is `getenv`. [bytes] None: no job, or one with the whole node.
std::optional<std::size_t> memory_of_slurm_job(
    const std::function<const char*(const char*)>& value_of);

/// The most that a command reserves by default: three quarters of the machine's memory; where a
/// limit of so many bytes, within which only this process runs, leaves less, four fifths of that
/// without `memory_of_program` and `own`. [bytes]
std::size_t default_memory(std::size_t machine, std::optional<std::size_t> limit, std::size_t own);

}  // namespace pliant::cli
