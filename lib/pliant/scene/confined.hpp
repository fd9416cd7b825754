#pragma once

#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant::xml {

/// What tells a file from all others, whatever links lead to it. Errors: InvalidInput if it is not
/// in the folder `root` or below (`check_below`; an empty root contains all); Unreadable if it
/// cannot be read or is not a regular file.
Result<std::string> identify_file(const std::filesystem::path& file,
                                  const std::filesystem::path& root);

}  // namespace pliant::xml
