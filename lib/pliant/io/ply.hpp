#pragma once

#include <memory>

#include "pliant/io/surface_writer.hpp"

namespace pliant {

/// One binary PLY file a frame, little endian: `double x y z` of each vertex, so every bit of a
/// position, and the faces as in the source mesh. With `float nx ny nz` when the mesh says who
/// shares a normal and each vertex has just one over all its corners. With `double s t` when each
/// vertex has just one (u,v) over all its corners; otherwise each face has a list `texcoord` of u v
/// u v …, which fewer programs know. Materials and groups have no place in PLY.
Result<std::unique_ptr<SurfaceWriter>> make_ply_writer(const SurfacePlan& plan);

}  // namespace pliant
