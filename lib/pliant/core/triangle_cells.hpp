#pragma once

#include <array>
#include <vector>

namespace pliant {

/// A triangle laid flat: the places of its second and third corner as seen from the first one,
/// along u and along v [length]. Its corners run clockwise if UVs mirror it.
struct FlatTriangle {
  std::array<double, 2> b = {0, 0};
  std::array<double, 2> c = {0, 0};

  double signed_area() const { return 0.5 * (b[0] * c[1] - b[1] * c[0]); }  ///< [length^2]

  friend bool operator==(const FlatTriangle&, const FlatTriangle&) = default;
};

/// The outward slope at one side of a cell: `sign` times the sum of `count` unknown slopes from
/// `first` on. No unknowns: it is given.
struct SideSlope {
  int first = 0;
  int count = 0;
  double sign = 1;

  friend bool operator==(const SideSlope&, const SideSlope&) = default;
};

/// A triangle of a plate. Side k goes from point k to the next.
struct TriangleCell {
  std::array<int, 3> points = {};
  std::array<SideSlope, 3> slopes = {};
  FlatTriangle shape;
  int triangle = 0;  ///< of the surface, of which it is a part

  friend bool operator==(const TriangleCell&, const TriangleCell&) = default;
};

/// A plate as triangles that share points and slopes. The free points come first; all others are
/// held.
struct TriangleCells {
  std::vector<TriangleCell> cells;

  /// Cells that are one after the other may form a block, such as a whole face round its centre:
  /// unknowns within it are eliminated by themselves. #blocks + 1: the first cell of each.
  std::vector<int> block_starts = {0};

  int free_points = 0;
  int point_count = 0;
  int slope_count = 0;  ///< unknown slopes

  int block_count() const { return static_cast<int>(block_starts.size()) - 1; }
  int unknown_count() const { return free_points + slope_count; }

  friend bool operator==(const TriangleCells&, const TriangleCells&) = default;
};

}  // namespace pliant
