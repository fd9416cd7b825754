#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Whether the folder that `file`, given with an option, is to lie in is there: looked at ahead of
/// any work. Errors: Unwritable, naming the option and the folder.
Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file);

/// Whether the file that an option names may be written: looked at ahead of the work, for every
/// file that a command writes and that is not one of an animation, which `make_writer` looks at.
/// Errors: those of `check_output_folder` and `check_output_place`; InvalidInput for "-", which is
/// no file elsewhere.
Result<void> check_output_file(std::string_view option, const std::string& file);

}  // namespace pliant::cli
