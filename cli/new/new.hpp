#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"

namespace pliant::cli {

/// Options of `pliant new`.
struct NewOptions {
  std::optional<std::string> name = {};      ///< of the starter; null: lists all
  std::optional<std::string> out = {};       ///< null: prints the scene
  std::optional<std::string> material = {};  ///< of a look; null: that of the starter
  std::optional<std::string> mesh = {};      ///< file of the user's own mesh; null: the starter's
  std::optional<std::string> object = {};    ///< of that file; null: its only one
  Root root = {};                            ///< of that file
  bool has_schema = false;                   ///< whether the schema is written beside the scene
  bool is_forced = false;                    ///< whether existing files are replaced
  bool is_quiet = false;                     ///< whether no progress is shown
};

void add_new(CLI::App& app, NewOptions& options);

/// The text of a new scene, and those of the files beside it that it names, by their places.
struct NewScene {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files = {};
};

/// What `run_new` would write to `options.out`, which it needs, whatever is there in place of the
/// scene. Errors: those of `run_new`.
Result<NewScene> new_scene(const NewOptions& options);

/// Writes a starter scene, or lists the starters. Returns the exit code.
int run_new(const NewOptions& options);

}  // namespace pliant::cli
