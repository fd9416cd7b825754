#pragma once

#include <filesystem>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Whether the folder that `file`, given with an option, is to lie in is there: looked at ahead of
/// any work. Errors: Unwritable, naming the option and the folder.
Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file);

}  // namespace pliant::cli
