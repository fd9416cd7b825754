#include "cli/commands/scene_input.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/terminal/interrupt.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/mesh_objects.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::cli {
namespace {

constexpr const char* name = "standard input";

// One byte more than `parse_scene` accepts, to detect a scene that is too large.
constexpr std::size_t most_bytes = largest_scene_file + 1;

tl::unexpected<Error> interruption() {
  return fail(ErrorCode::Interrupted, "interrupted before the first frame");
}

Result<std::string> read_standard_input() {
  std::string text;
  std::string chunk(std::size_t{1} << 20U, '\0');
  while (text.size() < most_bytes) {
    const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
    if (count == 0) return text;
    if (was_interrupted()) return interruption();
    if (count > 0) {
      text.append(chunk, 0, static_cast<std::size_t>(count));
      continue;
    }
    if (errno != EINTR) {
      return fail(ErrorCode::Unreadable, std::string("cannot read it: ") + std::strerror(errno),
                  name);
    }
  }
  return text;
}

}  // namespace

void add_root(CLI::App& command, Root& root) {
  command.add_option(
      "--root", root,
      "Folder that must contain every file that the scene leads to; by default only what meshes "
      "refer to is confined, to the scene's folder");
}

Result<std::filesystem::path> folder_of(const Root& root) {
  if (!root) return std::filesystem::path();
  std::error_code ignored;
  if (std::filesystem::is_directory(*root, ignored)) return std::filesystem::path(*root);
  return fail(ErrorCode::InvalidInput, fmt::format("--root {}: is not a folder", printable(*root)));
}

bool is_standard_input(std::string_view scene) { return scene == "-"; }

bool is_mesh_file(const std::string& file) {
  const std::vector<std::string> endings = mesh_endings();
  return std::ranges::find(endings, ending_of(file)) != endings.end();
}

std::string title_of_scene(const std::string& scene) {
  return is_standard_input(scene) ? name : scene;
}

void add_changes(CLI::App& command, Changes& changes) {
  command
      .add_option("--set", changes,
                  "As if the scene said so, as often as needed: NAME.ATTRIBUTE=TEXT, or a channel "
                  "times K, NAME.ATTRIBUTE*=K, or plus V, NAME.ATTRIBUTE+=V")
      ->type_name("PATH=TEXT")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
}

Result<SceneSource> read_scene_text(const std::string& scene) {
  if (is_mesh_file(scene)) {
    return fail(ErrorCode::InvalidInput,
                "it is a mesh, not a scene; pliant info lists its objects, and pliant new mesh "
                "--mesh writes a scene for it",
                scene);
  }
  if (!is_standard_input(scene)) {
    auto text = read_file(scene, largest_scene_file, &was_interrupted);
    if (!text && was_interrupted()) return interruption();  // while waiting for a pipe
    if (!text) return fail(text.error());
    return SceneSource{*std::move(text), scene,
                       std::filesystem::path(scene).parent_path().string()};
  }
  if (isatty(STDIN_FILENO) != 0) {
    return fail(
        ErrorCode::InvalidInput,
        "SCENE -: the standard input is a terminal; give a file, or pipe the scene: … | pliant");
  }
  auto text = read_standard_input();
  if (!text) return fail(text.error());
  return SceneSource{*std::move(text), name, {}};
}

Result<Scene> parse_source(const SceneSource& source, const Root& root) {
  const auto folder = folder_of(root);
  if (!folder) return fail(folder.error());
  return parse_scene(source.text, source.name, source.folder, *folder, &was_interrupted);
}

Result<Scene> read_scene(const std::string& scene, const Root& root, const Changes& changes) {
  if (const auto folder = folder_of(root); !folder) return fail(folder.error());
  const auto source = read_scene_text(scene);
  if (!source) return fail(source.error());
  auto read = parse_source(*source, root);
  if (!read || changes.empty()) return read;
  if (auto changed = change_scene(*read, changes, root.value_or("")); !changed)
    return fail(changed.error());
  return read;
}

Result<void> check_scene_is_file(std::string_view scene, std::string_view reason) {
  if (!is_standard_input(scene)) return {};
  return fail(
      ErrorCode::InvalidInput,
      fmt::format("SCENE -: the standard input is not allowed here: {}; save the scene to a file",
                  reason));
}

}  // namespace pliant::cli
