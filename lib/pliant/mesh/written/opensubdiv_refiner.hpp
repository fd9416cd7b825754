#pragma once

#include "pliant/mesh/written/subdivide.hpp"

namespace pliant {

/// `subdivide` in a build with OpenSubdiv. Requires: `check_subdivision` accepts the cage;
/// OpenSubdiv would print what that refuses. Errors: a cage that OpenSubdiv's validation refuses;
/// Interrupted.
Result<SubdividedMesh> refined_by_opensubdiv(const Mesh& mesh, const TriangleSurface& surface,
                                             const Subdivision& subdivision,
                                             const StopRequest& should_stop);

}  // namespace pliant
