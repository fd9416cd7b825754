#include "pliant/plate/rim_load.hpp"

#include "pliant/core/expects.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {

void subtract_rim(const Outline& outline, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load) {
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  PLIANT_EXPECTS(w.rows() == grid.node_count() && load.rows() == grid.node_count());
  const Stencil<double> stencil(grid, stiffness);
  for (int component = 0; component < 3; ++component) {
    const double* const x = w.col(component).data();
    double* const f = load.col(component).data();
    const EdgeGhosts ghost(grid, tangents, component);
    const auto rim = [&](int i, int j) { return outline.holds(i, j) ? 0 : x[grid.node(i, j)]; };
    outline.for_each_near_rim([&](int i, int j) {
      f[grid.node(i, j)] -= stencil.apply(around(outline, i, j, rim, ghost));
    });
  }
}

}  // namespace pliant
