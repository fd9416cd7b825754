#include "pliant/region/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "region/select.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

// SPEC 5 word for word, over (u,v) values instead of node indices, and without the library's
// distance code. u and v are the node's own coordinates on the sheet.
struct UvBox {
  double u_min = std::numeric_limits<double>::infinity(), u_max = -u_min;
  double v_min = u_min, v_max = -u_min;
  void add(double u, double v) {
    u_min = std::min(u_min, u), u_max = std::max(u_max, u);
    v_min = std::min(v_min, v), v_max = std::max(v_max, v);
  }
  bool holds(double u, double v) const {
    return u_min <= u && u <= u_max && v_min <= v && v <= v_max;
  }
};

double brute_distance(const ForceKind& shape, const Vector3d& p) {
  if (const auto* point = std::get_if<PointForce>(&shape)) return (p - point->center).norm();
  if (const auto* radial = std::get_if<RadialForce>(&shape)) return (p - radial->center).norm();
  const auto& line = std::get<LineForce>(shape);
  const Vector3d along = line.to - line.from;
  const double t = (p - line.from).dot(along) / along.squaredNorm();
  if (!(t > 0)) return (p - line.from).norm();  // behind the segment, or a segment of no length
  if (t >= 1) return (p - line.to).norm();
  return (p - line.from - t * along).norm();
}

struct Situation {
  Grid grid;
  Field nodes;
  std::vector<SampledForce> forces;
};

int pick(std::mt19937& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

Vector3d lattice_point(std::mt19937& random) {
  const int x = pick(random, -3, 16);
  const int y = pick(random, -2, 2);
  return {double(x), double(y), double(pick(random, -3, 16))};
}

ForceKind lattice_shape(std::mt19937& random) {
  const int kind = pick(random, 0, 2);
  const Vector3d from = lattice_point(random);
  if (kind == 0) return PointForce{from, {0, 1, 0}};
  if (kind == 1) return RadialForce{from};
  // Along an axis, so that the closest point is exact too.
  const int axis = pick(random, 0, 1) * 2;
  return LineForce{from, from + pick(random, 0, 8) * Vector3d::Unit(axis), {}};
}

// Integer coordinates and radii, so that distances are often exactly a radius: ties.
Situation random_lattice(std::mt19937& random) {
  Situation s;
  const int columns = pick(random, 3, 14);
  s.grid = {columns, pick(random, 3, 14), 0.25, 0.5};
  s.nodes.resize(s.grid.node_count(), 3);
  for (int j = 0; j < s.grid.rows; ++j) {
    for (int i = 0; i < s.grid.columns; ++i)
      s.nodes.row(s.grid.node(i, j)) << i, pick(random, 0, 1), j;
  }
  for (int k = pick(random, 0, 4); k > 0; --k) {
    // Braces evaluate from left to right.
    s.forces.push_back({.kind = lattice_shape(random),
                        .magnitude = double(pick(random, -5, 5)),
                        .deformation_radius = double(pick(random, 0, 6)),
                        .force_radius = double(pick(random, 0, 8)),
                        .falloff = static_cast<Falloff>(pick(random, 0, 3))});
  }
  return s;
}

}  // namespace

TEST_CASE("regions and force boxes are those of a brute-force reading", "[region]") {
  std::mt19937 random(17);
  int ties = 0, overlaps = 0, empty = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Situation s = random_lattice(random);
    const auto uv = [&](int node) {
      return std::pair{(node % s.grid.columns) * s.grid.hu, (node / s.grid.columns) * s.grid.hv};
    };
    UvBox region;
    std::vector<UvBox> force_boxes(s.forces.size());
    for (std::size_t k = 0; k < s.forces.size(); ++k) {
      for (int node = 0; node < s.grid.node_count(); ++node) {
        const auto [u, v] = uv(node);
        const double delta = brute_distance(s.forces[k].kind, s.nodes.row(node).transpose());
        ties += delta == s.forces[k].deformation_radius;
        if (delta < s.forces[k].deformation_radius) region.add(u, v);
        if (delta < s.forces[k].force_radius) force_boxes[k].add(u, v);
      }
    }

    const Selection selection = select_region(s.grid, s.nodes, s.forces);
    REQUIRE(selection.forces.size() == s.forces.size());
    int deforming = 0;
    for (const ForceSelection& force : selection.forces) deforming += !force.deformation.is_empty();
    overlaps += deforming > 1;
    empty += selection.box().is_empty();
    for (int node = 0; node < s.grid.node_count(); ++node) {
      const int i = node % s.grid.columns, j = node / s.grid.columns;
      const auto [u, v] = uv(node);
      REQUIRE(selection.box().contains(i, j) == region.holds(u, v));
      for (std::size_t k = 0; k < s.forces.size(); ++k) {
        REQUIRE(selection.forces[k].force.contains(i, j) == force_boxes[k].holds(u, v));
      }
    }
    if (selection.box().is_empty()) continue;

    const Field load = assemble_load(s.grid, s.nodes, s.forces, selection);
    int row = 0;
    for (int node = 0; node < s.grid.node_count(); ++node) {
      const auto [u, v] = uv(node);
      if (!region.holds(u, v)) continue;
      Vector3d expected = Vector3d::Zero();
      for (std::size_t k = 0; k < s.forces.size(); ++k) {
        if (force_boxes[k].holds(u, v))
          expected += force_at(s.forces[k], s.nodes.row(node).transpose());
      }
      REQUIRE(load.row(row++).transpose() == expected);
    }
    REQUIRE(row == load.rows());
  }
  // The random situations include enough of these cases.
  CHECK(ties > 1000);
  CHECK(overlaps > 200);
  CHECK(empty > 100);
}

TEST_CASE("a distance equal to the radius does not select", "[region]") {
  const Grid grid{9, 9, 1, 1};
  Field nodes(81, 3);
  for (int node = 0; node < 81; ++node) nodes.row(node) << node % 9, 0, node / 9;
  const auto region = [&](double radius) {
    SampledForce force{PointForce{{4, 0, 4}, {0, 1, 0}}, 1, radius, radius, Falloff::Constant};
    return select_region(grid, nodes, {&force, 1}).box();
  };
  CHECK(region(0).is_empty());
  CHECK(region(std::nextafter(0, 1)) == Box{4, 4, 4, 4});
  CHECK(region(2) == Box{3, 5, 3, 5});
  CHECK(region(std::nextafter(2, 3)) == Box{2, 6, 2, 6});
  CHECK(region(5) == Box{0, 8, 0, 8});
}

TEST_CASE("a force box may reach past the region, and only the part inside acts", "[region]") {
  const Grid grid{9, 9, 1, 1};
  Field nodes(81, 3);
  for (int node = 0; node < 81; ++node) nodes.row(node) << node % 9, 0, node / 9;
  // Deformation radius 5, force radius 10: thesis fig. 11, left.
  const SampledForce force{PointForce{{4, 0, 4}, {0, 2, 0}}, 3, 2.5, 10, Falloff::Constant};
  const Selection selection = select_region(grid, nodes, {&force, 1});
  CHECK(selection.box() == Box{2, 6, 2, 6});
  CHECK(selection.forces[0].force == Box{0, 8, 0, 8});
  const Field load = assemble_load(grid, nodes, {&force, 1}, selection);
  REQUIRE(load.rows() == 25);
  for (int row = 0; row < 25; ++row) CHECK(load.row(row) == Eigen::RowVector3d(0, 3, 0));
}
