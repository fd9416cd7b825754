#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/expand.hpp"
#include "pliant/scene/text/findings.hpp"

namespace pliant::xml {

/// A mesh file or a cache that a surface names.
struct NamedMesh {
  std::string surface;  ///< empty: its name could not be read
  std::filesystem::path path;
  int line = 0;
  std::string attribute;  ///< that names it
};

/// A scene file while it is read: its location, and the findings so far.
struct SceneFile {
  std::filesystem::path folder;  ///< paths in the file itself are relative to it
  std::filesystem::path root;    ///< contains all files that the scene leads to; empty: any may
  TextFiles texts;               ///< those that it may include
  Findings findings;
  std::optional<LineMap> files = {};  ///< of the expanded text's lines; absent: nothing is included
  bool is_expanded = true;  ///< false: some content is missing, for reasons that are reported
  std::map<std::string, int> lines = {};  ///< see SceneLine
  std::vector<NamedMesh> meshes = {};
  /// `NAME.attribute` of those with a problem: their values are not those of the author.
  std::set<std::string, std::less<>> unsound = {};

  /// The folder of the file that contains a line of the expanded text.
  std::filesystem::path folder_at(int line) const {
    const int text = files ? files->text_of(line) : 0;
    if (text == 0) return folder;
    return std::filesystem::path(files->texts()[static_cast<std::size_t>(text)].file).parent_path();
  }
};

/// As `parse_scene`, where included files are found by `texts`.
Result<Scene> parse_scene_of(std::string_view text, const std::string& name,
                             const std::string& folder, const std::string& root, TextFiles texts,
                             const StopRequest& should_stop = {});

}  // namespace pliant::xml
