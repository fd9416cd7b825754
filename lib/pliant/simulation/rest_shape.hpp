#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A surface as it is before anything acts on it.
struct RestShape {
  std::string name;  ///< of the surface
  Mesh mesh;
  GridMapping mapping;
};

/// Makes or reads a surface's mesh and finds its grid. Errors: those of `read_obj` and
/// `check_mesh`; what `find_grid` finds, at the surface's line in the scene; a kind of file that is
/// not read.
Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin);

}  // namespace pliant
