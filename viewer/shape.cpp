#include "viewer/shape.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/core/stoppable_sort.hpp"
#include "viewer/mesh_order.hpp"

namespace pliant::viewer {
namespace {

// Both ends of each edge of the faces, each edge once. Unfinished if it is stopped.
std::vector<std::uint32_t> edge_vertices(const Mesh& mesh, StopPoll& poll) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::size_t first = 0;
  for (const int size : mesh.face_sizes) {
    if (poll.after(4 * static_cast<std::size_t>(size))) return {};
    for (int k = 0; k < size; ++k) {
      const auto [low, high] = std::minmax(mesh.corner_vertices[first + k],
                                           mesh.corner_vertices[first + (k + 1) % size]);
      edges.emplace_back(low, high);
    }
    first += size;
  }
  if (!sort_unless_stopped(edges, poll)) return {};
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::uint32_t> vertices;
  for (const auto& [low, high] : edges) vertices.insert(vertices.end(), {low, high});
  return vertices;
}

// (u,v) of each vertex, from its first corner; 0 if it has none.
std::vector<float> vertex_uvs(const Mesh& mesh) {
  std::vector<float> uvs(2 * static_cast<std::size_t>(mesh.vertex_count()), 0);
  for (std::size_t corner = mesh.corner_vertices.size(); corner-- > 0;) {
    const int uv = mesh.corner_uvs[corner];
    if (uv < 0) continue;
    for (std::size_t k = 0; k < 2; ++k) {
      uvs[2 * static_cast<std::size_t>(mesh.corner_vertices[corner]) + k] =
          static_cast<float>(mesh.uvs[uv][k]);
    }
  }
  return uvs;
}

std::vector<float> relative_rest(const Mesh& mesh, const Vector3d& origin) {
  std::vector<float> numbers;
  numbers.reserve(3 * static_cast<std::size_t>(mesh.vertex_count()));
  for (Eigen::Index row = 0; row < mesh.positions.rows(); ++row) {
    for (int k = 0; k < 3; ++k)
      numbers.push_back(static_cast<float>(mesh.positions(row, k) - origin[k]));
  }
  return numbers;
}

// A vertex of each held node.
std::vector<std::uint32_t> held_vertices(const RestShape& shape) {
  std::vector<std::uint32_t> held;
  const std::vector<int> vertices = node_vertices(shape);
  for (std::size_t node = 0; node < vertices.size(); ++node) {
    if ((*shape.held)[node] != 0 && vertices[node] >= 0)
      held.push_back(static_cast<std::uint32_t>(vertices[node]));
  }
  return held;
}

}  // namespace

Result<Json> shape_json(const RestShape& shape, Arrays& arrays, const StopRequest& should_stop) {
  const Mesh& mesh = shape.mesh;
  const Vector3d low = mesh.positions.colwise().minCoeff();
  const Vector3d high = mesh.positions.colwise().maxCoeff();
  const Vector3d origin = 0.5 * low + 0.5 * high;
  StopPoll poll(should_stop);
  const std::vector<std::uint32_t> edges = edge_vertices(mesh, poll);
  if (poll.after(0)) return interrupted();
  Json json = {{"vertices", mesh.vertex_count()},
               {"columns", shape.grid ? shape.grid->columns : static_cast<int>(shape.rest.rows())},
               {"rows", shape.grid ? shape.grid->rows : 1},
               {"origin", to_json(origin)},
               {"rest", arrays.add(relative_rest(mesh, origin))},
               {"uvs", arrays.add(vertex_uvs(mesh))},
               {"nodes", arrays.add(shape.vertex_nodes)},
               {"triangles", arrays.add(triangle_vertices(mesh))},
               {"edges", arrays.add(edges)}};
  if (shape.grid && !shape.grid->is_open()) json["wrap"] = wrap_word(*shape.grid);
  if (shape.held) json["pins"] = arrays.add(held_vertices(shape));
  return json;
}

std::vector<std::uint32_t> touching_vertices(std::span<const ContactFacts> contacts,
                                             const std::vector<int>& node_vertices) {
  std::vector<std::uint32_t> vertices;
  for (const ContactFacts& facts : contacts) {
    for (const int node : facts.nodes) {
      const int vertex = node_vertices[static_cast<std::size_t>(node)];
      if (vertex >= 0) vertices.push_back(static_cast<std::uint32_t>(vertex));
    }
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

Json messages_of(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  Json messages = Json::array();
  const auto add = [&](std::string_view kind, const ScenePlace& place, const std::string& text) {
    Json message = {{"kind", kind}, {"line", place.line}, {"text", text}};
    if (place.file != scene.origin.file)
      message["file"] = std::filesystem::path(place.file).filename().string();
    messages.push_back(std::move(message));
  };
  for (const SceneNote& note : scene.notes) {
    add("note", {note, note.file}, note.message);
  }
  for (const Warning& warning : simulation.warnings()) {
    const ScenePlace place = place_of(warning, scene.origin);
    add("warning", place, place.told(warning.message()));
  }
  return messages;
}

}  // namespace pliant::viewer
