#pragma once

#include <span>

#include "pliant/feedback/surface_lines.hpp"
#include "pliant/region/triangles/triangle_cut.hpp"

namespace pliant {

/// The outline of a patch, between nodes of the surface: sides of one cell that are held. Closed,
/// unless a border is free.
SurfaceLines outline_of(const TrianglePatch& patch, const LevelSet& level_set);

/// The outline, always closed, of the part of a region where a function is positive that is given
/// on the nodes of the level set and linear on each triangle.
SurfaceLines outline_of(std::span<const TrianglePatch> patches, const LevelSet& level_set,
                        std::span<const double> at_nodes);

}  // namespace pliant
