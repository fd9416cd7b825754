#pragma once

#include <string_view>

#include "cli/view/view.hpp"

namespace pliant::cli {

/// Writes a movie of the frames: a headless browser draws them and ffmpeg encodes them. Returns the
/// exit code.
int movie_view(const ViewOptions& options, std::string_view page);

/// Serves the page until Ctrl-C, and bakes again when the scene's file or one of its meshes is
/// saved. Returns the exit code.
int serve_view(const ViewOptions& options, std::string_view page);

}  // namespace pliant::cli
