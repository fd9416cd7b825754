#pragma once

#include <cstddef>

#include "pliant/plate/operator.hpp"

namespace pliant {

// `assemble_upper` and `residual` of a system that has an interior mask; not for other rooms.

/// (shift + L) w at a node in extended precision, eq. (4) and (5), whatever the outline.
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

  /// `p` is the node among all nodes; the others are the values two steps away, which may be
  /// ghosts.
  Real at(const Real* p, Real left, Real right, Real below, Real above) const {
    const std::ptrdiff_t M = row_;
    const Real uuuu = (left + right) - 4 * (p[-1] + p[1]) + 6 * p[0];
    const Real vvvv = (below + above) - 4 * (p[-M] + p[M]) + 6 * p[0];
    const Real uuvv = (p[-M - 1] + p[-M + 1] + p[M - 1] + p[M + 1]) -
                      2 * (p[-1] + p[1] + p[-M] + p[M]) + 4 * p[0];
    return shift_ * p[0] + b_ * uuuu + c_ * uuvv + d_ * vvvv;
  }

 private:
  double shift_;
  std::ptrdiff_t row_;  // from a node to the one above
  Real b_, c_, d_;
};

SparseMatrix assemble_upper_of_domain(const PlateSystem& system);
Field residual_of_domain(const PlateSystem& system, const Field& w, const Field& f);

}  // namespace pliant
