#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::cli {

/// The most characters of a list that Slurm takes for an array: 22.05 refuses one more.
inline constexpr std::size_t longest_array_list = 4096;

/// Numbers as sbatch's `--array` takes them: `0-4,7,9-10`. If that is longer than `most`, it has
/// the numbers between those that are nearest to each other too. Requires: ascending; two of them
/// fit.
std::string array_list(std::span<const std::size_t> numbers, std::size_t most = longest_array_list);

/// The numbers below `end` of a list as sbatch's `--array` takes it, `0-4,7,8-20:4%5`, ascending.
/// None: it is no such list.
std::optional<std::vector<std::size_t>> read_array_list(std::string_view list, std::size_t end);

/// A job array that runs the parts of a sweep.
struct SlurmScript {
  std::string executable;                  ///< absolute
  std::string folder;                      ///< of the sweep, absolute
  std::string name;                        ///< of the sweep
  std::size_t parts = 1;                   ///< in all
  int threads = 1;                         ///< of a part
  std::optional<std::size_t> memory = {};  ///< of a part [bytes]; none: the cluster's default
  std::optional<double> seconds = {};      ///< that a part takes; none: unknown
  double max_memory = 0;                   ///< `--max-memory` of a part [GB]; 0: its default
  std::string root = {};                   ///< `--root` of a part, absolute; empty: none
  bool retries = false;                    ///< also takes that failed
};

/// Why a folder cannot be that of a SlurmScript; empty: it can.
std::string_view wrong_slurm_folder(std::string_view folder);

/// The text of its job.sh. Requires: the folder is not wrong.
std::string job_script(const SlurmScript& script);

}  // namespace pliant::cli
