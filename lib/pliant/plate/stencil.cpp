#include "pliant/plate/stencil.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {

Field apply_stencil(const Outline& outline, const Stiffness& stiffness,
                    const EdgeTangents& tangents, const Field& w) {
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3 && w.rows() == grid.node_count());
  const Stencil<double> stencil(grid, stiffness);
  Field result(outline.unknown_count(), 3);
  with_steps(outline, [&](const auto& steps_at) {
    for (int component = 0; component < 3; ++component) {
      const EdgeGhosts ghosts(grid, tangents, component);
      int row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        const int j = run.j;
        for (int i = run.i0; i <= run.i1; ++i) {
          const auto steps = steps_at(i, j);
          const double* const p = w.col(component).data() + grid.node(i, j);
          const auto near = [&](int di, int dj) { return p[steps.to(di, dj)]; };
          const auto far = [&](int di, int dj) {
            return is_ghost(outline, i, j, di, dj) ? p[0] + ghosts.at(i + di, j + dj)
                                                   : near(di, dj);
          };
          result(row++, component) = stencil.apply(near, far);
        }
      });
    }
  });
  return result;
}

}  // namespace pliant
