#pragma once

#include <optional>
#include <string>

#include "cache.hpp"
#include "command_line.hpp"
#include "resources.hpp"
#include "scene_input.hpp"

namespace pliant::cli {

/// Options of `pliant bake`.
struct BakeOptions {
  std::string scene;
  std::string out;
  std::optional<std::string> frames = {};   ///< A:B; null: all frames
  std::optional<std::string> surface = {};  ///< null: all surfaces
  std::string space = "world";
  std::optional<std::string> regions = {};  ///< JSON file; null: not written
  std::string solver = "auto";
  bool resume = false;
  bool is_quiet = false;
  bool is_profiled = false;
  bool checks_dt = false;
  Root root = {};
  Changes changes = {};
  CacheOptions cache;
  ResourceOptions resources;
};

void add_bake(CLI::App& app, BakeOptions& options);

/// Simulates a scene and writes the animation. Returns the exit code.
int run_bake(const BakeOptions& options);

}  // namespace pliant::cli
