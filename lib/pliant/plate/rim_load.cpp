#include "pliant/plate/rim_load.hpp"

#include "pliant/core/expects.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {

void subtract_rim(const Grid& grid, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load) {
  const int M = grid.columns;
  const int N = grid.rows;
  PLIANT_EXPECTS(M >= 3 && N >= 3);
  PLIANT_EXPECTS(w.rows() == grid.node_count() && load.rows() == grid.node_count());
  const double hu = grid.hu;
  const double hv = grid.hv;
  const Stiffness scaled = scaled_stiffness(grid, stiffness);
  for (int component = 0; component < 3; ++component) {
    const double* const x = w.col(component).data();
    double* const f = load.col(component).data();
    const double ghost_u0 = -2 * hu * tangents.su0[component];
    const double ghost_u1 = 2 * hu * tangents.su1[component];
    const double ghost_v0 = -2 * hv * tangents.sv0[component];
    const double ghost_v1 = 2 * hv * tangents.sv1[component];
    const auto rim = [&](int i, int j) {
      return i == 0 || i == M - 1 || j == 0 || j == N - 1 ? x[grid.node(i, j)] : 0;
    };
    const auto subtract = [&](int i, int j) {
      // Eq. (4) to (6), term by term as in `apply_stencil`, with 0 inside.
      const double left = i == 1 ? ghost_u0 : rim(i - 2, j);
      const double right = i == M - 2 ? ghost_u1 : rim(i + 2, j);
      const double below = j == 1 ? ghost_v0 : rim(i, j - 2);
      const double above = j == N - 2 ? ghost_v1 : rim(i, j + 2);
      const double beside_u = rim(i - 1, j) + rim(i + 1, j);
      const double uuuu = (left + right) - 4 * beside_u;
      const double vvvv = (below + above) - 4 * (rim(i, j - 1) + rim(i, j + 1));
      const double corners =
          rim(i - 1, j - 1) + rim(i + 1, j - 1) + rim(i - 1, j + 1) + rim(i + 1, j + 1);
      const double uuvv =
          corners - 2 * (rim(i - 1, j) + rim(i + 1, j) + rim(i, j - 1) + rim(i, j + 1));
      f[grid.node(i, j)] -= scaled.b * uuuu + scaled.c * uuvv + scaled.d * vvvv;
    };
    for (int j = 1; j <= N - 2; ++j) {
      const bool is_outer_row = j <= 2 || j >= N - 3;
      for (int i = 1; i <= M - 2; ++i) {
        // In other rows, only the two nodes at each end.
        if (!is_outer_row && i == 3 && M - 3 > i) i = M - 3;
        subtract(i, j);
      }
    }
  }
}

void subtract_rim(const Grid& grid, const InteriorMask& interior, const Stiffness& stiffness,
                  const EdgeTangents& tangents, const Field& w, Field& load) {
  const int M = grid.columns;
  PLIANT_EXPECTS(interior.size() == static_cast<std::size_t>(grid.node_count()));
  PLIANT_EXPECTS(w.rows() == grid.node_count() && load.rows() == grid.node_count());
  const double hu = grid.hu;
  const double hv = grid.hv;
  const Stiffness scaled = scaled_stiffness(grid, stiffness);
  for (int component = 0; component < 3; ++component) {
    const double* const x = w.col(component).data();
    double* const f = load.col(component).data();
    const auto rim = [&](int node) { return interior[node] ? 0 : x[node]; };
    for (int j = 1; j < grid.rows - 1; ++j) {
      for (int i = 1; i < M - 1; ++i) {
        const int node = grid.node(i, j);
        if (!interior[node]) continue;
        // As in `apply_stencil`, with 0 inside: behind the rim a ghost mirrors this node.
        const auto far = [&](int step, bool is_last, double slope_term) {
          if (!interior[node + step]) return is_last ? slope_term : 0;
          return rim(node + 2 * step);
        };
        const double left = far(-1, i == 1, -2 * hu * tangents.su0[component]);
        const double right = far(1, i == M - 2, 2 * hu * tangents.su1[component]);
        const double below = far(-M, j == 1, -2 * hv * tangents.sv0[component]);
        const double above = far(M, j == grid.rows - 2, 2 * hv * tangents.sv1[component]);
        const double at_u = rim(node - 1) + rim(node + 1);
        const double at_v = rim(node - M) + rim(node + M);
        const double corners =
            rim(node - M - 1) + rim(node - M + 1) + rim(node + M - 1) + rim(node + M + 1);
        const double uuuu = (left + right) - 4 * at_u;
        const double vvvv = (below + above) - 4 * at_v;
        const double uuvv =
            corners - 2 * (rim(node - 1) + rim(node + 1) + rim(node - M) + rim(node + M));
        f[node] -= scaled.b * uuuu + scaled.c * uuvv + scaled.d * vvvv;
      }
    }
  }
}

}  // namespace pliant
