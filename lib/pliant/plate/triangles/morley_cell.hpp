#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "pliant/core/triangle_cells.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

// The Morley triangle: bending energy of a cell from the displacements at its corners and the
// slopes across its sides. docs/model.md, "Surfaces". Sources: Morley, The triangular equilibrium
// element (1968); Arnold & Brezzi, Mixed and nonconforming finite element methods (1985).

/// The quadratic form of curvatures in the energy: uu H_uu^2 + vv H_vv^2 + 2 coupling H_uu H_vv +
/// uv H_uv^2. [b length^4/uv^4]
struct Bending {
  double uu = 1;
  double vv = 1;
  double coupling = 0;
  double uv = 2;
  bool is_free = false;  ///< has a free edge: the coupling is by Poisson's ratio

  friend bool operator==(const Bending&, const Bending&) = default;
};

/// The form for b, c, d with lengths `unit` along u and v, and for Poisson's ratio `poisson`. None:
/// the plate has no free edge, so that the ratio has no effect in the limit; then the form is
/// positive for every elliptic stiffness.
Bending bending_of(const Stiffness& stiffness, const std::array<double, 2>& unit,
                   std::optional<double> poisson = {});

/// The form where b, c and d are that many times those of `bending`, with the same ratio or,
/// without a free edge, the one of these.
Bending scaled(const Bending& bending, double b, double c, double d);

/// H_uu, H_vv and H_uv of a cell. [1/length]
using Curvature = std::array<double, 3>;

/// An unknown of a plate as one of a cell's displacements and slopes.
struct CellUnknown {
  int index;    ///< of the plate: the free points, then the slopes
  double sign;  ///< -1 or 1
  int value;    ///< 0 to 2: a corner's displacement; 3 to 5: a side's slope
};

/// Calls f(unknown) for the unknowns of a cell. A slope may be a sum of several.
template <class F>
void for_each_unknown(const TriangleCells& cells, const TriangleCell& cell, const F& f) {
  for (int k = 0; k < 3; ++k) {
    if (cell.points[k] < cells.free_points) f(CellUnknown{cell.points[k], 1, k});
  }
  for (int k = 0; k < 3; ++k) {
    const SideSlope& slope = cell.slopes[k];
    for (int n = 0; n < slope.count; ++n) {
      f(CellUnknown{cells.free_points + slope.first + n, slope.sign, 3 + k});
    }
  }
}

/// The geometry of a cell. A, l_k and n_k are its area, the lengths of its sides and their outward
/// unit normals in the plane.
struct MorleyCell {
  double area;
  std::array<std::array<double, 2>, 3> normals;  ///< n_k
  std::array<Curvature, 3> by_slope;             ///< dH/d theta_k = l_k/A n_k n_k^T [1/length]
  std::array<std::array<double, 2>, 3> hats;     ///< gradients of the linear hats [1/length]

  explicit MorleyCell(const FlatTriangle& shape);

  /// How the curvature depends on the displacement of each corner. [1/length^2]
  std::array<Curvature, 3> by_corner() const;

  /// How it depends on the three displacements, then on the three slopes.
  std::array<Curvature, 6> by_value() const {
    const std::array<Curvature, 3> of_corners = by_corner();
    return {of_corners[0], of_corners[1], of_corners[2], by_slope[0], by_slope[1], by_slope[2]};
  }

  /// The outward slope at a side for prescribed slopes along -u, +u, -v and +v [1].
  double given_slope(int side, const std::array<double, 4>& slopes) const {
    const auto [x, y] = normals[side];
    return x * x * (x > 0 ? slopes[1] : -slopes[0]) + y * y * (y > 0 ? slopes[3] : -slopes[2]);
  }
};

/// The moments C H of a curvature.
inline Curvature moments(const Bending& bending, const Curvature& h) {
  return {bending.uu * h[0] + bending.coupling * h[1], bending.coupling * h[0] + bending.vv * h[1],
          bending.uv * h[2]};
}

}  // namespace pliant
