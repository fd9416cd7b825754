#include "pliant/plate/rim_load.hpp"

#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

// What the stencil meets around a node: the same for all three components.
class Surroundings {
 public:
  Surroundings(const Outline& outline, int i, int j) {
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) is_rim_[place(di, dj)] = !outline.holds(i + di, j + dj);
    }
    for (const auto& [di, dj] : {std::pair{-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
      const int k = far_place(di, dj);
      is_ghost_[k] = is_rim(di / 2, dj / 2);
      is_far_rim_[k] = !is_ghost_[k] && !outline.holds(i + di, j + dj);
    }
  }

  bool is_rim(int di, int dj) const { return is_rim_[place(di, dj)]; }
  bool is_ghost(int di, int dj) const { return is_ghost_[far_place(di, dj)]; }
  bool is_far_rim(int di, int dj) const { return is_far_rim_[far_place(di, dj)]; }

 private:
  static int place(int di, int dj) { return 3 * (dj + 1) + di + 1; }
  static int far_place(int di, int dj) { return di < 0 ? 0 : di > 0 ? 1 : dj < 0 ? 2 : 3; }

  bool is_rim_[9];
  bool is_ghost_[4], is_far_rim_[4];
};

}  // namespace

void subtract_rim(const Outline& outline, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load) {
  const Grid& grid = outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  PLIANT_EXPECTS(w.rows() == grid.node_count() && load.rows() == grid.node_count());
  const Stencil<double> stencil(grid, stiffness);
  const EdgeGhosts ghosts[] = {{grid, tangents, 0}, {grid, tangents, 1}, {grid, tangents, 2}};
  with_steps(outline, [&](const auto& steps_at) {
    outline.for_each_near_rim([&](int i, int j) {
      const Surroundings around(outline, i, j);
      const auto steps = steps_at(i, j);
      for (int component = 0; component < 3; ++component) {
        const double* const p = w.col(component).data() + grid.node(i, j);
        const auto near = [&](int di, int dj) {
          return around.is_rim(di, dj) ? p[steps.to(di, dj)] : 0;
        };
        const auto far = [&](int di, int dj) {
          if (around.is_ghost(di, dj)) return 0 + ghosts[component].at(i + di, j + dj);
          return around.is_far_rim(di, dj) ? p[steps.to(di, dj)] : 0;
        };
        load.col(component)[grid.node(i, j)] -= stencil.apply(near, far);
      }
    });
  });
}

}  // namespace pliant
