#pragma once

#include <array>

#include "pliant/core/field.hpp"
#include "pliant/plate/energy/stencil_table.hpp"
#include "pliant/plate/plate_problem.hpp"

namespace pliant {

// The bending energy of a plate on the nodes of a rectangle, from which all that SPEC 9 adds to the
// plate comes: edges, uneven material, plasticity. docs/model.md, "One energy". Internal to plate.

/// The second difference along one direction at a node, as weights of the node before, of itself
/// and of the node after it. [1/uv^2]
template <class Real>
struct SecondDifference {
  Real before = 0, here = 0, after = 0;
  Real slope = 0;              ///< times the tangent of the edge, where the node is on one [1/uv]
  bool is_eliminated = false;  ///< across a pinned or free edge no moment acts: it is not there
};

/// The form of curvatures at a node: ½ (uu k_uu^2 + 2 coupling k_uu k_vv + vv k_vv^2), where those
/// that are eliminated have no part, and uv for k_uv^2. [1]
template <class Real>
struct Moduli {
  Real uu = 0, coupling = 0, vv = 0, uv = 0;
};

/// The energy of one plate, divided by hu hv. Refers to the system.
class PlateEnergy {
 public:
  explicit PlateEnergy(const PlateSystem& system) : system_(system) {}

  const Grid& grid() const { return system_.outline.grid(); }

  /// The node's share of area: 1, 1/2 on an edge, 1/4 at a corner.
  double share(int i, int j) const;

  /// The difference along u (v) at column i (row j).
  template <class Real>
  SecondDifference<Real> along_u(int i) const;
  template <class Real>
  SecondDifference<Real> along_v(int j) const;

  template <class Real>
  Moduli<Real> moduli(int i, int j) const;

  /// The cells' modulus for k_uv^2, with the cell's node of smallest u and v.
  template <class Real>
  Real cell_modulus(int i, int j) const;

  /// Columns (rows) of cells: one more across a seam.
  int cell_columns() const { return grid().columns - !grid().is_closed_u; }
  int cell_rows() const { return grid().rows - !grid().is_closed_v; }

  /// The Hessian of the energy on all nodes.
  template <class Real>
  StencilTable<Real> hessian() const;

  /// Its part by the tangents: what they add to the forces on the nodes. `forces` is #nodes x 3.
  void add_tangents(const EdgeTangents& tangents, Field& forces) const;

 private:
  const PlateSystem& system_;
};

/// The mass of each unknown for a density of 1 (#unknowns): its share of area times the factor of a
/// map. [1]
Eigen::VectorXd node_masses(const PlateSystem& system);

}  // namespace pliant
