#include "cli/terminal/memory_limit.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pliant/sweep/sweep.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::cli;

namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

// The root of a file system with these files.
std::optional<std::size_t> limit_with(
    const std::vector<std::pair<std::string, std::string>>& files) {
  const testing::ScratchFolder root;
  for (const auto& [name, text] : files) {
    std::filesystem::create_directories(root.file(name).parent_path());
    root.write(name, text);
  }
  return memory_of_groups(root.path().string());
}

const std::string second_version =
    "30 23 0:26 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n";
const std::string first_version =
    "35 31 0:32 /docker/a1 /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n"
    "36 31 0:33 /docker/a1 /sys/fs/cgroup/cpu ro - cgroup cgroup rw,cpu,cpuacct\n";

std::optional<std::size_t> job_with(const std::map<std::string, std::string>& variables) {
  return memory_of_slurm_job([&](const char* name) -> const char* {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}

}  // namespace

TEST_CASE("the least limit of the groups around a process counts", "[cli][memory]") {
  CHECK_FALSE(limit_with({}));
  const std::string own = "proc/self/cgroup", mounts = "proc/self/mountinfo";
  // A task of a Slurm job: its own group has no limit, that of the job has.
  const std::string job = "sys/fs/cgroup/system.slice/slurmstepd.scope/job_7";
  const std::string group = "0::/system.slice/slurmstepd.scope/job_7/step_batch/user/task_0\n";
  CHECK(limit_with({{mounts, second_version},
                    {own, group},
                    {job + "/step_batch/user/task_0/memory.max", "max\n"},
                    {job + "/step_batch/memory.max", "4000000\n"},
                    {job + "/memory.max", "3000000\n"},
                    {"sys/fs/cgroup/system.slice/memory.max", "9000000\n"}}) == 3000000U);
  CHECK_FALSE(limit_with({{mounts, second_version}, {own, group}, {job + "/memory.max", "max\n"}}));
  // A container with groups of its own, in both versions.
  CHECK(limit_with({{mounts, second_version},
                    {own, "0::/\n"},
                    {"sys/fs/cgroup/memory.max", "5000000\n"}}) == 5000000U);
  for (const char* path : {"/docker/a1", "/", "/docker/a12"}) {
    CHECK(limit_with({{mounts, first_version},
                      {own, std::string("5:cpu,cpuacct:/x\n4:memory:") + path + "\n0::/\n"},
                      {"sys/fs/cgroup/memory/memory.limit_in_bytes", "6000000\n"},
                      {"sys/fs/cgroup/cpu/memory.limit_in_bytes", "1\n"}}) == 6000000U);
  }
  // Below the container's group.
  CHECK(limit_with({{mounts, first_version},
                    {own, "4:memory:/docker/a1/job\n"},
                    {"sys/fs/cgroup/memory/job/memory.limit_in_bytes", "500000\n"},
                    {"sys/fs/cgroup/memory/memory.limit_in_bytes", "6000000\n"}}) == 500000U);
  // Nothing leads out of the file system of groups, and what is no list of mounts counts for
  // nothing.
  CHECK(limit_with({{mounts, second_version},
                    {own, "0::/../../other\n"},
                    {"sys/fs/other/memory.max", "1\n"},
                    {"sys/fs/cgroup/memory.max", "5000000\n"}}) == 5000000U);
  CHECK_FALSE(limit_with({{mounts, "nonsense\n - \n1 2 3 - cgroup2\n"}, {own, "::\n:\n0::/\n"}}));
}

TEST_CASE("a Slurm job's memory is that of the node or of its processors", "[cli][memory]") {
  CHECK_FALSE(job_with({}));
  CHECK_FALSE(job_with({{"SLURM_MEM_PER_NODE", "100"}}));  // of no job
  CHECK_FALSE(job_with({{"SLURM_JOB_ID", "7"}}));
  CHECK(job_with({{"SLURM_JOB_ID", "7"}, {"SLURM_MEM_PER_NODE", "100"}}) == 100 * mebibyte);
  CHECK(job_with(
            {{"SLURM_JOB_ID", "7"}, {"SLURM_MEM_PER_CPU", "100"}, {"SLURM_CPUS_ON_NODE", "3"}}) ==
        300 * mebibyte);
  CHECK(job_with({{"SLURM_JOB_ID", "7"}, {"SLURM_MEM_PER_CPU", "100"}}) == 100 * mebibyte);
  for (const char* text : {"0", "-5", "x", "", "1G"})
    CHECK_FALSE(job_with({{"SLURM_JOB_ID", "7"}, {"SLURM_MEM_PER_NODE", text}}));
}

TEST_CASE("by default a run stays within the limit of its job", "[cli][memory]") {
  const std::size_t machine = 100'000 * mebibyte;
  CHECK(default_memory(machine, {}, 0) == machine / 4 * 3);
  CHECK(default_memory(machine, 2 * machine, 0) == machine / 4 * 3);
  for (const std::size_t limit : {10, 82, 200, 1000, 50'000}) {
    for (const std::size_t own : {0, 50, 500}) {
      CAPTURE(limit, own);
      const std::size_t bytes = limit * mebibyte;
      const std::size_t memory = default_memory(machine, bytes, own * mebibyte);
      CHECK(memory >= bytes / 5);
      CHECK(memory <= bytes / 5 * 4);
      if (memory > bytes / 5) CHECK(memory + memory_of_program + own * mebibyte <= bytes);
    }
  }
  // What a part of a sweep asks for, a quarter more than its estimate, suffices for its takes.
  for (const std::size_t each : {1, 40, 1500}) {
    for (const int threads : {1, 3, 16}) {
      for (const std::size_t records : {0, 50, 500}) {
        CAPTURE(each, threads, records);
        const std::size_t of_takes =
            memory_of_takes(static_cast<std::size_t>(threads), each * mebibyte);
        const std::size_t estimate = memory_of_program + records * mebibyte + of_takes;
        const std::size_t memory =
            default_memory(machine, estimate / 4 * 5 + 5, records * mebibyte);
        const TakesAtOnce at_once = takes_at_once(1000, threads, memory);
        CHECK(at_once.count == static_cast<std::size_t>(threads));
        CHECK(at_once.memory >= each * mebibyte);
      }
    }
  }
}
