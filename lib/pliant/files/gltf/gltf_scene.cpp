#include "pliant/files/gltf/gltf_scene.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "pliant/files/file_object.hpp"

namespace pliant::gltf {
namespace {

using Eigen::Matrix4d;

bool has_faces(const Document& document, const MeshEntry& mesh) {
  return std::ranges::any_of(mesh.primitives, [&](const Primitive& primitive) {
    return gltf::has_faces(document, primitive);
  });
}

// A fact of each mesh of the file: many nodes may have the same one.
template <class FactOf>
auto of_meshes(const Document& document, const FactOf& fact_of) {
  std::vector<decltype(fact_of(document.meshes[0]))> facts;
  for (const MeshEntry& mesh : document.meshes) facts.push_back(fact_of(mesh));
  return facts;
}

struct MeshSize {
  std::uint64_t vertices = 0, faces = 0;
};

std::string title_of(const Document& document, std::size_t number) {
  const std::string place = fmt::format("nodes[{}]", number);
  const std::string& name = document.nodes[number].name;
  return name == place ? place : place + " " + in_quotes(name);
}

// The nodes of a cycle, from the one that is its own child again.
tl::unexpected<Error> cycle_error(const Document& document, std::span<const std::size_t> cycle) {
  constexpr std::size_t most_told = 8;
  std::string text;
  for (const std::size_t node : cycle.first(std::min(cycle.size(), most_told)))
    text += title_of(document, node) + " > ";
  if (cycle.size() > most_told) text += "… > ";
  return invalid(
      fmt::format("the nodes of the file are in a cycle, each a child of the one before: "
                  "{}{}",
                  text, title_of(document, cycle.front())));
}

// Whether no node is within itself, whether the scene shows it or not. Depth first; a child on the
// way down to its parent closes a cycle.
Result<void> check_tree(const Document& document) {
  enum class State { New, OnWay, Done };
  std::vector<State> states(document.nodes.size(), State::New);
  std::vector<std::size_t> way, next_child;
  for (std::size_t start = 0; start < document.nodes.size(); ++start) {
    if (states[start] != State::New) continue;
    const auto enter = [&](std::size_t node) {
      states[node] = State::OnWay;
      way.push_back(node);
      next_child.push_back(0);
    };
    enter(start);
    while (!way.empty()) {
      const std::vector<std::size_t>& children = document.nodes[way.back()].children;
      if (next_child.back() == children.size()) {
        states[way.back()] = State::Done;
        way.pop_back();
        next_child.pop_back();
        continue;
      }
      const std::size_t child = children[next_child.back()++];
      if (states[child] == State::OnWay) {
        const auto first = std::find(way.begin(), way.end(), child) - way.begin();
        return cycle_error(document, std::span(way).subspan(static_cast<std::size_t>(first)));
      }
      if (states[child] == State::New) enter(child);
    }
  }
  return {};
}

// The listed roots of the scene, each once, that are not below another one: some exporters list all
// nodes.
std::vector<std::size_t> roots_of(const Document& document) {
  std::vector<bool> is_below(document.nodes.size());
  std::vector<std::size_t> open = document.roots;
  std::vector<bool> is_open(document.nodes.size());
  for (const std::size_t root : open) is_open[root] = true;
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    for (const std::size_t child : document.nodes[node].children) {
      is_below[child] = true;
      if (is_open[child]) continue;
      is_open[child] = true;
      open.push_back(child);
    }
  }
  std::vector<std::size_t> roots;
  for (const std::size_t root : document.roots) {
    if (!is_below[root]) roots.push_back(root);
    is_below[root] = true;
  }
  return roots;
}

constexpr std::uint64_t triangles = 4;  // the modes after it are strips and fans

}  // namespace

bool has_faces(const Document& document, const Primitive& primitive) {
  if (primitive.mode < triangles || !primitive.positions) return false;
  return document.accessors[primitive.indices.value_or(*primitive.positions)].count >= 3;
}

Result<std::vector<Object>> objects_of(const Document& document, const StopRequest& should_stop) {
  if (auto sound = check_tree(document); !sound) return fail(sound.error());
  struct Visit {
    std::size_t node;
    Matrix4d above;
  };
  const std::vector<bool> are_objects =
      of_meshes(document, [&](const MeshEntry& mesh) { return has_faces(document, mesh); });
  std::vector<Object> objects;
  std::vector<bool> is_seen(document.nodes.size());
  std::vector<Visit> visits;  // explicit stack: a file may be deeply nested
  StopPoll poll(should_stop);
  constexpr std::size_t parts_of_visit = 100;
  const auto visit = [&](std::span<const std::size_t> nodes,
                         const Matrix4d& above) -> Result<void> {
    for (std::size_t k = nodes.size(); k-- > 0;) {
      if (poll.after(parts_of_visit)) return interrupted();
      if (is_seen[nodes[k]]) {
        return invalid(fmt::format("{} is in the tree of the scene twice: a node has one parent",
                                   title_of(document, nodes[k])));
      }
      is_seen[nodes[k]] = true;
      visits.push_back({nodes[k], above});
    }
    return {};
  };
  if (auto begun = visit(roots_of(document), Matrix4d::Identity()); !begun)
    return fail(begun.error());
  while (!visits.empty()) {
    const auto [number, above] = visits.back();
    visits.pop_back();
    const Node& node = document.nodes[number];
    const Matrix4d to_file = above * node.to_parent;
    if (node.mesh && are_objects[*node.mesh]) objects.push_back({number, *node.mesh, to_file});
    if (auto more = visit(node.children, to_file); !more) return fail(more.error());
  }
  return objects;
}

std::vector<FileObject> listed(const Document& document, std::span<const Object> objects) {
  const std::vector<MeshSize> sizes = of_meshes(document, [&](const MeshEntry& mesh) {
    MeshSize size;
    // As Merger reads them: primitives with the same accessors share their vertices.
    std::set<std::tuple<std::size_t, std::optional<std::size_t>, std::optional<std::size_t>>> read;
    for (const Primitive& primitive : mesh.primitives) {
      if (!has_faces(document, primitive)) continue;
      const std::size_t positions = *primitive.positions;
      const std::uint64_t vertices = document.accessors[positions].count;
      const std::uint64_t corners =
          primitive.indices ? document.accessors[*primitive.indices].count : vertices;
      size.faces += primitive.mode == triangles ? corners / 3 : corners - 2;
      if (read.emplace(positions, primitive.normals, primitive.uvs[0]).second)
        size.vertices += vertices;
    }
    return size;
  });
  std::vector<FileObject> list;
  std::vector<std::string_view> meshes;
  for (const Object& object : objects) {
    const auto& [vertices, faces] = sizes[object.mesh];
    list.push_back(
        {.name = document.nodes[object.node].name, .vertices = vertices, .faces = faces});
    meshes.push_back(document.meshes[object.mesh].name);
  }
  set_choices(meshes, list);
  return list;
}

Result<Object> choose(const Document& document, std::span<const Object> objects,
                      const std::string& name) {
  std::vector<std::string_view> nodes, meshes;
  for (const Object& each : objects) {
    nodes.push_back(document.nodes[each.node].name);
    meshes.push_back(document.meshes[each.mesh].name);
  }
  const auto chosen = choose_object(nodes, meshes, name);
  if (!chosen) return fail(chosen.error());
  return objects[*chosen];
}

}  // namespace pliant::gltf
