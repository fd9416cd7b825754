#pragma once

#include <string_view>

#include "view.hpp"

namespace pliant::cli {

/// Writes a movie of the frames: a headless browser draws them and ffmpeg encodes them. Returns the
/// exit code.
int movie_view(const ViewOptions& options, std::string_view page);

}  // namespace pliant::cli
