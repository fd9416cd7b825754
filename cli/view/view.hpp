#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant view`.
struct ViewOptions {
  std::string scene;
  std::optional<std::string> out = {};     ///< null: view.html, if a page is written
  std::optional<std::string> frames = {};  ///< A:B; null: all frames
  std::optional<int> port = {};            ///< port to serve the page on, 0: any; null: not served
  std::optional<std::string> png = {};     ///< a picture instead of a page
  std::optional<std::string> movie = {};   ///< a movie instead of a page
  std::optional<int> frame = {};           ///< of the picture; null: the first
  bool is_sheet = false;                   ///< the picture shows several frames
  std::string size = "1280x800";  ///< of the picture, of each frame in a sheet, or of the movie
                                  ///< [px]
  std::string look;               ///< of the picture or movie, in the syntax of the page's address
  bool is_quiet = false;
  Root root = {};
  Changes changes = {};
  ResourceOptions resources;
};

void add_view(CLI::App& app, ViewOptions& options);

/// Makes a page that plays a scene, serves it, or makes a picture or movie of it. Returns the exit
/// code.
int run_view(const ViewOptions& options);

/// Writes a movie of the frames: a headless browser draws them and ffmpeg encodes them. Returns the
/// exit code.
int movie_view(const ViewOptions& options, std::string_view page);

/// Serves the page until Ctrl-C, and bakes again when the scene's file or one of its meshes is
/// saved. Returns the exit code.
int serve_view(const ViewOptions& options, std::string_view page);

}  // namespace pliant::cli
