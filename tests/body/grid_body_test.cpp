#include "pliant/body/grid_body.hpp"

#include <cmath>
#include <limits>

#include "body/sheets.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"

using namespace pliant;
using pliant::testing::step;

namespace {

struct Sheet {
  Grid grid;
  Field rest;
};

Sheet sheet(int count = 17) {
  const auto mapping = find_grid(
      make_mesh({.columns = count, .rows = count, .width = count - 1.0, .depth = count - 1.0}));
  return {mapping->grid, mapping->rest};
}

// A sheet with hills, so that its rest shape is not a solution of the equation without reference.
Sheet relief(int count = 17) {
  Sheet s = sheet(count);
  for (int node = 0; node < s.grid.node_count(); ++node) {
    s.rest(node, 1) = std::sin(0.7 * s.rest(node, 0)) * std::cos(0.4 * s.rest(node, 2));
  }
  return s;
}

SampledForce poke(double x, double z, double magnitude = 3000, double radius = 4.5) {
  return {PointForce{{x, 0, z}, {0.2, 1, 0}}, magnitude, radius, radius / 2, Falloff::Constant};
}

BodyInputs inputs(std::vector<SampledForce> forces) {
  BodyInputs in;
  in.dynamics = {40, 20};
  in.frame_length = 1.0 / 24;
  in.dt = 0.01;
  in.forces = std::move(forces);
  return in;
}

double peak(const Body& body) {
  return (body.state().positions - body.rest()).rowwise().norm().maxCoeff();
}

}  // namespace

TEST_CASE("nothing moves without a force", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {});
  const auto report = step(body, inputs({})).value();
  CHECK_FALSE(report.solves());
  CHECK(body.state().positions == s.rest);
}

TEST_CASE("a force of magnitude 0 leaves the rest shape to the bit", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {});
  for (int frame = 0; frame < 5; ++frame) CHECK(step(body, inputs({poke(0, 0, 0)}))->solves());
  CHECK(body.state().positions == s.rest);
  CHECK(body.state().velocities.isZero(0));
}

TEST_CASE("only the interior of the region moves, and only it carries velocity", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {});
  const auto report = step(body, inputs({poke(1, 2)})).value();
  REQUIRE(report.solves());
  const Box region = report.selection.box();
  for (int j = 0; j < s.grid.rows; ++j) {
    for (int i = 0; i < s.grid.columns; ++i) {
      const int node = s.grid.node(i, j);
      const bool is_interior = i > region.i0 && i < region.i1 && j > region.j0 && j < region.j1;
      CHECK((body.state().positions.row(node) != s.rest.row(node)) == is_interior);
      CHECK((!body.state().velocities.row(node).isZero(0)) == is_interior);
    }
  }
}

TEST_CASE("velocity is carried by node from the last solve, across frames without one", "[body]") {
  const Sheet s = sheet();
  GridBody body(s.grid, s.rest, {});
  REQUIRE(step(body, inputs({poke(-2, 0)}))->solves());
  const BodyState after = body.state();

  // Frames without a solve, because there is no force or no region, change nothing.
  for (int frame = 0; frame < 3; ++frame) REQUIRE_FALSE(step(body, inputs({}))->solves());
  REQUIRE_FALSE(step(body, inputs({poke(100, 0)}))->solves());
  REQUIRE_FALSE(step(body, inputs({poke(0, 0, 1, 0.6)}))->solves());
  CHECK(body.state() == after);

  // A solve elsewhere that overlaps keeps the velocity of nodes inside it and resets all others.
  const auto second = step(body, inputs({poke(2, 0, 0)})).value();
  REQUIRE(second.solves());
  const Box& region = second.selection.box();
  GridBody expected(s.grid, s.rest, {});
  BodyState start = after;
  for (int j = 0; j < s.grid.rows; ++j) {
    for (int i = 0; i < s.grid.columns; ++i) {
      if (!region.contains(i, j)) start.velocities.row(s.grid.node(i, j)).setZero();
    }
  }
  expected.restore(start);
  REQUIRE(step(expected, inputs({poke(2, 0, 0)}))->solves());
  CHECK(expected.state() == body.state());

  // Nodes outside the second region are frozen and have no velocity.
  int frozen = 0;
  for (int j = 0; j < s.grid.rows; ++j) {
    for (int i = 0; i < s.grid.columns; ++i) {
      const int node = s.grid.node(i, j);
      if (region.contains(i, j)) continue;
      CHECK(body.state().positions.row(node) == after.positions.row(node));
      CHECK(body.state().velocities.row(node).isZero(0));
      frozen += after.positions.row(node) != s.rest.row(node);
    }
  }
  CHECK(frozen > 0);
}

