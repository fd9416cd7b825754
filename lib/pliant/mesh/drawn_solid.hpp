#pragma once

#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// All that is nearer than `radius` to a box round the origin: a ball if the box has no length, a
/// capsule if it has one, else a box with round edges.
struct SolidLengths {
  Vector3d half = {0, 0, 0};  ///< of the box inside, >= 0: half of its lengths [length]
  double radius = 0;          ///< >= 0 [length]
};

/// The mesh of such a solid, whose vertices and faces stay the same while its lengths change.
/// Vertices lie on the solid, and faces are counter-clockwise seen from outside.
struct DrawnSolid {
  Mesh mesh;         ///< of the lengths it was made for, without (u,v)
  Field directions;  ///< #vertices x 3, of length 1 or 0: times the radius
  Field corners;     ///< #vertices x 3, -1, 0 or 1: times `half`

  /// #vertices x 3 for lengths that are 0 wherever those it was made for always are.
  Field positions(const SolidLengths& lengths) const;
};

DrawnSolid make_ball_mesh(double radius);
/// Its axis is along y.
DrawnSolid make_capsule_mesh(const SolidLengths& lengths);
DrawnSolid make_round_box_mesh(const SolidLengths& lengths);
/// With hard edges: 8 vertices. Its radius is 0.
DrawnSolid make_sharp_box_mesh(const Vector3d& half);

}  // namespace pliant
