#pragma once

#include <functional>
#include <optional>
#include <string>

#include "cli/commands/cache.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"
#include "pliant/core/hash.hpp"

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
  bool omits_colliders = false;
  bool is_profiled = false;
  bool checks_dt = false;
  Root root = {};
  Changes changes = {};
  CacheOptions cache;
  ResourceOptions resources;
};

void add_bake(CLI::App& app, BakeOptions& options);

/// The options but those that choose the scene, its values and the solver.
void add_bake_options(CLI::App& command, BakeOptions& options);

/// Simulates a scene and writes the animation. Returns the exit code.
int run_bake(const BakeOptions& options);

/// A scene that is baked, and what its frames must be.
struct BakeSource {
  std::function<Result<Scene>()> read;
  std::optional<Hash> hash = {};  ///< as `Measures::hash`, of the frames written; none: any
  std::string title = {};         ///< in the message if they have another one
};

/// The same for a scene that is read in another way.
int run_bake(const BakeOptions& options, const BakeSource& source);

}  // namespace pliant::cli
