#include "pliant/region/triangles/triangle_cut.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "pliant/region/triangles/triangle_load.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

SampledForce ball(const Vector3d& center, double deformation_radius, double force_radius = 0) {
  return {PointForce{center, {0, 1, 0}}, 1, deformation_radius, force_radius, Falloff::Constant};
}

struct Cut {
  TriangleSurface surface;
  LevelSet level_set;
  std::vector<TrianglePatch> patches;

  Cut(const Mesh& mesh, const std::vector<SampledForce>& forces, Border border = Border::Clamped)
      : surface(make_surface(mesh).value()) {
    level_set = find_level_set(surface, PointTree(surface.rest), {}, forces, {});
    snap(level_set);
    std::vector<bool> is_border(static_cast<std::size_t>(surface.node_count()));
    for (int node = 0; node < surface.node_count(); ++node) {
      const auto p = surface.rest.row(node).cwiseAbs();
      is_border[node] = p.maxCoeff() >= 0.5 - 1e-9;  // of a square of side 1
    }
    patches = cut_out(surface, level_set, is_border, border).value();
  }

  double area() const {
    double sum = 0;
    for (const TrianglePatch& patch : patches) {
      for (const TriangleCell& cell : patch.cells.cells) sum += cell.shape.signed_area();
    }
    return sum;
  }

  double mass() const {
    double sum = 0;
    for (const TrianglePatch& patch : patches) {
      sum = std::accumulate(patch.masses.begin(), patch.masses.end(), sum);
    }
    return sum;
  }
};

}  // namespace

TEST_CASE("a cut region has the area of the disc, better with finer meshes", "[region][surface]") {
  for (const bool has_quads : {false, true}) {
    double before = 1;
    for (const int count : {10, 20, 40, 80}) {
      const Cut cut(square(count, 1, 0.3, has_quads), {ball({0, 0, 0}, 0.37)});
      REQUIRE(cut.patches.size() == 1);
      const double error = std::abs(cut.area() / (std::numbers::pi * 0.37 * 0.37) - 1);
      CHECK(error < 30.0 / (count * count));
      before = error;
    }
    CHECK(before < 0.005);
  }
}

TEST_CASE("a region that is the whole surface is all of its triangles", "[region][surface]") {
  for (const bool has_quads : {false, true}) {
    const Cut cut(square(9, 1, 0.3, has_quads), {ball({0, 0, 0}, 5)}, Border::Free);
    REQUIRE(cut.patches.size() == 1);
    const TrianglePatch& patch = cut.patches[0];
    CHECK(patch.cells.cells.size() == cut.surface.triangles.size());
    CHECK(cut.area() == Approx(1));
    CHECK(cut.mass() == Approx(1));
    CHECK(patch.free_nodes == 100);
    CHECK_FALSE(patch.moves());  // nothing holds it
    // A slope on each edge and each way to a centre.
    CHECK(patch.cells.slope_count ==
          cut.surface.edge_count() + (has_quads ? 4 * cut.surface.face_count() : 0));
    const Cut held(square(9, 1, 0.3, has_quads), {ball({0, 0, 0}, 5)});
    CHECK(held.patches[0].free_nodes == 64);
    CHECK(held.patches[0].counts(held.level_set).held_nodes == 36);
    CHECK(held.patches[0].moves());
    CHECK(held.patches[0].cells.slope_count == patch.cells.slope_count - 36);
  }
}

TEST_CASE("no cell of a cut is a sliver of its triangle", "[region][surface]") {
  std::mt19937 random(1);
  for (int trial = 0; trial < 40; ++trial) {
    const auto chance = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
    const Cut cut(square(12, 1, 0, trial % 2 == 1),
                  {ball({0.4 * chance(), 0, 0.4 * chance()}, 0.3 + 0.1 * chance())});
    for (const TrianglePatch& patch : cut.patches) {
      for (const TriangleCell& cell : patch.cells.cells) {
        CHECK(cell.shape.signed_area() > 0.5 / 144 * 0.1 * 0.1 / 4);
      }
    }
  }
}

TEST_CASE("each side of a cell has its slope, or it is given", "[region][surface]") {
  const Cut cut(square(12, 1, 0.3), {ball({0.3, 0, 0.1}, 0.35)});  // it reaches the border
  const TriangleCells& cells = cut.patches[0].cells;
  std::vector<double> sums(cells.slope_count, 0);
  std::vector<int> uses(cells.slope_count, 0);
  int given = 0;
  for (const TriangleCell& cell : cells.cells) {
    for (const SideSlope& slope : cell.slopes) {
      given += slope.count == 0 ? 1 : 0;
      for (int k = 0; k < slope.count; ++k) {
        sums[slope.first + k] += slope.sign;
        ++uses[slope.first + k];
      }
    }
  }
  CHECK(given > 10);
  CHECK(std::all_of(sums.begin(), sums.end(), [](double sum) { return sum == 0; }));
  CHECK(std::all_of(uses.begin(), uses.end(), [](int count) { return count == 2; }));
}

