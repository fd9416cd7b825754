#include <algorithm>

#include "body/sheets.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Boxes are measured at rest, so that they stay in place for any force.
GridBody body_with(const NodeSheet& s, Combine how) {
  return GridBody(s.grid, s.rest, {.measure = Measure::Rest, .combine = how});
}

BodyInputs with_tangents(BodyInputs in) {
  in.tangents.su0 = {0, 3, 0};
  in.tangents.su1 = {1, 0, 0};
  in.tangents.sv1 = {0, 0, -2};
  return in;
}

}  // namespace

TEST_CASE("islands that do not meet are as if each were alone, to the bit", "[body][islands]") {
  const NodeSheet s = hilly_sheet(41, 21);
  const SampledForce a = press(-10, 0, 3e4), b = press(9, 2, -5e4, 4.5);
  GridBody both = body_with(s, Combine::Islands), first = body_with(s, Combine::Box),
           second = body_with(s, Combine::Box);
  for (int frame = 0; frame < 12; ++frame) {
    const auto report = step(both, with_tangents(inputs_of({a, b}))).value();
    REQUIRE(report.selection.regions.size() == 2);
    REQUIRE(step(first, with_tangents(inputs_of({a})))->solves());
    REQUIRE(step(second, with_tangents(inputs_of({b})))->solves());
  }
  const Field moved = first.state().positions - s.rest;
  for (int node = 0; node < s.grid.node_count(); ++node) {
    const Body& alone = moved.row(node).isZero(0) ? second : first;
    REQUIRE(both.state().positions.row(node) == alone.state().positions.row(node));
    REQUIRE(both.state().velocities.row(node) == alone.state().velocities.row(node));
  }
  CHECK(both.solver_counts().factorizations == 2);  // for all frames
}

TEST_CASE("islands of one size share a factor", "[body][islands]") {
  const NodeSheet s = flat_sheet(41, 21);
  GridBody body = body_with(s, Combine::Islands);
  for (int frame = 0; frame < 6; ++frame) {
    const auto report = step(body, inputs_of({press(-10, 0, 3e4), press(10, 0, 3e4)})).value();
    REQUIRE(report.unknown_count() == 2 * 5 * 5);
  }
  CHECK(body.solver_counts().factorizations == 1);
}

TEST_CASE("boxes that meet are one island, solved as a box", "[body][islands]") {
  const NodeSheet s = hilly_sheet(31, 31);
  const std::vector<SampledForce> forces{press(-3, 0, 3e4), press(2, 4, -5e4, 4.5)};
  GridBody islands = body_with(s, Combine::Islands), box = body_with(s, Combine::Box);
  for (int frame = 0; frame < 8; ++frame) {
    REQUIRE(step(islands, with_tangents(inputs_of(forces)))->solves());
    REQUIRE(step(box, with_tangents(inputs_of(forces)))->solves());
  }
  CHECK(islands.state() == box.state());
}

TEST_CASE("an island that is too small is skipped alone", "[body][islands]") {
  const NodeSheet s = flat_sheet(41, 21);
  GridBody both = body_with(s, Combine::Islands), alone = body_with(s, Combine::Islands);
  const SampledForce large = press(-10, 0, 3e4), small = press(10, 0, 3e4, 1);
  const auto report = step(both, inputs_of({large, small})).value();
  CHECK(report.solves());
  CHECK_FALSE(report.selection.patches_of_force(0).empty());
  CHECK(report.selection.patches_of_force(1).empty());
  REQUIRE(step(alone, inputs_of({large})));
  CHECK(both.state() == alone.state());
}

TEST_CASE("velocity is carried per node over all islands", "[body][islands]") {
  const NodeSheet s = flat_sheet(41, 21);
  const SampledForce a = press(-10, 0, 3e4), b = press(10, 0, -5e4);
  GridBody body = body_with(s, Combine::Islands);
  REQUIRE(step(body, inputs_of({a, b})));
  const BodyState after = body.state();
  // A solve of one island continues with its velocity, and resets the velocity of the other island.
  REQUIRE(step(body, inputs_of({b})));
  GridBody expected = body_with(s, Combine::Islands);
  BodyState start = after;
  for (int node = 0; node < s.grid.node_count(); ++node) {
    if (s.rest(node, 0) < 0) start.velocities.row(node).setZero();
  }
  CHECK(start.velocities != after.velocities);
  expected.restore(start);
  REQUIRE(step(expected, inputs_of({b})));
  CHECK(body.state() == expected.state());
  CHECK(body.state().velocities.topRows(20).isZero(0));
}

