#pragma once

#include <string_view>

#include "view.hpp"

namespace pliant::cli {

/// Writes a picture of one frame, or a sheet of several, which a browser without a window draws.
/// Gives the exit code.
int picture_view(const ViewOptions& options, std::string_view page);

}  // namespace pliant::cli