TEST_CASE("spheres that do not meet cut out patches", "[region][surface]") {
  const Cut cut(square(20, 1, 0.2), {ball({-0.25, 0, 0}, 0.15), ball({0.25, 0, 0}, 0.15)});
  CHECK(cut.patches.size() == 2);
  const Cut joined(square(20, 1, 0.2), {ball({-0.1, 0, 0}, 0.15), ball({0.1, 0, 0}, 0.15)});
  CHECK(joined.patches.size() == 1);
  const Cut none(square(20, 1, 0.2), {ball({0, 3, 0}, 0.15)});
  CHECK(none.patches.empty());
}

TEST_CASE("at a branch the slopes of three cells add up to 0", "[region][surface]") {
  // Three squares along one edge, from x = 0 on.
  const Mesh mesh = mesh_of({{0, 0, 0},
                             {0, 0, 1},
                             {1, 0, 0},
                             {1, 0, 1},
                             {-1, 1, 0},
                             {-1, 1, 1},
                             {-1, -1, 0},
                             {-1, -1, 1}},
                            {{0, 1, 3}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {0, 1, 7}, {0, 7, 6}});
  const Cut cut(mesh, {ball({0, 0, 0}, 9)}, Border::Free);
  REQUIRE(cut.patches.size() == 1);
  const TriangleCells& cells = cut.patches[0].cells;
  const SideSlope &a = cells.cells[0].slopes[0], &b = cells.cells[2].slopes[0],
                  &c = cells.cells[4].slopes[0];
  CHECK(a == SideSlope{a.first, 1, 1});
  CHECK(b == SideSlope{a.first + 1, 1, 1});
  CHECK(c == SideSlope{a.first, 2, -1});
  CHECK(cells.slope_count == cut.surface.edge_count() + 1);
}

TEST_CASE("depths of many nodes are those of each, and finite", "[region][surface]") {
  const Mesh mesh = square(9, 1, 0.3);
  const TriangleSurface surface = make_surface(mesh).value();
  std::vector<int> nodes;
  for (int node = surface.node_count() - 1; node >= 0; node -= 2) nodes.push_back(node);
  REQUIRE(nodes.size() > 32);  // more than one batch
  const PlacedNodes placed(surface.rest, Transform{2 * Matrix3d::Identity(), {0, 1, 0}});
  const ForceKind kind = ball({0.1, 0, 0.2}, 1).kind;
  const std::vector<double> depths = depths_of(placed, nodes, kind, 0.7);
  REQUIRE(depths.size() == nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    CHECK(depths[k] == 0.7 - distance(kind, placed.at(nodes[k])));
  }
  const SampledCustomForce nowhere{
      [](const Vector3d&) { return std::numeric_limits<double>::infinity(); },
      [](const Vector3d&) { return Vector3d(0, 0, 0); }};
  for (const double depth : depths_of(placed, nodes, nowhere, 0.7)) {
    CHECK((std::isfinite(depth) && depth < 0));
  }
}

TEST_CASE("the area of a load changes evenly while its force slides", "[region][surface]") {
  const Mesh mesh = square(12, 1, 0.3);
  double least = 1, most = 0;
  for (int k = 0; k <= 50; ++k) {
    const double x = -0.1 + 0.004 * k;
    const SampledForce force = ball({x, 0, 0.03}, 5, 0.2);
    const Cut cut(mesh, {force});
    const PlacedNodes nodes(cut.surface.rest);
    TriangleLoads loads(cut.level_set, cut.patches, nodes);
    REQUIRE(loads.compute(force));
    const double area = loads.push().sum.y() / (std::numbers::pi * 0.04);
    least = std::min(least, area), most = std::max(most, area);
  }
  CHECK(most - least < 0.03);
  CHECK(least > 0.93);
  CHECK(most < 1.01);
}

TEST_CASE("a load of everything is the mass", "[region][surface]") {
  for (const bool has_quads : {false, true}) {
    const SampledForce force = ball({0.1, 0, 0}, 0.35, 9);
    const Cut cut(square(12, 1, 0.3, has_quads), {force});
    const PlacedNodes nodes(cut.surface.rest);
    TriangleLoads loads(cut.level_set, cut.patches, nodes);
    REQUIRE(loads.compute(force));
    for (int k = 0; k < cut.patches[0].free_nodes; ++k) {
      CHECK(loads.loads(0)(k, 1) == Approx(cut.patches[0].masses[k]).epsilon(1e-12));
    }
  }
}
