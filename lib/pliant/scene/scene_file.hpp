#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/findings.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::xml {

/// The surfaces that a force names; checked once all surfaces are known.
struct Targets {
  std::string element;  ///< of the force: `point`
  std::vector<std::string> surfaces;
  int line = 0;
};

/// A mesh file that a surface names.
struct NamedMesh {
  std::string surface;  ///< empty: its name could not be read
  std::filesystem::path path;
  int line = 0;
};

/// A scene file while it is read: where it is, and what has been found in it.
struct SceneFile {
  std::filesystem::path folder;  ///< that mesh paths are relative to
  std::filesystem::path root;    ///< that what meshes refer to lies in
  SceneOrigin origin;
  Findings findings;
  std::vector<Targets> targets = {};
  std::vector<NamedMesh> meshes = {};
  /// `NAME.attribute` of those with a mistake: their values are not what the author means.
  std::set<std::string, std::less<>> unsound = {};
};

}  // namespace pliant::xml
