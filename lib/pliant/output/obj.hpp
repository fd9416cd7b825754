#pragma once

#include <memory>

#include "pliant/output/surface_writer.hpp"

namespace pliant {

/// One Wavefront OBJ file per frame, written by `ObjText`. Errors: Unwritable.
Result<std::unique_ptr<SurfaceWriter>> make_obj_writer(const SurfacePlan& plan);

}  // namespace pliant
