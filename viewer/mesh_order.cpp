#include "viewer/mesh_order.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "pliant/mesh/triangles/triangulate.hpp"

namespace pliant::viewer {

std::vector<std::uint32_t> triangle_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> vertices;
  for (const std::array<int, 3>& triangle : triangulate(mesh)) {
    for (const int corner : triangle) {
      vertices.push_back(static_cast<std::uint32_t>(mesh.corner_vertices[corner]));
    }
  }
  return vertices;
}

std::vector<int> node_order(const std::vector<int>& vertex_nodes) {
  std::vector<int> order(vertex_nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return vertex_nodes[a] < vertex_nodes[b]; });
  return order;
}

}  // namespace pliant::viewer
