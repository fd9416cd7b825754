#include "inputs.hpp"

#include <system_error>

#include <fmt/format.h>

#include "pliant/scene/inputs.hpp"

namespace pliant::cli {

bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  // Absolute first: otherwise a relative path that does not exist would not be resolved at all.
  const auto place = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
  };
  return std::filesystem::equivalent(a, b, ignored) || place(a) == place(b);
}

std::string input_named(const std::filesystem::path& file, const Scene& scene) {
  for (const SceneInput& input : inputs_of(scene))
    if (name_one_file(file, input.file)) return fmt::format("it is {}", input.role);
  return {};
}

InputsByName::InputsByName(const Scene& scene) {
  for (const SceneInput& input : inputs_of(scene)) {
    std::error_code unknown;
    const auto real = std::filesystem::canonical(input.file, unknown);
    for (const auto& file : {input.file, unknown ? input.file : real})
      files_.emplace(file.filename().string(), input.file);
  }
}

// Compares names first: querying the disk for each of a million frames would be slow.
std::optional<std::filesystem::path> InputsByName::find(const std::filesystem::path& output) const {
  const auto [first, last] = files_.equal_range(output.filename().string());
  for (auto each = first; each != last; ++each)
    if (name_one_file(output, each->second)) return each->second;
  return std::nullopt;
}

}  // namespace pliant::cli
