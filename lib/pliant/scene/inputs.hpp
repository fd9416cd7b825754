#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A file that a scene is made from.
struct SceneInput {
  std::filesystem::path file;
  /// "the scene", "a file that the scene includes", "a mesh of the scene", "a cache of the scene",
  /// "a map of the scene", "…that a mesh … refers to"
  std::string_view role;
  std::filesystem::path root = {};  ///< must contain it; empty: it may be anywhere
};

/// All files that reading a scene and its meshes opens: the scene's own, if it came from one, those
/// that it includes, its meshes with their caches and maps, and what meshes refer to, each once.
/// For a mesh that cannot be read, only its own file. Cost: each mesh of a format that may refer to
/// files is read to find their names. Fewer if the caller wants it to stop.
std::vector<SceneInput> inputs_of(const Scene& scene, const StopRequest& should_stop = {});

/// The same of a surface's rest shape, without its cache, and of a collider.
std::vector<SceneInput> inputs_of_shape(const Surface& surface, const SceneOrigin& origin,
                                        const StopRequest& should_stop = {});
std::vector<SceneInput> inputs_of_collider(const Collider& collider, const SceneOrigin& origin,
                                           const StopRequest& should_stop = {});

/// A scene's file and those that it includes, each once, existing or not, also if there is a
/// problem with them. `root` as in `load_scene`.
std::vector<std::filesystem::path> text_files_of(const std::filesystem::path& scene,
                                                 const std::filesystem::path& root,
                                                 const StopRequest& should_stop = {});

/// Whether two paths lead to the same file, existing or not.
bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Finds the files of a scene that an output would overwrite; fast enough for a million outputs.
class InputFinder {
 public:
  explicit InputFinder(const Scene& scene, const StopRequest& should_stop = {});

  const std::vector<SceneInput>& inputs() const { return inputs_; }

  /// The input that `output` is, directly or by a link of either kind; null: it is not an input.
  std::optional<std::filesystem::path> find(const std::filesystem::path& output) const;

 private:
  std::vector<SceneInput> inputs_;
  // By their device and number there, whatever their names are.
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::filesystem::path> there_;
  // Those that are not there, by their file names without folders.
  std::multimap<std::string, std::filesystem::path> missing_;
};

}  // namespace pliant
