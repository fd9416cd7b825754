#pragma once

#include <optional>

#include "pliant/core/field.hpp"

namespace pliant {

// The plate equation on one patch of nodes: thesis 4.2, eq. 8; SPEC 2 to 4; docs/model.md.
//
//   b w_uuuu + c w_uuvv + d w_vvvv + g w + rho w_tt + eta w_t = F                               (1)
//
// w is the displacement (or the position itself, SPEC 2), one column for each of x, y, z. Here a
// `Grid` is the smallest one around a patch and its rim, and an `Outline` says which of its nodes
// are the unknowns.

/// b, c and d of (1): along u, mixed, along v. [1]
struct Stiffness {
  double b = 1;
  double c = 2;
  double d = 1;

  /// The bound that c must exceed: -2 sqrt(b d). Requires: b, d >= 0.
  double least_c() const;

  /// Whether (1) is well posed: b > 0, d > 0, c > least_c(). docs/model.md, eq. (2).
  bool is_elliptic() const;

  friend bool operator==(const Stiffness&, const Stiffness&) = default;
};

/// Inertia and drag of the plate.
struct Dynamics {
  double density = 1;  ///< rho >= 0
  double damping = 1;  ///< eta >= 0

  /// The factors of v and w in a step of backward Euler, docs/model.md, eq. (8): rho/dt and
  /// rho/dt^2 + eta/dt. Requires: dt > 0.
  double inertia(double dt) const { return density / dt; }
  double shift(double dt) const { return (inertia(dt) + damping) / dt; }
};

/// Slopes prescribed on the rim: dw/du on the edges of smallest and largest u, dw/dv on those of
/// smallest and largest v. [length/uv]
struct EdgeTangents {
  Vector3d su0 = {0, 0, 0};
  Vector3d su1 = {0, 0, 0};
  Vector3d sv0 = {0, 0, 0};
  Vector3d sv1 = {0, 0, 0};

  friend bool operator==(const EdgeTangents&, const EdgeTangents&) = default;

  bool are_zero() const { return su0.isZero(0) && su1.isZero(0) && sv0.isZero(0) && sv1.isZero(0); }
};

/// Plastic curvatures, one row for each node or triangle: uu in x, y, z, then vv, then uv.
using PlasticField = Eigen::Matrix<double, Eigen::Dynamic, 9>;

/// When a plate bends for good. SPEC 9; docs/model.md, "Plasticity".
struct PlasticLaw {
  double yield = 0;      ///< Y, the norm of the stress from which on it flows, > 0 [length/uv^2]
  double hardening = 0;  ///< H >= 0, kinematic [1]

  friend bool operator==(const PlasticLaw&, const PlasticLaw&) = default;
};

/// Displacement and velocity of a plate. On a grid: of all nodes of its outline's grid, rim
/// included, row = grid.node(i, j). On triangles: displacement of all points, velocity of those
/// with a mass.
struct PlateState {
  Field displacement;  ///< #nodes or #points x 3 [length]
  Field velocity;      ///< #nodes or #masses x 3 [length/s]
  /// Of a plate that yields: #nodes x 9 [length/uv^2], or #triangles x 9, those of H [1/length].
  PlasticField plastic = {};
};

class StepContact;

/// What moves a plate over one interval: all that stays the same while its steps run, but for the
/// plate itself. SPEC 4.
struct PlateInterval {
  Dynamics dynamics;
  EdgeTangents tangents;  ///< on triangles, along -u, +u, -v and +v [1]
  /// #nodes x 3, rim rows are not read [length/uv^4]; on triangles #masses x 3, integrated over the
  /// plate [length b length^2/uv^4]
  Field load;

  std::optional<PlasticLaw> law = {};  ///< of a plate that yields; nullopt: it is elastic

  /// What it meets on its way; null: nothing. Not for exact steps, nor for a plate that yields.
  StepContact* contact = nullptr;

  /// What load and tangents change from, evenly over the interval; only for `Integrator::Exact`.
  Field first_load = {};
  EdgeTangents first_tangents = {};
};

}  // namespace pliant
