#pragma once

#include <string_view>

#include "view.hpp"

namespace pliant::cli {

/// Writes a movie of the frames, which a browser without a window draws and ffmpeg puts together.
/// Gives the exit code.
int movie_view(const ViewOptions& options, std::string_view page);

}  // namespace pliant::cli
