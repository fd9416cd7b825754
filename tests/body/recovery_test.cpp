#include "pliant/body/recovery.hpp"

#include <algorithm>
#include <cmath>

#include "body/sheets.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

GridBody body_with(const NodeSheet& s, Release release, Combine how = Combine::Box,
                   Measure measure = Measure::Rest) {
  return GridBody(s.grid, s.rest, {.measure = measure, .combine = how, .release = release});
}

bool is_inside(const Region& inner, const std::vector<Region>& outer) {
  return std::any_of(outer.begin(), outer.end(), [&](const Region& region) {
    return intersection(region.box, inner.box) == inner.box;
  });
}

}  // namespace

TEST_CASE("what a force leaves recovers to rest, to the bit; frozen it stays", "[body][recover]") {
  const NodeSheet s = hilly_sheet(31, 21);
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  const Dynamics dynamics{4000, 40000};
  GridBody recovering = body_with(s, Release::Recover, how),
           frozen = body_with(s, Release::Freeze, how);
  for (int frame = 0; frame < 10; ++frame) {
    BodyInputs in = inputs_of({press(frame - 8, 0, 2e5), press(frame - 8, 8, 1e5, 2.5)});
    in.dynamics = dynamics;
    REQUIRE(step(recovering, in)->solves());
    REQUIRE(step(frozen, in)->solves());
  }
  REQUIRE(peak_of(recovering) > 0.1);
  const BodyState trail = frozen.state();
  int frames = 0;
  BodyInputs nothing = inputs_of({});
  nothing.dynamics = dynamics;
  while (step(recovering, nothing)->solves()) REQUIRE(++frames < 1000);
  CHECK(frames > 3);
  CHECK(recovering.state().positions == s.rest);
  CHECK(recovering.state().velocities.isZero(0));
  for (int frame = 0; frame < 5; ++frame) REQUIRE(step(frozen, inputs_of({})));
  CHECK(frozen.state() == trail);
  CHECK(peak_of(frozen) > 0.1);
}

TEST_CASE("without forces regions never grow, and nodes outside them are at rest",
          "[body][recover]") {
  const NodeSheet s = hilly_sheet(31, 31);
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  // Little damping, so that it rings and nodes pass 0 again and again.
  GridBody body = body_with(s, Release::Recover, how);
  BodyInputs in = inputs_of({press(-6, -5, 2e5), press(-1, 1, -3e5, 4.5), press(9, 9, 1e5)});
  in.dynamics = {4000, 8000};
  for (int frame = 0; frame < 6; ++frame) REQUIRE(step(body, in)->solves());
  in.forces = {press(-6, -5, 0)};  // moves on: its region excludes the others' nodes
  REQUIRE(!step(body, in)->recovering.empty());
  in.forces.clear();
  std::vector<Region> before;
  int frames = 0, shrunk = 0;
  while (true) {
    const auto report = step(body, in).value();
    if (!report.solves()) break;
    REQUIRE(++frames < 3000);
    for (const Region& region : report.selection.regions) {
      if (!before.empty()) REQUIRE(is_inside(region, before));
      // The rim is at rest, so no displacement of the rim keeps the interior away from rest.
      for (const Patch& patch : region.patches) {
        for (int i = patch.box.i0; i <= patch.box.i1; ++i) {
          REQUIRE(body.state().positions.row(s.grid.node(i, patch.box.j0)) ==
                  s.rest.row(s.grid.node(i, patch.box.j0)));
        }
      }
    }
    shrunk += report.selection.regions != before;
    before = report.selection.regions;
  }
  CHECK(shrunk > 2);
  CHECK(body.state().positions == s.rest);
}

TEST_CASE("recovery ends without damping and without inertia too", "[body][recover]") {
  const NodeSheet s = flat_sheet(15, 15);
  GridBody body = body_with(s, Release::Recover);
  BodyInputs in = inputs_of({press(0, 0, 2e5)});
  in.dynamics = GENERATE(Dynamics{0, 0}, Dynamics{40, 0}, Dynamics{0, 4000});
  for (int frame = 0; frame < 5; ++frame) REQUIRE(step(body, in)->solves());
  in.forces.clear();
  int frames = 0;
  while (step(body, in)->solves()) REQUIRE(++frames < 2000);
  CHECK(body.state().positions == s.rest);
}

