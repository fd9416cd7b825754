#include "pliant/mesh/gltf_scene.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/mesh/file_object.hpp"

namespace pliant::gltf {
namespace {

using Eigen::Matrix4d;

std::vector<std::size_t> primitives_with_faces(const Document& document, const MeshEntry& mesh) {
  std::vector<std::size_t> primitives;
  for (std::size_t k = 0; k < mesh.primitives.size(); ++k)
    if (has_faces(document, mesh.primitives[k])) primitives.push_back(k);
  return primitives;
}

}  // namespace

bool has_faces(const Document& document, const Primitive& primitive) {
  constexpr std::uint64_t triangles = 4;  // and all modes after it
  if (primitive.mode < triangles || !primitive.positions) return false;
  return document.accessors[primitive.indices.value_or(*primitive.positions)].count >= 3;
}

Result<std::vector<Object>> objects_of(const Document& document) {
  struct Visit {
    std::size_t node;
    Matrix4d above;
  };
  std::vector<Object> objects;
  std::vector<bool> is_seen(document.nodes.size());
  std::vector<Visit> visits;  // explicit stack: a file may be deeply nested
  for (std::size_t k = document.roots.size(); k-- > 0;)
    visits.push_back({document.roots[k], Matrix4d::Identity()});
  while (!visits.empty()) {
    const auto [number, above] = visits.back();
    visits.pop_back();
    if (is_seen[number]) {
      return fail(ErrorCode::InvalidInput,
                  fmt::format("nodes[{}] is in the tree of the scene twice", number));
    }
    is_seen[number] = true;
    const Node& node = document.nodes[number];
    const Matrix4d to_file = above * node.to_parent;
    if (node.mesh) {
      const MeshEntry& mesh = document.meshes[*node.mesh];
      if (auto primitives = primitives_with_faces(document, mesh); !primitives.empty())
        objects.push_back({node.name, mesh.name, to_file, *node.mesh, std::move(primitives)});
    }
    for (std::size_t k = node.children.size(); k-- > 0;)
      visits.push_back({node.children[k], to_file});
  }
  return objects;
}

Result<Object> choose(std::vector<Object> objects, const std::string& name) {
  std::vector<std::string> nodes, meshes;
  for (const Object& each : objects) {
    nodes.push_back(each.node_name);
    meshes.push_back(each.mesh_name);
  }
  const auto chosen = choose_node(nodes, meshes, name);
  if (!chosen) return fail(chosen.error());
  return std::move(objects[*chosen]);
}

}  // namespace pliant::gltf
