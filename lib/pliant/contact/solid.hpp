#pragma once

#include <memory>
#include <variant>

#include "pliant/contact/solid_mesh.hpp"
#include "pliant/core/field.hpp"

namespace pliant {

// Solids that surfaces meet, in their own frames: pure functions of a place. Scales are taken up by
// their lengths. docs/model.md, "Contact".

/// A ball round the origin.
struct SphereSolid {
  double radius = 1;  ///< > 0 [length]

  friend bool operator==(const SphereSolid&, const SphereSolid&) = default;
};

/// What is nearer than `radius` to an axis along y, with the origin in its middle.
struct CapsuleSolid {
  double radius = 0.5;  ///< > 0 [length]
  double length = 1;    ///< of the axis, >= 0 [length]

  friend bool operator==(const CapsuleSolid&, const CapsuleSolid&) = default;
};

/// A box round the origin with round edges.
struct BoxSolid {
  Vector3d size = {1, 1, 1};  ///< > 0 [length]
  double round = 0;           ///< of its edges, 0 to half of the least size [length]

  friend bool operator==(const BoxSolid&, const BoxSolid&) = default;
};

/// All that is not above the plane y = 0.
struct PlaneSolid {
  friend bool operator==(const PlaneSolid&, const PlaneSolid&) = default;
};

/// What a closed mesh encloses. It need not be convex.
struct MeshSolid {
  std::shared_ptr<const PosedMesh> posed;

  friend bool operator==(const MeshSolid& a, const MeshSolid& b) {
    return a.posed == b.posed || (a.posed->shared_mesh() == b.posed->shared_mesh() &&
                                  are_equal(a.posed->points(), b.posed->points()));
  }
};

using Solid = std::variant<SphereSolid, CapsuleSolid, BoxSolid, PlaneSolid, MeshSolid>;

/// How near a place is to a solid.
struct Nearness {
  double distance = 0;          ///< signed: < 0 inside [length]
  Vector3d normal = {0, 1, 0};  ///< its gradient, of length 1
};

/// Where the gradient is not unique, it is +y at a sphere's centre, +x on a capsule's axis, and
/// that of the face of least depth inside a box (x before y before z, + before -), and that by the
/// first of the triangles that are equally close of a mesh. Requires: x is finite.
Nearness nearness(const Solid& solid, const Vector3d& x);

/// The support function: the largest n . y of the solid's places y; of a plane for n = +y.
/// [length]
double support(const Solid& solid, const Vector3d& n);

/// The solid between two of one kind, each length (1 - t) of one and t of the other, and each point
/// of a mesh. The support of what is no mesh is then as much of theirs in each direction.
Solid between(const Solid& one, const Solid& other, double t);

/// No place of the solid is farther from the origin. Infinite for a plane. [length]
double reach(const Solid& solid);

/// Of the largest ball inside it, infinite for a plane; of a mesh half the least side of the box
/// around it, along the axes of its frame, which is no less. [length]
double inner_radius(const Solid& solid);

/// The least radius of its curvature, infinite for a plane, 0 for a box with sharp edges or a mesh.
/// [length]
double least_radius(const Solid& solid);

}  // namespace pliant
