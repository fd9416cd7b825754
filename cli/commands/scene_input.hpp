#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/terminal/command_line.hpp"
#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// `--root DIR` of every command that reads scenes; null: see `load_scene`.
using Root = std::optional<std::string>;

void add_root(CLI::App& command, Root& root);

/// `--set PATH=TEXT`, `PATH*=K` and `PATH+=V`, as typed.
using Changes = std::vector<std::string>;

void add_changes(CLI::App& command, Changes& changes);

/// The folder given; an empty path if null. Errors: InvalidInput if it is not a folder.
Result<std::filesystem::path> folder_of(const Root& root);

/// Whether a command's SCENE means the standard input: "-". A file of that name is "./-".
bool is_standard_input(std::string_view scene);

/// Whether a file has the ending of a mesh.
bool is_mesh_file(const std::string& file);

/// What messages and results call a command's SCENE: the name of its file, or `standard input`.
std::string title_of_scene(const std::string& scene);

/// The text of a scene.
struct SceneSource {
  std::string text;
  std::string name;    ///< of its file, in messages
  std::string folder;  ///< of the files that it names
};

/// Reads the text of a scene file, or for "-" of the standard input. Errors: as `read_scene`.
Result<SceneSource> read_scene_text(const std::string& scene);

/// Reads a scene from its text. Errors: as `read_scene`.
Result<Scene> parse_source(const SceneSource& source, const Root& root);

/// `load_scene`, or for "-" the same from the standard input: its mesh paths are relative to the
/// current folder. Errors: those of `load_scene` and `folder_of`; InvalidInput if the standard
/// input is a terminal; Interrupted.
///
/// With `changes` made in it; their errors begin with `--set CHANGE: `.
Result<Scene> read_scene(const std::string& scene, const Root& root, const Changes& changes = {});

/// For commands that read the scene again later. Errors: InvalidInput for "-", with the reason.
Result<void> check_scene_is_file(std::string_view scene, std::string_view reason);

}  // namespace pliant::cli
