#include "pliant/scene/checks/channel_check.hpp"

#include <limits>
#include <string>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::StartsWith;

namespace {

std::string complaint(const Scene& scene) {
  const auto errors = check_channels(scene);
  return errors.empty() ? "none" : errors.front().message;
}

}  // namespace

TEST_CASE("a sound scene has nothing to complain about", "[scene][channels]") {
  CHECK(complaint(scene({sheet("s")}, {poke("f", {0, 0, 0})})) == "none");
}

TEST_CASE("each channel's rule is checked at each frame of the range", "[scene][channels]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})}, 24);
  Surface& surface = s.surfaces[0];
  Force& force = s.forces[0];
  // Valid at both ends of the range, invalid in the middle.
  const Channel<1> dips = curve({{1, 1}, {12, -1}, {24, 1}});
  std::string expected;
  SECTION("density") {
    surface.material.density = dips;
    expected = "s.density at frame 7 is -";
  }
  SECTION("damping") {
    surface.material.damping = dips;
    expected = "s.damping at frame 7 is -";
  }
  SECTION("b") {
    surface.material.b = dips;
    expected = "s.b at frame 7 is -";
  }
  SECTION("d") {
    surface.material.d = dips;
    expected = "s.d at frame 7 is -";
  }
  SECTION("c") {
    surface.material.c = curve({{1, 0}, {12, -4}, {24, 0}});
    surface.material.b = 4.0;
    expected = "s.c at frame 12 is -4, but must be greater than -2 sqrt(b d) = -4 (b = 4, d = 1)";
  }
  SECTION("dt") {
    surface.solver.dt = dips;
    expected = "s.dt at frame 7 is -";
  }
  SECTION("dt too small") {
    surface.solver.dt = 4e-8;
    expected = "s.dt is 4e-08, which makes 1041667 steps";
  }
  SECTION("scale") {
    surface.transform.scale = vector_curve({{1, {1, 1, 1}}, {9, {1, 0, 1}}, {24, {1, 1, 1}}});
    expected = "s.scale at frame 9 is 1 0 1, but must not be 0";
  }
  SECTION("a scale that is too small") {
    surface.transform.scale = vector_curve({{1, {1, 1, 1}}, {9, {1, 1, 1e-320}}, {24, {1, 1, 1}}});
    expected = "s.scale at frame 9 is 1 1 1e-320, but must not be 0, nor so near 0";
  }
  SECTION("a tangent where nodes recover") {
    surface.solver.release = Release::Recover;
    surface.tangents.sv0 = curve({{1, 0}, {4, 0}, {12, 3}, {24, 0}});
    expected = "s.sv0 at frame 5 is 0.";
  }
  SECTION("a tangent of three numbers where nodes recover") {
    surface.solver.release = Release::Recover;
    surface.tangents.su1 = Channel<3>(Value<3>{0, 0, -2});
    expected = "s.su1 is 0 0 -2, but must be 0 with release=\"recover\"";
  }
  SECTION("deformation radius") {
    force.deformation_radius = dips;
    expected = "f.deformationRadius at frame 7 is -";
  }
  SECTION("force radius") {
    force.force_radius = dips;
    expected = "f.forceRadius at frame 7 is -";
  }
  SECTION("not finite") {
    force.magnitude = -std::numeric_limits<double>::infinity();
    expected = "f.magnitude is -inf, which is not finite";
  }
  CHECK_THAT(complaint(s), StartsWith(expected));
  CHECK(check_channels(s).size() == 1);
}

TEST_CASE("a static surface that is solved as a whole needs edges that hold it",
          "[scene][channels]") {
  constexpr Edge clamped = Edge::Clamped, pinned = Edge::Pinned, open = Edge::Free;
  Scene s = scene({sheet("s")}, {}, 24);
  Surface& surface = s.surfaces[0];
  surface.solver.region = SolvedRegion::All;
  surface.material.damping = 0.0;
  surface.material.density = 0.0;
  for (const Edges& edges : {Edges{clamped, open, open, open}, Edges{pinned, open, pinned, open}}) {
    surface.solver.edges = edges;
    CHECK(complaint(s) == "none");
  }
  for (const Edges& edges : {Edges{open, open, open, open}, Edges{open, open, open, pinned}}) {
    surface.solver.edges = edges;
    CHECK_THAT(complaint(s), StartsWith("s.density is 0, and so is damping, but nothing holds"));
  }
  surface.material.density = curve({{1, 1}, {12, 0}, {24, 1}});
  CHECK_THAT(complaint(s), StartsWith("s.density at frame 12 is 0, and so is damping"));
  surface.solver.start_frame = 13;
  CHECK(complaint(s) == "none");
  surface.solver.start_frame = {};
  surface.solver.time_scale = curve({{1, 1}, {11, 1}, {12, 0}, {13, 1}});
  CHECK(complaint(s) == "none");
  surface.solver.time_scale = 1.0;
  surface.enabled = false;
  CHECK(complaint(s) == "none");
}

TEST_CASE("what happens outside the range is no matter", "[scene][channels]") {
  Scene s = scene({sheet("s")}, {}, 5);
  s.surfaces[0].material.density = curve({{1, 1}, {5, 1}, {20, -100}});
  CHECK(complaint(s) == "none");
}

TEST_CASE("a channel's error has the line where it was written", "[scene][channels]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.origin = origin_of("a.xml", {{"f", 9}, {"s", 3}, {"s.density", 5}});
  s.surfaces[0].material.density = -1.0;
  s.forces[0].force_radius = -1.0;
  const auto errors = check_channels(s);
  REQUIRE(errors.size() == 2);
  CHECK(to_lines(errors[0]).front() == "a.xml:5: error: s.density is -1, but must be at least 0");
  CHECK(errors[1].line == 9);
}
