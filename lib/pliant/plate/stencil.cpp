#include "pliant/plate/stencil.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {

Field apply_stencil(const Outline& outline, const Stiffness& stiffness,
                    const EdgeTangents& tangents, const Field& w) {
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3 && w.rows() == grid.node_count());
  const Stencil<double> stencil(grid, stiffness);
  Field result(outline.unknown_count(), 3);
  for (int component = 0; component < 3; ++component) {
    const EdgeGhosts ghost(grid, tangents, component);
    const auto value = [&](int i, int j) { return w(grid.node(i, j), component); };
    int row = 0;
    outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i) {
        result(row++, component) = stencil.apply(around(outline, i, run.j, value, ghost));
      }
    });
  }
  return result;
}

}  // namespace pliant
