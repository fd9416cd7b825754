#pragma once

#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

/// All bytes of a file. Errors: Unreadable, naming the file and the reason: it does not exist, is a
/// folder, may not be read, or is larger than `max_bytes`.
Result<std::string> read_file(const std::filesystem::path& file,
                              std::size_t max_bytes = std::size_t{4} << 30);

/// Whether a file exists, is not a folder and may be read; does not open it. Errors: as
/// `read_file`.
Result<void> check_readable(const std::filesystem::path& file);

}  // namespace pliant
