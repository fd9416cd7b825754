#pragma once

#include <filesystem>
#include <string>

namespace pliant::testing {

/// For a program's own tests: simulates a scene file and compares it with its log, bit for bit.
/// Returns all differences, one line each, or an empty text, so that any test framework can report
/// it:
///
///     CHECK(pliant::testing::expect_replay("sheet.xml", "sheet.replay") == "");
///
/// docs/replay.md.
std::string expect_replay(const std::filesystem::path& scene_file,
                          const std::filesystem::path& log_file);

}  // namespace pliant::testing
