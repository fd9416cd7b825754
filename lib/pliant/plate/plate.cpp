#include "pliant/plate/plate.hpp"

#include <cmath>

#include "pliant/core/expects.hpp"

namespace pliant {

double Stiffness::least_c() const {
  // The root of the product is right at equality (b = d = 2 gives 2, the two roots a little more);
  // the two roots are used if the product overflows or underflows.
  const double root = std::isnormal(b * d) ? std::sqrt(b * d) : std::sqrt(b) * std::sqrt(d);
  return -2 * root;
}

bool Stiffness::is_elliptic() const { return b > 0 && d > 0 && c > least_c(); }

Field interior_of(const Grid& grid, const Field& nodes) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  const int width = grid.columns - 2;
  Field interior(unknown_count(grid), 3);
  for (int component = 0; component < 3; ++component) {
    for (int j = 1; j + 1 < grid.rows; ++j) {
      interior.col(component).segment((j - 1) * width, width) =
          nodes.col(component).segment(grid.node(1, j), width);
    }
  }
  return interior;
}

Field with_interior(const Grid& grid, Field nodes, const Field& interior) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count() && interior.rows() == unknown_count(grid));
  const int width = grid.columns - 2;
  for (int component = 0; component < 3; ++component) {
    for (int j = 1; j + 1 < grid.rows; ++j) {
      nodes.col(component).segment(grid.node(1, j), width) =
          interior.col(component).segment((j - 1) * width, width);
    }
  }
  return nodes;
}

}  // namespace pliant
