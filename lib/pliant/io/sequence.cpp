#include "pliant/io/sequence.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "pliant/io/atomic_file.hpp"

namespace pliant {

std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame) {
  std::string name = pattern.filename().string();
  std::size_t last = name.rfind('#');
  std::size_t width = 4;
  if (last == std::string::npos) {
    const std::size_t dot = name.rfind('.');
    name.insert(dot, ".#");
    last = dot + 1;
  } else {
    width = last + 1 - (name.find_last_not_of('#', last) + 1);
  }
  const std::size_t first = name.find_last_not_of('#', last) + 1;
  name.replace(first, last + 1 - first,
               fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::abs(std::int64_t{frame}), width));
  return pattern.parent_path() / name;
}

Result<void> check_sequence(const AnimationPlan& plan) {
  auto probe = AtomicFile::create(sequence_file(plan.file, plan.first_frame));
  if (!probe) return fail(probe.error());
  return {};
}

}  // namespace pliant
