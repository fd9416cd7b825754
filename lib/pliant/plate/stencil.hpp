#pragma once

#include <cstddef>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// L w = b w_uuuu + c w_uuvv + d w_vvvv by second-order central differences on 13 nodes, with
/// coefficients and sums in numbers of type `Real`. The only place where the differences are
/// written. Thesis 4.3; SPEC 4; docs/model.md, eq. (4) and (5).
template <class Real>
struct Stencil {
  Stencil(const Grid& grid, const Stiffness& stiffness) {
    const Real hu = grid.hu;
    const Real hv = grid.hv;
    b = stiffness.b / (hu * hu * hu * hu);
    c = stiffness.c / (hu * hu * hv * hv);
    d = stiffness.d / (hv * hv * hv * hv);
  }

  /// L w at a node. near(di, dj) is w at the node itself and its eight neighbours, that many
  /// columns and rows away; far(di, dj) at the four nodes two steps away, or at their ghosts.
  template <class Near, class Far>
  Real apply(const Near& near, const Far& far) const {
    const Real here = near(0, 0);
    const Real below = near(0, -1), above = near(0, 1);
    const Real beside_u = near(-1, 0) + near(1, 0);
    const Real beside_v = below + above;
    const Real corners = near(-1, -1) + near(1, -1) + near(-1, 1) + near(1, 1);
    // Eq. (4): (1 -4 6 -4 1) along each direction. Eq. (5): (1 -2 1) x (1 -2 1) mixed.
    const Real uuuu = (far(-2, 0) + far(2, 0)) - 4 * beside_u + 6 * here;
    const Real uuvv = corners - 2 * (beside_u + below + above) + 4 * here;
    const Real vvvv = (far(0, -2) + far(0, 2)) - 4 * beside_v + 6 * here;
    return b * uuuu + c * uuvv + d * vvvv;
  }

  Real b, c, d;  ///< the stiffness including the divisors: b/hu^4, c/(hu^2 hv^2), d/hv^4
};

/// The stencil of shift + L gathered by neighbour, without what the rim adds: eq. (4), (5), (7).
struct StencilWeights {
  StencilWeights(const Grid& grid, const Stiffness& stiffness, double shift) {
    const Stencil<double> stencil(grid, stiffness);
    two_u = stencil.b;
    corner = stencil.c;
    two_v = stencil.d;
    centre = shift + 6 * two_u + 4 * corner + 6 * two_v;
    beside_u = -4 * two_u - 2 * corner;
    beside_v = -2 * corner - 4 * two_v;
  }

  /// shift w + L w at a node. at(di, dj) is w that many columns and rows away, 0 at ghosts.
  template <class At>
  double apply(const At& at) const {
    return centre * at(0, 0) + beside_u * (at(-1, 0) + at(1, 0)) +
           beside_v * (at(0, -1) + at(0, 1)) +
           corner * ((at(-1, -1) + at(1, -1)) + (at(-1, 1) + at(1, 1))) +
           two_u * (at(-2, 0) + at(2, 0)) + two_v * (at(0, -2) + at(0, 2));
  }

  /// What ghosts add to the centre: how many mirror the node along u and along v.
  double ghosts(int along_u, int along_v) const { return two_u * along_u + two_v * along_v; }

  double centre, beside_u, beside_v;
  double corner;  ///< of the four diagonal neighbours
  double two_u;   ///< of those two steps away; a rim beside the node adds it to the centre
  double two_v;
};

/// Whether the node two steps away from interior node (i,j) is a ghost: the one between is rim. It
/// is then (i,j) itself, mirrored, even if another node of the grid is there, and outside the grid
/// has the term of `EdgeGhosts` too. docs/model.md, eq. (12).
inline bool is_ghost(const Outline& outline, int i, int j, int di, int dj) {
  return !outline.holds(i + di / 2, j + dj / 2);
}

/// What the tangents add to ghosts outside a grid, in one component: the slope times two spacings.
/// docs/model.md, eq. (6).
class EdgeGhosts {
 public:
  EdgeGhosts(const Grid& grid, const EdgeTangents& tangents, int component)
      : columns_(grid.columns),
        rows_(grid.rows),
        u0_(grid.is_closed_u ? 0 : -2 * grid.hu * tangents.su0[component]),
        u1_(grid.is_closed_u ? 0 : 2 * grid.hu * tangents.su1[component]),
        v0_(grid.is_closed_v ? 0 : -2 * grid.hv * tangents.sv0[component]),
        v1_(grid.is_closed_v ? 0 : 2 * grid.hv * tangents.sv1[component]) {}

  /// At column i and row j; 0 inside the grid, and beyond it along a closed direction.
  double at(int i, int j) const {
    if (i < 0) return u0_;
    if (i >= columns_) return u1_;
    if (j < 0) return v0_;
    return j >= rows_ ? v1_ : 0;
  }

 private:
  int columns_, rows_;
  double u0_, u1_, v0_, v1_;
};

}  // namespace pliant
