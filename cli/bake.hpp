#pragma once

#include <optional>
#include <string>

#include "cache.hpp"
#include "command_line.hpp"
#include "resources.hpp"
#include "scene_input.hpp"

namespace pliant::cli {

/// What `pliant bake` was asked to do.
struct BakeOptions {
  std::string scene;
  std::string out;
  std::optional<std::string> frames = {};   ///< A:B; none: all
  std::optional<std::string> surface = {};  ///< none: all
  std::string space = "world";
  std::optional<std::string> regions = {};  ///< JSON file; none: not written
  std::string solver = "auto";
  bool resume = false;
  bool is_quiet = false;
  bool is_profiled = false;
  Root root = {};
  CacheOptions cache;
  ResourceOptions resources;
};

void add_bake(CLI::App& app, BakeOptions& options);

/// Simulates a scene and writes the animation. Gives the exit code.
int run_bake(const BakeOptions& options);

}  // namespace pliant::cli
