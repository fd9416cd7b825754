#pragma once

#include <array>
#include <optional>

#include "pliant/core/field.hpp"
#include "pliant/core/triangle_cells.hpp"

namespace pliant {

/// The (u,v) of a triangle's corners; none: a corner has none. [uv]
using TriangleUvs = std::optional<std::array<std::array<double, 2>, 3>>;

/// Lays a triangle flat. u follows `axis`; without one, the derivative of the position by u, and v
/// lies to the side of the derivative by v. A triangle with almost no height gets edges that are a
/// little longer (Sharp & Crane, A Laplacian for Nonmanifold Triangle Meshes, 2020), and u follows
/// the longest. Internal to mesh.
FlatTriangle flattened(const std::array<Vector3d, 3>& corners, const TriangleUvs& uvs,
                       const std::optional<Vector3d>& axis);

}  // namespace pliant
