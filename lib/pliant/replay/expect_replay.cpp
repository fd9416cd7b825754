#include "pliant/replay/expect_replay.hpp"

#include <vector>

#include "pliant/replay/replay.hpp"

namespace pliant::testing {

std::string expect_replay(const std::filesystem::path& scene_file,
                          const std::filesystem::path& log_file) {
  const auto verdict = verify_replay(log_file, scene_file);
  if (verdict && verdict->holds()) return {};
  std::string text;
  for (const std::string& line : verdict ? verdict->lines() : to_lines(verdict.error())) {
    text += line + '\n';
  }
  return text;
}

}  // namespace pliant::testing
