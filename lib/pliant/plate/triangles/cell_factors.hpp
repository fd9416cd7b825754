#pragma once

#include <cmath>
#include <vector>

#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/triangles/morley_cell.hpp"

namespace pliant {

/// Factors by which the material of a plate of triangles differs from place to place; an empty one
/// is 1 everywhere. docs/model.md, "Maps".
struct CellFactors {
  std::vector<double> density, damping;  ///< #masses
  std::vector<double> b, c, d;           ///< #cells; equal for those of one triangle
  std::vector<double> yield, hardening;  ///< of `TrianglePlate::triangles`

  /// Whether an elastic plate has some of them.
  bool are_elastic() const {
    return !density.empty() || !damping.empty() || !b.empty() || !c.empty() || !d.empty();
  }

  /// The form of a cell for that of the whole plate.
  Bending of_cell(const Bending& bending, int cell) const {
    const double of_b = factor_at(b, cell), of_d = factor_at(d, cell);
    const double coupling = bending.coupling * std::sqrt(of_b * of_d);
    const double mixed = (bending.uv + 2 * bending.coupling) * factor_at(c, cell);
    return {bending.uu * of_b, bending.vv * of_d, coupling, mixed - 2 * coupling};
  }

  friend bool operator==(const CellFactors&, const CellFactors&) = default;
};

/// The form of a cell; `factors` null: that of the whole plate.
inline Bending bending_at(const Bending& bending, const CellFactors* factors, int cell) {
  return factors && factors->are_elastic() ? factors->of_cell(bending, cell) : bending;
}

}  // namespace pliant
