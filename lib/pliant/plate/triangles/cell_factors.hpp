#pragma once

#include <vector>

#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/triangles/morley_cell.hpp"

namespace pliant {

/// Factors by which the material of a plate of triangles differs from place to place; an empty one
/// is 1 everywhere. docs/model.md, "Maps".
struct CellFactors {
  std::vector<double> density, damping, goal;  ///< #masses
  std::vector<double> b, c, d;                 ///< #cells; equal for those of one triangle
  std::vector<double> yield, hardening;        ///< of `TrianglePlate::triangles`

  /// Whether an elastic plate has some of them.
  bool are_elastic() const {
    return !density.empty() || !damping.empty() || !goal.empty() || !b.empty() || !c.empty() ||
           !d.empty();
  }

  /// The form of a cell for that of the whole plate.
  Bending of_cell(const Bending& bending, int cell) const {
    return scaled(bending, factor_at(b, cell), factor_at(c, cell), factor_at(d, cell));
  }

  friend bool operator==(const CellFactors&, const CellFactors&) = default;
};

/// The form of a cell; `factors` null: that of the whole plate.
inline Bending bending_at(const Bending& bending, const CellFactors* factors, int cell) {
  return factors && factors->are_elastic() ? factors->of_cell(bending, cell) : bending;
}

}  // namespace pliant
