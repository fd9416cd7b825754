#include "cli/commands/inputs.hpp"

#include <fmt/format.h>

#include "cli/terminal/interrupt.hpp"

namespace pliant::cli {

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

}  // namespace pliant::cli
