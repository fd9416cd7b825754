#pragma once

#include "pliant/io/writer.hpp"

namespace pliant {

/// One Wavefront OBJ file a frame: positions (shortest text that reads back the same double),
/// texture coordinates and faces as in the source mesh.
Result<std::unique_ptr<AnimationWriter>> make_obj_writer(const AnimationPlan& plan);

}  // namespace pliant
