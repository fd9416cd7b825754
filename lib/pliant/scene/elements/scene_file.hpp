#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/scene.hpp"
#include "pliant/scene/sharing/expand.hpp"
#include "pliant/scene/text/findings.hpp"

namespace pliant::xml {

/// A mesh file or a cache that a surface or a collider names.
struct NamedMesh {
  std::string owner;  ///< empty: its name could not be read
  std::filesystem::path path;
  TextPlace place;
};

/// A scene file while it is read: its location, and the findings so far.
struct SceneFile {
  std::filesystem::path folder;  ///< paths in the file itself are relative to it
  std::filesystem::path root;    ///< contains all files that the scene leads to; empty: any may
  TextFiles texts;               ///< those that it may include
  std::shared_ptr<SourceMap> sources;
  Findings findings;
  bool is_expanded = true;  ///< false: some content is missing, for reasons that are reported
  std::map<std::string, TextPlace> parts = {};  ///< see ScenePart
  std::vector<NamedMesh> meshes = {};
  /// `NAME.attribute` of those with a problem: their values are not those of the author.
  std::set<std::string, std::less<>> unsound = {};

  /// The folder of a text.
  std::filesystem::path folder_of(int text) const {
    if (text <= 0) return folder;
    const auto& source = sources->sources()[static_cast<std::size_t>(text)];
    return std::filesystem::path(source.file).parent_path();
  }
};

/// As `parse_scene`, where included files are found by `texts`.
Result<Scene> parse_scene_of(std::string text, const std::string& name, const std::string& folder,
                             const std::string& root, TextFiles texts,
                             const StopRequest& should_stop = {});

}  // namespace pliant::xml
