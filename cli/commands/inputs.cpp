#include "cli/commands/inputs.hpp"

#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "cli/terminal/interrupt.hpp"
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
  for (const SceneInput& input : inputs_of(scene, &was_interrupted))
    if (name_one_file(file, input.file)) return fmt::format("it is {}", input.role);
  return {};
}

tl::unexpected<Error> refuse_output(std::string_view option, const std::filesystem::path& file,
                                    std::string_view reason) {
  return fail(ErrorCode::InvalidInput, fmt::format("{} {}: {}; choose another name", option,
                                                   printable(file.string()), reason));
}

Result<void> check_no_input(std::string_view option, const std::filesystem::path& file,
                            const Scene& scene) {
  const std::string input = input_named(file, scene);
  return input.empty() ? Result<void>() : refuse_output(option, file, input);
}

InputFinder::InputFinder(const Scene& scene) {
  for (const SceneInput& input : inputs_of(scene, &was_interrupted)) {
    struct stat status = {};
    if (stat(input.file.c_str(), &status) == 0) {
      there_.try_emplace({status.st_dev, status.st_ino}, input.file);
    } else {
      missing_.emplace(input.file.filename().string(), input.file);
    }
  }
}

// One question for each of a million frames; more only for names that an input has.
std::optional<std::filesystem::path> InputFinder::find(const std::filesystem::path& output) const {
  struct stat status = {};
  if (stat(output.c_str(), &status) == 0) {
    const auto found = there_.find({status.st_dev, status.st_ino});
    return found != there_.end() ? std::optional(found->second) : std::nullopt;
  }
  const auto [first, last] = missing_.equal_range(output.filename().string());
  for (auto each = first; each != last; ++each)
    if (name_one_file(output, each->second)) return each->second;
  return std::nullopt;
}

}  // namespace pliant::cli
