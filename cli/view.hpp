#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

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
  std::optional<int> frame = {};           ///< of the picture; none: the first
  bool is_sheet = false;                   ///< the picture is one of several frames
  std::string size = "1280x800";           ///< of the picture, or of each in a sheet [px]
  std::string look;                        ///< of the picture, as the page's address has it
  bool is_quiet = false;
  Root root = {};
  ResourceOptions resources;
};

void add_view(CLI::App& app, ViewOptions& options);

/// Makes a page that plays a scene, serves it, or takes a picture of it. Gives the exit code.
int run_view(const ViewOptions& options);

}  // namespace pliant::cli