TEST_CASE("a node that leaves and is at rest already is let go at once", "[body][recover]") {
  const NodeSheet s = flat_sheet(21, 21);
  GridBody body = body_with(s, Release::Recover);
  REQUIRE(step(body, inputs_of({press(0, 0, 0)}))->solves());
  const auto report = step(body, inputs_of({})).value();
  CHECK_FALSE(report.solves());
  CHECK(report.settling.empty());
  // Moved, but by less than a millionth of the region.
  REQUIRE(step(body, inputs_of({press(0, 0, 1e-3)}))->solves());
  REQUIRE(peak_of(body) > 0);
  const auto next = step(body, inputs_of({})).value();
  CHECK_FALSE(next.solves());
  CHECK(next.settling.size() == 25);
  CHECK(body.state().positions == s.rest);
  CHECK(body.state().velocities.isZero(0));
}

TEST_CASE("a recovering node counts as selected, with its neighbours", "[body][recover]") {
  const NodeSheet s = flat_sheet(31, 21);
  GridBody body = body_with(s, Release::Recover);
  const auto pressed = step(body, inputs_of({press(-8, 0, 2e5)})).value();
  const Box first = pressed.selection.box();
  REQUIRE(first == Box{4, 10, 7, 13});
  const auto report = step(body, inputs_of({press(8, 0, 2e5)})).value();
  CHECK(report.recovering.size() == 25);  // all nodes that moved
  CHECK(report.selection.box() == Box{4, 26, 7, 13});
  CHECK(report.selection.forces[0].deformation == Box{20, 26, 7, 13});
}

TEST_CASE("the state that is restored goes on in the same way", "[body][recover]") {
  const NodeSheet s = hilly_sheet(21, 21);
  GridBody body = body_with(s, Release::Recover, Combine::Islands, Measure::Current);
  for (int frame = 0; frame < 5; ++frame) REQUIRE(step(body, inputs_of({press(-3, 0, 2e5)})));
  const BodyState kept = body.state();
  GridBody other = body_with(s, Release::Recover, Combine::Islands, Measure::Current);
  other.restore(kept);
  for (int frame = 0; frame < 20; ++frame) {
    REQUIRE(step(body, inputs_of({press(4, 2, 1e5, 2.5)})));
    REQUIRE(step(other, inputs_of({press(4, 2, 1e5, 2.5)})));
  }
  CHECK(other.state() == body.state());
  body.reset();
  CHECK_FALSE(step(body, inputs_of({}))->solves());
}

TEST_CASE("a step that fails leaves what would have settled as it was", "[body][recover]") {
  const NodeSheet s = flat_sheet(21, 21);
  GridBody body = body_with(s, Release::Recover);
  REQUIRE(step(body, inputs_of({press(0, 0, 1e-3)})));
  const BodyState before = body.state();
  BodyInputs in = inputs_of({press(6, 6, 1e308)});
  in.dynamics = {0, 0};
  in.stiffness = {1e-10, 2e-10, 1e-10};
  REQUIRE_FALSE(step(body, in));
  CHECK(body.state() == before);
}

TEST_CASE("the settling length is a millionth of the region's diagonal", "[body][recover]") {
  NodeSheet s = flat_sheet(9, 9);
  s.rest(s.grid.node(4, 4), 1) = 12;
  const auto length = [&](const Region& region) { return settling_length(s.grid, s.rest, region); };
  CHECK_THAT(length({{1, 4, 2, 6}, {{1, 4, 2, 6}}}), WithinRel(13e-6, 1e-15));  // 3, 12, 4
  CHECK_THAT(length({{0, 3, 0, 4}, {{0, 3, 0, 4}}}), WithinRel(5e-6, 1e-15));
  CHECK_THAT(length({{0, 4, 0, 4}, {{0, 4, 0, 1}, {0, 1, 0, 4}}}),
             WithinRel(4e-6 * std::sqrt(2.0), 1e-15));
  CHECK(length({{0, 4, 0, 4}, {{0, 4, 0, 4}}}) > 12e-6);  // the same box, its corner inside
}
