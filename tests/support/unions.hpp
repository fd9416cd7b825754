#pragma once

#include <string>
#include <vector>

#include "pliant/plate/outline/outline.hpp"
#include "pliant/region/combine.hpp"

namespace pliant::testing {

/// A plate whose outline is the union of boxes.
struct UnionPlate {
  std::string name;
  Grid grid;
  InteriorMask interior;

  Outline outline() const { return {grid, interior}; }
};

/// The first patch of boxes on a square of `side` nodes over [0,1] x [0,1].
inline UnionPlate union_plate(std::string name, int side, const std::vector<Box>& boxes) {
  const Patch patch = combine(boxes, Combine::Union).at(0).patches.at(0);
  const double h = 1.0 / (side - 1);
  return {std::move(name), {patch.box.columns(), patch.box.rows(), h, h}, patch.interior};
}

inline UnionPlate ell(int side) {
  const int e = side - 1;
  return union_plate("L", side, {{0, e, 0, e / 2}, {0, e / 2, 0, e}});
}

/// Outlines that forces can make, on `side` nodes: with arms, with a hole, joined by a strip or a
/// neck.
inline std::vector<UnionPlate> union_plates(int side) {
  const int e = side - 1;
  const int a = e / 3;
  return {
      ell(side),
      union_plate("T", side, {{0, e, e - a, e}, {a, 2 * a, 0, e}}),
      union_plate("plus", side, {{0, e, a, 2 * a}, {a, 2 * a, 0, e}}),
      union_plate("U", side, {{0, e, 0, a}, {0, a, 0, e}, {e - a, e, 0, e}}),
      union_plate("ring", side, {{0, e, 0, a}, {0, a, 0, e}, {e - a, e, 0, e}, {0, e, e - a, e}}),
      union_plate("thin strip", side, {{0, e / 2 + 2, 0, 2 * a}, {e / 2 - 2, e, a, e}}),
      union_plate("neck", side, {{0, e / 2 + 2, 0, e / 2 + 2}, {e / 2 - 2, e, e / 2 - 2, e}})};
}

}  // namespace pliant::testing