TEST_CASE("a body released under reference=\"rest\" comes back to rest", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {});
  for (int frame = 0; frame < 10; ++frame) REQUIRE(step(body, inputs({poke(0, 0, 200)}))->solves());
  const double pressed = peak(body);
  CHECK(pressed > 1e-4);
  SECTION("in one static frame") {
    BodyInputs release = inputs({poke(0, 0, 0)});
    release.dynamics = {0, 0};
    REQUIRE(step(body, release)->solves());
    CHECK(peak(body) < 1e-12 * pressed);
  }
  SECTION("in time") {
    for (int frame = 0; frame < 400; ++frame) REQUIRE(step(body, inputs({poke(0, 0, 0)})));
    CHECK(peak(body) < 1e-9 * pressed);
  }
}

TEST_CASE("reference=\"none\" smooths relief away without any load", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {.reference = Reference::None});
  BodyInputs in = inputs({poke(0, 0, 0)});
  in.dynamics = {0, 0};
  REQUIRE(step(body, in)->solves());
  CHECK(peak(body) > 0.1);
  // On a flat sheet with its own slopes as tangents there is nothing to smooth.
  const Sheet flat = sheet();
  GridBody flat_body(flat.grid, flat.rest, {.reference = Reference::None});
  in.tangents.su0 = in.tangents.su1 = {16, 0, 0};  // x runs over 16 while u runs over 1
  in.tangents.sv0 = in.tangents.sv1 = {0, 0, 16};
  REQUIRE(step(flat_body, in)->solves());
  CHECK(peak(flat_body) < 1e-11);
}

TEST_CASE("superposition holds on a fixed region", "[body]") {
  const Sheet s = relief();
  // A force of magnitude 0 selects the region; measure="rest" keeps every box in place.
  const auto moved = [&](std::vector<SampledForce> forces) {
    forces.push_back(poke(0, 0, 0, 100));
    GridBody body(s.grid, s.rest, {.measure = Measure::Rest});
    for (int frame = 0; frame < 6; ++frame) REQUIRE(step(body, inputs(forces))->solves());
    return Field(body.state().positions - s.rest);
  };
  const SampledForce a = poke(-3, 1, 900),
                     b{RadialForce{{2, -1, 3}}, -700, 1, 4, Falloff::Gaussian};
  const Field both = moved({a, b});
  CHECK((moved({a}) + moved({b}) - both).cwiseAbs().maxCoeff() <
        1e-12 * both.cwiseAbs().maxCoeff());
}

