#pragma once

#include <array>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// The triangles of each face, as indices of its corners counted over the whole mesh: first all of
/// face 0, size - 2 per face, with the orientation of the face. Ears are cut from the second corner
/// on, so that a convex face becomes a fan around its first corner; a face that is not convex, as
/// projected along its mean normal at rest, is cut at its ears, or from side to side if it has more
/// than 32 corners. Faces that intersect themselves become a fan. Cost: O(#corners log #corners).
std::vector<std::array<int, 3>> triangulate(const Mesh& mesh);

/// The same; incomplete if `poll` says to end.
std::vector<std::array<int, 3>> triangulate(const Mesh& mesh, StopPoll& poll);

}  // namespace pliant
