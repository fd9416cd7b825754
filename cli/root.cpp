#include "root.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "pliant/scene/read.hpp"

namespace pliant::cli {

void add_root(CLI::App& command, Root& root) {
  command.add_option("--root", root,
                     "Folder that the files which meshes refer to lie in, or below; that of the "
                     "scene by default");
}

Result<std::filesystem::path> folder_of(const Root& root) {
  if (!root) return std::filesystem::path();
  std::error_code ignored;
  if (std::filesystem::is_directory(*root, ignored)) return std::filesystem::path(*root);
  return fail(ErrorCode::InvalidInput, fmt::format("--root {}: is no folder", printable(*root)));
}

Result<Scene> load_scene(const std::string& file, const Root& root) {
  const auto folder = folder_of(root);
  if (!folder) return fail(folder.error());
  return pliant::load_scene(file, *folder);
}

}  // namespace pliant::cli
