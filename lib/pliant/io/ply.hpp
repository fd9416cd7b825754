#pragma once

#include "pliant/io/writer.hpp"

namespace pliant {

/// One binary PLY file a frame, little endian: `double x y z` of each vertex, so every bit of a
/// position, and the faces as in the source mesh. With `double s t` when each vertex has just one
/// (u,v) over all its corners; PLY has no other place for (u,v) that programs agree on.
Result<std::unique_ptr<AnimationWriter>> make_ply_writer(const AnimationPlan& plan);

}  // namespace pliant
