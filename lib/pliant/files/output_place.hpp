#pragma once

#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

/// Whether a file may be written under this name: it must be unused or the name of a regular file,
/// which will be replaced. A link, a pipe or a device would be replaced too, instead of being
/// written to, which no user intends. Errors, naming the file: InvalidInput for an empty name, a
/// folder, a link (also a broken one), a pipe, a socket, a device, a file that may not be written,
/// and for a name that is longer than the folder allows. Reads the disk, but writes nothing.
Result<void> check_output_place(const std::filesystem::path& file);

// Internal to output.

/// The beginning of the name of the file until it is renamed to `file`, without the part that makes
/// it unique: hidden, beginning with the file's name, and of limited length for any name.
std::string hidden_name(const std::filesystem::path& file);

}  // namespace pliant