TEST_CASE("swapping u with v and b with d mirrors the motion", "[body]") {
  // The mirror swaps x with z and node (i,j) with (j,i).
  const auto mirrored = [](const Field& field, const Grid& grid) {
    Field image(field.rows(), 3);
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        image.row(grid.node(j, i)) << field(grid.node(i, j), 2), field(grid.node(i, j), 1),
            field(grid.node(i, j), 0);
      }
    }
    return image;
  };
  const Sheet s = relief();
  const Sheet m{s.grid, mirrored(s.rest, s.grid)};
  GridBody body(s.grid, s.rest, {}), image(m.grid, m.rest, {});
  BodyInputs in = inputs({{PointForce{{1, 0, -2}, {0.3, 1, -0.2}}, 2000, 5.5, 3, Falloff::Smooth}});
  in.stiffness = {1.5, 0.5, 3};
  in.tangents.su0 = {1, 2, 3};
  in.tangents.sv1 = {0, 4, -1};
  BodyInputs in_image =
      inputs({{PointForce{{-2, 0, 1}, {-0.2, 1, 0.3}}, 2000, 5.5, 3, Falloff::Smooth}});
  in_image.stiffness = {3, 0.5, 1.5};
  in_image.tangents.sv0 = {3, 2, 1};
  in_image.tangents.su1 = {-1, 4, 0};
  for (int frame = 0; frame < 8; ++frame) {
    REQUIRE(step(body, in)->solves());
    REQUIRE(step(image, in_image)->solves());
  }
  const Field difference = mirrored(body.state().positions, s.grid) - image.state().positions;
  CHECK(difference.cwiseAbs().maxCoeff() < 1e-11 * peak(body));
}

TEST_CASE("rest measure keeps hold of nodes that a strong force pushes away", "[body]") {
  const Sheet s = sheet();
  const SampledForce strong = poke(0, 0, 1e7);
  GridBody current(s.grid, s.rest, {}), rest(s.grid, s.rest, {.measure = Measure::Rest});
  bool was_lost = false;
  for (int frame = 0; frame < 6; ++frame) {
    const auto report = step(current, inputs({strong})).value();
    was_lost = was_lost || report.selection.forces[0].is_lost;
    CHECK(step(rest, inputs({strong}))->solves());
    CHECK_FALSE(step(rest, inputs({strong}))->selection.forces[0].is_lost);
  }
  CHECK(was_lost);
}

TEST_CASE("a force beyond the surface is not one that lost its nodes", "[body]") {
  const Sheet s = sheet();
  GridBody body(s.grid, s.rest, {});
  const auto report = step(body, inputs({poke(0, 0), poke(100, 0)})).value();
  CHECK(report.solves());
  for (const ForceSelection& force : report.selection.forces) CHECK_FALSE(force.is_lost);
}

TEST_CASE("reset clears what was carried", "[body]") {
  const Sheet s = relief();
  GridBody body(s.grid, s.rest, {});
  REQUIRE(step(body, inputs({poke(0, 0)}))->solves());
  const BodyState first = body.state();
  REQUIRE(step(body, inputs({poke(1, 0)}))->solves());
  body.reset();
  CHECK(body.state().positions == s.rest);
  CHECK(body.state().velocities.isZero(0));
  REQUIRE(step(body, inputs({poke(0, 0)}))->solves());
  CHECK(body.state() == first);
}

TEST_CASE("a state that stops being finite is an error, not a state", "[body]") {
  const Sheet s = sheet();
  GridBody body(s.grid, s.rest, {});
  BodyInputs in = inputs({poke(0, 0, 1e308)});
  in.dynamics = {0, 0};
  in.stiffness = {1e-10, 2e-10, 1e-10};
  const auto report = step(body, in);
  REQUIRE_FALSE(report);
  CHECK(report.error().code == ErrorCode::NotFinite);
  CHECK(body.state().positions == s.rest);
}

TEST_CASE("one factorization serves all frames of one material and region", "[body]") {
  const Sheet s = sheet();
  GridBody body(s.grid, s.rest, {.measure = Measure::Rest});
  BodyInputs in = inputs({poke(0, 0, 10)});
  for (int frame = 0; frame < 240; ++frame) {
    in.forces[0].magnitude = frame;
    REQUIRE(step(body, in)->solves());
  }
  CHECK(body.solver_counts().analyses == 1);
  CHECK(body.solver_counts().factorizations == 1);
  CHECK(body.solver_counts().solves == 240 * 5);
  in.dynamics.density = 41;
  REQUIRE(step(body, in)->solves());
  CHECK(body.solver_counts().analyses == 1);
  CHECK(body.solver_counts().factorizations == 2);
}
