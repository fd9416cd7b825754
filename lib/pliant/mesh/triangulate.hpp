#pragma once

#include <array>
#include <vector>

#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// The triangles of each face, as indices of its corners counted over the whole mesh: all of face 0
/// first, size - 2 of each face, turning as the face does. Ears are cut from the second corner on,
/// so that a convex face becomes a fan around its first one; a face that is not convex, seen along
/// its mean normal at rest, is cut where it is. Faces that cross themselves become a fan.
std::vector<std::array<int, 3>> triangulate(const Mesh& mesh);

}  // namespace pliant
