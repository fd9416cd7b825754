#pragma once

#include <filesystem>

#include "pliant/core/result.hpp"

namespace pliant {

/// Makes a folder within that of a sweep, if it is not there. Errors: InvalidInput: a link is in
/// its place, which may lead anywhere if the sweep is a stranger's; Unwritable. Internal to sweep.
Result<void> make_own_folder(const std::filesystem::path& folder);

}  // namespace pliant
