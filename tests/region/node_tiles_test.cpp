#include "pliant/region/node_tiles.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "region/select.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;

namespace {

double number(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vector3d place(std::mt19937& random) {
  return {number(random, -6, 6), number(random, -2, 2), number(random, -6, 6)};
}

// A hilly sheet of several tiles; the last ones are incomplete.
Field hills(const Grid& grid, std::mt19937& random) {
  Field nodes(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      nodes.row(grid.node(i, j)) << 10.0 * i / grid.columns - 5, number(random, -0.3, 0.3),
          10.0 * j / grid.rows - 5;
    }
  }
  return nodes;
}

ForceKind shape(std::mt19937& random, int kind) {
  const Vector3d a = place(random), b = place(random);
  switch (kind % 8) {
    case 0:
      return PointForce{a, b};
    case 1:
      return RadialForce{a};
    case 2:
      return LineForce{a, b, {}};
    case 3:
      return VortexForce{a, b, 0.5};
    case 4:
      return NoiseForce{a, 1, 0, 3};
    case 5:
      return UniformForce{a};
    case 6:
      return LineForce{a, a, {}};
    default:
      return SampledCustomForce{[a](const Vector3d& p) { return (p - a).norm(); },
                                [](const Vector3d& p) { return p; }};
  }
}

Box near(const Grid& grid, const Field& nodes, const ForceKind& shape, double radius) {
  Box box;
  for (int node = 0; node < grid.node_count(); ++node) {
    if (distance(shape, nodes.row(node).transpose()) < radius) {
      box.include(node % grid.columns, node / grid.columns);
    }
  }
  return box;
}

}  // namespace

TEST_CASE("tiles select what a look at every node selects", "[region][tiles]") {
  std::mt19937 random(3);
  int partial = 0, ties = 0;
  for (int trial = 0; trial < testing::rounds(60); ++trial) {
    const Grid grid{3 + static_cast<int>(random() % 100), 3 + static_cast<int>(random() % 100), 1,
                    1};
    const Field rest = hills(grid, random);
    const Transform transform =
        make_transform(place(random), 20 * place(random), {1, 2, 0.5}, RotateOrder::Xyz);
    const bool is_placed = trial % 2;
    const Field nodes = is_placed ? to_world(transform, rest) : rest;
    NodeTiles tiles;
    tiles.update(grid, is_placed ? PlacedNodes(rest, transform) : PlacedNodes(rest));
    REQUIRE(tiles.are_finite());
    std::vector<SampledForce> forces;
    for (int k = 0; k < 16; ++k) {
      SampledForce& force = forces.emplace_back();
      force.kind = shape(random, k);
      // Every other radius equals the distance of some node, or is the next larger number.
      const auto node = static_cast<Eigen::Index>(random() % grid.node_count());
      const double delta = distance(force.kind, nodes.row(node).transpose());
      ties += k % 2;
      force.deformation_radius = k % 2 ? delta : number(random, 0, 4);
      force.force_radius = k % 2 ? std::nextafter(delta, 1e9) : number(random, 0, 4);
    }
    Selection selection = reselected({}, tiles, forces, Combine::Islands);
    for (std::size_t k = 0; k < forces.size(); ++k) {
      const ForceSelection& selected = selection.forces[k];
      REQUIRE(selected.deformation ==
              near(grid, nodes, forces[k].kind, forces[k].deformation_radius));
      REQUIRE(selected.force == near(grid, nodes, forces[k].kind, forces[k].force_radius));
      partial += !selected.force.is_empty() && selected.force != grid.box();
    }
    CHECK(selection == select_region(grid, nodes, forces, Combine::Islands));
    // Again: if the boxes are unchanged, so is the rest.
    const Selection before = selection;
    const Region* const kept = selection.regions.data();
    selection = reselected(std::move(selection), tiles, forces, Combine::Islands);
    CHECK(selection == before);
    CHECK(selection.regions.data() == kept);
    // Boxes that no force selects are not those of the next frame.
    selection = recombined(std::move(selection), Combine::Islands, {{0, 2, 0, 2}});
    CHECK(selection.others.size() == 1);
    selection = reselected(std::move(selection), tiles, forces, Combine::Islands);
    CHECK(selection == before);
    forces.pop_back();
    selection = reselected(std::move(selection), tiles, forces, Combine::Islands);
    CHECK(selection == select_region(grid, nodes, forces, Combine::Islands));
  }
  CHECK(partial > testing::rounds(200));
  CHECK(ties > testing::rounds(400));
}

TEST_CASE("nodes that are no numbers are told of, and hide no others", "[region][tiles]") {
  const Grid grid{40, 40, 1, 1};
  std::mt19937 random(4);
  Field nodes = hills(grid, random);
  const SampledForce force{PointForce{nodes.row(500).transpose(), {0, 1, 0}}, 1, 2, 1};
  const Box expected = near(grid, nodes, force.kind, 2);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Field some = nodes;
    some(0, 1) = bad;
    some(grid.node(39, 39), 2) = -bad;
    NodeTiles tiles;
    tiles.update(grid, some);
    CHECK_FALSE(tiles.are_finite());
    CHECK(boxes_of(tiles, force).deformation == expected);
  }
}

TEST_CASE("loads in object space are those in world space taken there", "[region][tiles]") {
  std::mt19937 random(8);
  const Grid grid{71, 45, 1, 1};
  const Field rest = hills(grid, random);
  const Transform transform =
      make_transform({1, 2, 3}, {30, -50, 10}, {1, 2, 0.5}, RotateOrder::Zyx);
  std::vector<SampledForce> forces(6);
  for (int k = 0; k < 6; ++k) {
    forces[k].kind = shape(random, k);
    forces[k].magnitude = number(random, -3, 3);
    forces[k].deformation_radius = 3;
    forces[k].force_radius = 2.5;
    forces[k].falloff = static_cast<Falloff>(k % 4);
  }
  const Field nodes = to_world(transform, rest);
  const Selection selection = select_region(grid, nodes, forces);
  REQUIRE_FALSE(selection.box().is_empty());
  const Field load = assemble_load(grid, nodes, forces, selection);
  const Field expected = vectors_to_object(transform, load);
  CHECK_FALSE(load.isZero(0));
  const Field found = assemble_load(grid, {rest, transform}, forces, selection, 0, selection.box(),
                                    inverse_linear(transform), Field::Ones(3, 3));
  CHECK(found == expected);
}
