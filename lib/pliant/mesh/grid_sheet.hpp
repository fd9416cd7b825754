#pragma once

#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// A flat sheet in the xz-plane, centred on the origin, +y up; u increases with x and v with z over
/// [0,1].
struct GridSheet {
  int columns = 3;         ///< vertices along u, >= 3
  int rows = 3;            ///< vertices along v, >= 3
  double width = 1;        ///< along x [length], > 0
  double depth = 1;        ///< along z [length], > 0
  bool triangles = false;  ///< split each quad in two

  friend bool operator==(const GridSheet&, const GridSheet&) = default;
};

/// The sheet's mesh: vertex j*columns + i is node (i,j), faces are counter-clockwise seen from +y.
/// Requires: columns, rows >= 3; width, depth > 0.
Mesh make_mesh(const GridSheet& sheet);

/// The same. Errors: Interrupted.
Result<Mesh> make_mesh(const GridSheet& sheet, const StopRequest& should_stop);

}  // namespace pliant
