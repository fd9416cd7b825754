#pragma once

#include <cstddef>

#include "pliant/plate/operator.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {

// `assemble_upper` and `residual` of a system that has an interior mask. Internal to plate.

/// The weights of a node and of its neighbours, eq. (4) and (5) gathered, without the weights that
/// the rim adds.
struct StencilWeights {
  explicit StencilWeights(const PlateSystem& system) {
    const Stiffness scaled = scaled_stiffness(system.grid, system.stiffness);
    two_u = scaled.b;
    corner = scaled.c;
    two_v = scaled.d;
    centre = system.shift + 6 * two_u + 4 * corner + 6 * two_v;
    beside_u = -4 * two_u - 2 * corner;
    beside_v = -2 * corner - 4 * two_v;
  }

  double centre, beside_u, beside_v;
  double corner;  ///< of the four diagonal neighbours
  double two_u;   ///< of those two steps away; a rim beside the node adds it to the centre
  double two_v;
};

/// (shift + L) w at a node in extended precision, eq. (4) and (5), for any outline.
class ExtendedStencil {
 public:
  using Real = long double;

  explicit ExtendedStencil(const PlateSystem& system)
      : shift_(system.shift), row_(system.grid.columns) {
    const Real hu = system.grid.hu;
    const Real hv = system.grid.hv;
    b_ = system.stiffness.b / (hu * hu * hu * hu);
    c_ = system.stiffness.c / (hu * hu * hv * hv);
    d_ = system.stiffness.d / (hv * hv * hv * hv);
  }

  Real two_u() const { return b_; }  ///< weight of a node two steps away, and of a rim beside it
  Real two_v() const { return d_; }

  /// `p` points to the node in the field of all nodes, in double or in `Real`; the others are the
  /// values two steps away, which may be ghosts.
  template <class Number>
  Real at(const Number* p, Real left, Real right, Real below, Real above) const {
    const std::ptrdiff_t M = row_;
    const Real here = p[0];
    const Real beside_u = Real{p[-1]} + p[1];
    const Real beside_v = Real{p[-M]} + p[M];
    const Real uuuu = (left + right) - 4 * beside_u + 6 * here;
    const Real vvvv = (below + above) - 4 * beside_v + 6 * here;
    const Real corners = Real{p[-M - 1]} + p[-M + 1] + p[M - 1] + p[M + 1];
    const Real uuvv = corners - 2 * (beside_u + p[-M] + p[M]) + 4 * here;
    return shift_ * here + b_ * uuuu + c_ * uuvv + d_ * vvvv;
  }

 private:
  double shift_;
  std::ptrdiff_t row_;  // from a node to the one above
  Real b_, c_, d_;
};

SparseMatrix assemble_upper_of_domain(const PlateSystem& system);
Field residual_of_domain(const PlateSystem& system, const Field& w, const Field& f);

}  // namespace pliant
