#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/findings.hpp"
#include "pliant/scene/scene.hpp"

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
  std::filesystem::path folder;  ///< mesh paths are relative to it
  std::filesystem::path root;    ///< contains the files that meshes refer to
  Findings findings;
  std::map<std::string, int> lines = {};  ///< see SceneLine
  std::vector<NamedMesh> meshes = {};
  /// `NAME.attribute` of those with a problem: their values are not those of the author.
  std::set<std::string, std::less<>> unsound = {};
};

}  // namespace pliant::xml
