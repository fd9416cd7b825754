#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"

namespace pliant::viewer {

/// Some vertices of a mesh, with triangles between them.
struct CoarseMesh {
  std::vector<int> vertices;             ///< of the mesh, in its order
  std::vector<std::uint32_t> triangles;  ///< three each, as indices of `vertices`
};

/// A mesh of at most `most_vertices` vertices in the place of a finer one: space is divided into
/// even cubes, the vertex nearest to the middle of those in a cube stands for all of them, and the
/// triangles between three cubes stay. Source: Rossignac and Borrel, Multi-resolution 3D
/// approximations for rendering complex scenes (1993).
///
/// `positions`: #vertices x 3, finite. `triangles`: three vertices each. Requires: most_vertices >=
/// 8.
CoarseMesh coarse_mesh(const Field& positions, std::span<const std::uint32_t> triangles,
                       int most_vertices);

}  // namespace pliant::viewer