TEST_CASE("a union that is a box is solved as that box, to the bit", "[body][union]") {
  const NodeSheet s = hilly_sheet(31, 21);
  const std::vector<SampledForce> forces{press(-2, 0, 3e4), press(1, 0, -5e4)};  // adjacent
  GridBody one = body_with(s, Combine::Union), box = body_with(s, Combine::Box);
  for (int frame = 0; frame < 8; ++frame) {
    REQUIRE(step(one, with_tangents(inputs_of(forces)))->solves());
    REQUIRE(step(box, with_tangents(inputs_of(forces)))->solves());
  }
  CHECK(one.state() == box.state());
}

TEST_CASE("only the interior of a union moves", "[body][union]") {
  const NodeSheet s = hilly_sheet(31, 31);
  GridBody body = body_with(s, Combine::Union);
  const auto report = step(body, inputs_of({press(-4, -4, 3e4, 5), press(3, 4, 5e4, 6)})).value();
  REQUIRE(report.selection.regions.size() == 1);
  REQUIRE(report.selection.regions[0].patches.size() == 1);
  const Patch& patch = report.selection.regions[0].patches[0];
  CHECK_FALSE(patch.is_rectangle());
  for (int j = 0; j < 31; ++j) {
    for (int i = 0; i < 31; ++i) {
      const int node = s.grid.node(i, j);
      CHECK((body.state().positions.row(node) != s.rest.row(node)) == patch.holds(i, j));
      CHECK((!body.state().velocities.row(node).isZero(0)) == patch.holds(i, j));
    }
  }
}

TEST_CASE("parts of a union that do not touch are solved as boxes, with tangents at the ends only",
          "[body][union]") {
  const NodeSheet s = flat_sheet(41, 21);
  const SampledForce left = press(-10, 0, 3e4), right = press(10, 3, -5e4);
  BodyInputs in = inputs_of({left, right});
  in.tangents.su0 = {0, 30, 0};
  GridBody both = body_with(s, Combine::Union), first = body_with(s, Combine::Box),
           second = body_with(s, Combine::Box);
  REQUIRE(step(both, in));
  in.forces = {left};
  REQUIRE(step(first, in));
  in.tangents = {};
  in.forces = {right};
  REQUIRE(step(second, in));
  for (int node = 0; node < s.grid.node_count(); ++node) {
    const Body& alone = s.rest(node, 0) < 0 ? first : second;
    REQUIRE(both.state().positions.row(node) == alone.state().positions.row(node));
  }
}

TEST_CASE("the order of forces changes nothing but last bits", "[body]") {
  const NodeSheet s = hilly_sheet(31, 31);
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  std::vector<SampledForce> forces{press(-4, -4, 3e4, 5), press(3, 4, 5e4, 6), press(11, -9, 2e4),
                                   press(-3, -5, -2e4, 2)};
  GridBody body = body_with(s, how), other = body_with(s, how);
  for (int frame = 0; frame < 6; ++frame) {
    REQUIRE(step(body, inputs_of(forces)));
    auto turned = forces;
    std::rotate(turned.begin(), turned.begin() + 1 + frame % 3, turned.end());
    REQUIRE(step(other, inputs_of(turned)));
  }
  CHECK((body.state().positions - other.state().positions).cwiseAbs().maxCoeff() <
        1e-12 * peak_of(body));
}

TEST_CASE("a node beyond double in world space is an error, not a force that selects nothing",
          "[body]") {
  const NodeSheet s = flat_sheet(9, 9);
  GridBody body = body_with(s, Combine::Box);
  BodyInputs in = inputs_of({press(0, 0, 1)});
  in.transform.linear(0, 0) = 1e308;
  const auto report = step(body, in);
  REQUIRE_FALSE(report);
  CHECK(report.error().code == ErrorCode::NotFinite);
  CHECK(body.look(in).error().message == report.error().message);
}

