#include "pliant/plate/stencil.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {

Stiffness scaled_stiffness(const Grid& grid, const Stiffness& stiffness) {
  const double hu = grid.hu;
  const double hv = grid.hv;
  return {stiffness.b / (hu * hu * hu * hu), stiffness.c / (hu * hu * hv * hv),
          stiffness.d / (hv * hv * hv * hv)};
}

Field apply_stencil(const Grid& grid, const Stiffness& stiffness, const EdgeTangents& tangents,
                    const Field& w) {
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3 && w.rows() == grid.node_count());
  const int M = grid.columns;
  const int N = grid.rows;
  const double hu = grid.hu;
  const double hv = grid.hv;
  const Stiffness scaled = scaled_stiffness(grid, stiffness);

  Field result(unknown_count(grid), 3);
  for (int component = 0; component < 3; ++component) {
    const double* const x = w.col(component).data();
    double* const y = result.col(component).data();
    // Eq. (6): a ghost is the node mirrored at the rim, plus the slope times two spacings.
    const double ghost_u0 = -2 * hu * tangents.su0[component];
    const double ghost_u1 = 2 * hu * tangents.su1[component];
    const double ghost_v0 = -2 * hv * tangents.sv0[component];
    const double ghost_v1 = 2 * hv * tangents.sv1[component];
    for (int j = 1; j <= N - 2; ++j) {
      const double* const row = x + j * M;
      for (int i = 1; i <= M - 2; ++i) {
        const double* const p = row + i;
        const double left = i == 1 ? p[0] + ghost_u0 : p[-2];
        const double right = i == M - 2 ? p[0] + ghost_u1 : p[2];
        const double below = j == 1 ? p[0] + ghost_v0 : p[-2 * M];
        const double above = j == N - 2 ? p[0] + ghost_v1 : p[2 * M];
        // Eq. (4): (1 -4 6 -4 1) along each direction. Eq. (5): (1 -2 1) x (1 -2 1) mixed.
        const double uuuu = (left + right) - 4 * (p[-1] + p[1]) + 6 * p[0];
        const double vvvv = (below + above) - 4 * (p[-M] + p[M]) + 6 * p[0];
        const double uuvv = (p[-M - 1] + p[-M + 1] + p[M - 1] + p[M + 1]) -
                            2 * (p[-1] + p[1] + p[-M] + p[M]) + 4 * p[0];
        y[(j - 1) * (M - 2) + (i - 1)] = scaled.b * uuuu + scaled.c * uuvv + scaled.d * vvvv;
      }
    }
  }
  return result;
}

}  // namespace pliant
