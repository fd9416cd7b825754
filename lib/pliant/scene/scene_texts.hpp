#pragma once

#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The text of a file that a scene includes, as it was when the scene was read.
struct IncludedText {
  std::string path;  ///< as reading the scene asks for it
  std::string text;
};

/// All text that a scene is read from: with it, reading the scene again needs none of these files.
struct SceneTexts {
  std::string file;  ///< of the scene
  std::string text;
  std::vector<IncludedText> included = {};
};

/// Requires: the scene was read.
SceneTexts texts_of(const Scene& scene);

/// The scene of these texts; relative names of meshes are those of the folder of `texts.file`.
/// Errors: as `load_scene`, also for an included file that is not among the texts.
Result<Scene> parse_scene(const SceneTexts& texts, const std::string& root = {},
                          const StopRequest& should_stop = {});

}  // namespace pliant
