#pragma once

#include <optional>
#include <string>

#include "command_line.hpp"
#include "resources.hpp"
#include "scene_input.hpp"

namespace pliant::cli {

/// What `pliant view` was asked to do.
struct ViewOptions {
  std::string scene;
  std::optional<std::string> out = {};     ///< none: view.html, if a page is to be written
  std::optional<std::string> frames = {};  ///< A:B; none: all
  std::optional<int> port = {};            ///< to serve the page on, 0: any; none: not served
  std::optional<std::string> png = {};     ///< a picture in place of a page
  std::optional<std::string> movie = {};   ///< a movie in place of a page
  std::optional<int> frame = {};           ///< of the picture; none: the first
  bool is_sheet = false;                   ///< the picture is one of several frames
  std::string size = "1280x800";  ///< of the picture, of each in a sheet, or of the movie [px]
  std::string look;               ///< of the picture or movie, as the page's address has it
  bool is_quiet = false;
  Root root = {};
  ResourceOptions resources;
};

void add_view(CLI::App& app, ViewOptions& options);

/// Makes a page that plays a scene, serves it, or takes a picture of it. Gives the exit code.
int run_view(const ViewOptions& options);

}  // namespace pliant::cli