TEST_CASE("a frame is taken whole or not at all", "[body][islands]") {
  // Three islands of different sizes, and nodes that settle before the solve.
  const NodeSheet s = hilly_sheet(61, 21);
  const std::vector<SampledForce> wide{press(-20, 0, 3e4, 5.5), press(0, 1, 4e4, 6.5),
                                       press(20, 0, -5e4, 4.5)};
  const std::vector<SampledForce> narrow{press(-20, 0, 3e4), press(0, 1, 4e4, 4.5),
                                         press(20, 0, -5e4, 2.5)};
  const auto release = GENERATE(Release::Freeze, Release::Recover);
  const BodySettings settings{
      .measure = Measure::Rest, .combine = Combine::Islands, .release = release};
  int patience = -1, asked = 0;
  GridBody body(s.grid, s.rest, settings, SolverChoice::Auto,
                {.should_stop = [&] { return asked++ == patience; }});
  REQUIRE(step(body, inputs_of(wide)));
  REQUIRE(step(body, inputs_of(wide)));
  GridBody uninterrupted(s.grid, s.rest, settings);
  uninterrupted.restore(body.state());
  REQUIRE(step(uninterrupted, inputs_of(narrow)));

  const BodyState before = body.state();
  int interrupted = 0;
  for (patience = 0;; ++patience) {
    asked = 0;
    const auto report = step(body, inputs_of(narrow));
    if (report) break;
    REQUIRE(report.error().code == ErrorCode::Interrupted);
    REQUIRE(body.state() == before);
    ++interrupted;
  }
  CHECK(interrupted >= 3);  // in each island
  patience = -1;
  CHECK(body.state() == uninterrupted.state());

  // The last island overflows a double, the others do not.
  const BodyState sound = body.state();
  std::vector<SampledForce> boundless = narrow;
  boundless[2].magnitude = 1e308;
  boundless.push_back(boundless[2]);
  const auto failed = step(body, inputs_of(boundless));
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::NotFinite);
  CHECK(body.state() == sound);
}

TEST_CASE("a step in the memory of an earlier one is the same step", "[body][islands]") {
  const NodeSheet s = hilly_sheet(41, 21);
  const auto how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  const auto release = GENERATE(Release::Freeze, Release::Recover);
  const BodySettings settings{.combine = how, .release = release};
  GridBody body(s.grid, s.rest, settings);
  for (int frame = 0; frame < 24; ++frame) {
    // Appears, stays, moves and disappears; sometimes with a second one.
    std::vector<SampledForce> forces;
    if (frame % 8 < 5) forces.push_back(press(-10 + frame / 4, 0, 3e4));
    if (frame % 6 < 4) forces.push_back(press(-4, 2, -2e4, 4.5));
    GridBody fresh(s.grid, s.rest, settings);  // has no memory of earlier frames
    fresh.restore(body.state());
    const auto expected = step(fresh, inputs_of(forces)).value();
    const auto former = step(body, inputs_of(forces)).value();
    REQUIRE(former.selection == expected.selection);
    REQUIRE(former.recovering == expected.recovering);
    REQUIRE(former.settling == expected.settling);
    REQUIRE(body.state() == fresh.state());
  }
}

TEST_CASE("a step after one that a force's function ended selects anew", "[body]") {
  const NodeSheet s = hilly_sheet(41, 21);
  bool throws = false;
  SampledForce function = press(0, 4, 3e4);
  function.kind = SampledCustomForce{[&](const Vector3d& p) {
                                       if (throws) throw 1;
                                       return (p - Vector3d(0, 0, 4)).norm();
                                     },
                                     [](const Vector3d&) { return Vector3d(0, 1, 0); }};
  GridBody body(s.grid, s.rest, {});
  REQUIRE(step(body, inputs_of({press(-10, 0, 3e4), function})));
  const BodyInputs moved = inputs_of({press(10, 0, 3e4), function});
  throws = true;
  CHECK_THROWS(step(body, moved));  // after it selected for the first force
  throws = false;
  GridBody fresh(s.grid, s.rest, {});
  fresh.restore(body.state());
  const auto expected = step(fresh, moved).value();
  CHECK(step(body, moved)->selection == expected.selection);
  CHECK(body.state() == fresh.state());
}
