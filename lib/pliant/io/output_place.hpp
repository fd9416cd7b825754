#pragma once

#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

/// Whether a file may be written there: nothing has the name yet, or a regular file, which the new
/// one replaces. A link, a pipe or a device would be replaced too, instead of being written to, and
/// nobody who names one means that.
/// Errors, naming the file: InvalidInput for an empty name, a folder, a link (also one that leads
/// nowhere), a pipe, a socket, a device, and for a name that is longer than the folder allows.
/// Looks at the disk, and leaves nothing there.
Result<void> check_output_place(const std::filesystem::path& file);

// Not for other rooms.

/// How a file that will be `file` is called until then, without what makes it unique: hidden,
/// beginning with its name, and short whatever that name is.
std::string hidden_name(const std::filesystem::path& file);

}  // namespace pliant
