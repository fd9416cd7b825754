#pragma once

#include <memory>

#include "pliant/output/surface_writer.hpp"

namespace pliant {

/// One binary PLY file per frame, little-endian: `double x y z` of each vertex, so every bit of a
/// position, and the faces as in the source mesh. With `float nx ny nz` if the mesh defines which
/// corners share a normal and each vertex has only one. With `double s t` if each vertex has only
/// one (u,v) over all its corners; otherwise each face has a list `texcoord` of u v u v …, which
/// fewer programs support. PLY cannot store materials and groups.
Result<std::unique_ptr<SurfaceWriter>> make_ply_writer(const SurfacePlan& plan);

}  // namespace pliant
