#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// The role of `file` as an input of a scene: "it is the scene", "it is a mesh of the scene", "it
/// is a file that a mesh of the scene refers to"; empty: not an input.
std::string input_named(const std::filesystem::path& file, const Scene& scene);

/// `-o FILE: REASON; choose another name`.
tl::unexpected<Error> refuse_output(std::string_view option, const std::filesystem::path& file,
                                    std::string_view reason);

/// Checks that a file, named by an option, is not an input of a scene. Errors: `refuse_output`.
Result<void> check_no_input(std::string_view option, const std::filesystem::path& file,
                            const Scene& scene);

}  // namespace pliant::cli
