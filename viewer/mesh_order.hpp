#pragma once

#include <cstdint>
#include <vector>

#include "pliant/mesh/mesh.hpp"

namespace pliant::viewer {

/// The three vertices of each triangle of the faces.
std::vector<std::uint32_t> triangle_vertices(const Mesh& mesh);

/// Vertices in the order of their nodes, those without one first, so that neighbours in a row of
/// the grid are next to each other.
std::vector<int> node_order(const std::vector<int>& vertex_nodes);

}  // namespace pliant::viewer
