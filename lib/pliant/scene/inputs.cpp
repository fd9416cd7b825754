#include "pliant/scene/inputs.hpp"

#include <set>
#include <utility>
#include <variant>

#include "pliant/mesh/read_mesh.hpp"

namespace pliant {

std::vector<SceneInput> inputs_of(const Scene& scene) {
  std::vector<SceneInput> inputs;
  std::set<std::filesystem::path> seen;
  const auto add = [&](std::filesystem::path file, std::string_view role) {
    const bool is_new = seen.insert(file).second;
    if (is_new) inputs.push_back({std::move(file), role});
    return is_new;
  };
  if (!scene.origin.file.empty()) add(scene.origin.file, "the scene");
  for (const Surface& surface : scene.surfaces) {
    if (surface.is_animated()) add(surface.cache.path, "a cache of the scene");
    for (const MaterialMap& map : surface.maps) {
      if (!map.file.empty()) add(map.file, "a map of the scene");
    }
    const auto* const mesh = std::get_if<MeshFile>(&surface.shape);
    if (!mesh || !add(mesh->path, "a mesh of the scene")) continue;
    for (auto& file : mesh_references(mesh->path, mesh->root))
      add(std::move(file), "a file that a mesh of the scene refers to");
  }
  return inputs;
}

}  // namespace pliant
