#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// `timeScale` and the integrators, in scenes.

namespace {

Force inertia() {
  Force force = poke("sway", {});
  force.kind = InertiaChannels{};
  force.magnitude = 1;
  force.deformation_radius = force.force_radius = 100;
  return force;
}

// The key's value holds up to the next one.
Curve<1> held(std::vector<std::pair<double, double>> keys) {
  CurveKeys<1> curve;
  for (const auto& [frame, value] : keys) {
    Key<1> key{.frame = frame, .value = {value}};
    key.next.kind = Interpolation::Kind::Step;
    curve.keys.push_back(key);
  }
  return Curve<1>::make(std::move(curve)).value();
}

Scene swaying(Integrator integrator) {
  Scene s = scene({sheet("s")}, {poke("p", {1.5, 0, -2}), inertia()});
  s.surfaces[0].transform.translate =
      vector_curve({{1, {0, 0, 0}}, {5, {0, 3, 1}}, {9, {0, 0, 0}}});
  s.surfaces[0].solver.integrator = integrator;
  return s;
}

}  // namespace

TEST_CASE("a surface at half its speed is that of twice the frame rate, to the bit",
          "[simulation][time]") {
  const Scene plain =
      swaying(GENERATE(Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact));
  Scene slow = plain, fine = plain;
  slow.surfaces[0].solver.time_scale = 0.5;
  fine.fps = 2 * plain.fps;
  CHECK(baked(slow, "s") == baked(fine, "s"));
  CHECK(baked(slow, "s") != baked(plain, "s"));
}

TEST_CASE("a surface that is halted goes on with its velocity", "[simulation][time]") {
  Scene plain = scene({sheet("s")}, {poke("p", {1.5, 0, -2})});
  plain.surfaces[0].solver.integrator = GENERATE(Integrator::BackwardEuler, Integrator::Exact);
  Scene halted = plain;
  halted.surfaces[0].solver.time_scale = held({{1, 1}, {4, 0}, {7, 1}});
  const auto expected = baked(plain, "s"), frames = baked(halted, "s");
  for (int frame = 1; frame <= 12; ++frame) {
    CAPTURE(frame);
    const int reached = frame <= 4 ? frame : frame <= 7 ? 4 : frame - 3;
    CHECK(frames[frame - 1] == expected[reached - 1]);
  }
}

TEST_CASE("a frame too short for anything to move halts a surface", "[simulation][time]") {
  const Integrator integrator =
      GENERATE(Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact);
  Scene carried = swaying(integrator);  // inertia divides by the square of the frame's length
  Scene pushed = scene({sheet("s")}, {poke("p", {1.5, 0, -2})});
  pushed.surfaces[0].solver.integrator = integrator;
  for (const double scale : {0.0, 5e-324, 1e-300, 1e-160, 1e-40, 1e-28, 1e-12}) {
    CAPTURE(scale);
    carried.surfaces[0].solver.time_scale = pushed.surfaces[0].solver.time_scale = scale;
    for (const Scene& s : {carried, pushed}) {
      auto simulation = Simulation::make(s).value();
      CHECK(simulation.at(12));
      CHECK(preview_forces(s, simulation.rest_shapes()));
      // It is not one that starts too late.
      for (const Warning& warning : simulation.warnings()) {
        CHECK(warning.kind != Warning::Kind::NeverStarts);
      }
    }
    CHECK(peak(baked(pushed, "s")) < 1e-9);
  }
}

TEST_CASE("steps are counted in a surface's own time", "[simulation][time]") {
  Scene s = scene({sheet("s")}, {poke("p", {0, 0, 0})});
  s.surfaces[0].solver.dt = 1e-5;
  CHECK(Simulation::make(s));
  s.surfaces[0].solver.time_scale = 30;
  const auto refused = Simulation::make(s);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("s.dt is 1e-05") && Contains("125000 steps"));
  s.surfaces[0].solver.time_scale = 0;
  CHECK(Simulation::make(s));
}

TEST_CASE("without density Newmark's steps are those of backward Euler", "[simulation][time]") {
  Scene euler = scene({sheet("s")}, {poke("p", {1.5, 0, -2})});
  Scene newmark = euler;
  newmark.surfaces[0].solver.integrator = Integrator::Newmark;
  CHECK(baked(euler, "s") != baked(newmark, "s"));
  euler.surfaces[0].material.density = newmark.surfaces[0].material.density = 0;
  CHECK(baked(euler, "s") == baked(newmark, "s"));
}

TEST_CASE("dt and stepping change no bit of the exact solution", "[simulation][time][exact]") {
  Scene plain = swaying(Integrator::Exact);
  plain.surfaces[0].solver.combine = GENERATE(Combine::Box, Combine::Union);
  const auto expected = baked(plain, "s");
  Scene other = plain;
  other.surfaces[0].solver.dt = 0.0007;
  other.surfaces[0].solver.stepping = Stepping::Overshoot;
  CHECK(baked(other, "s") == expected);
  other.surfaces[0].solver.integrator = Integrator::BackwardEuler;
  CHECK(baked(other, "s") != expected);
  // They are checked all the same.
  other.surfaces[0].solver.integrator = Integrator::Exact;
  other.surfaces[0].solver.dt = 1e-9;
  CHECK_FALSE(Simulation::make(other));
}

TEST_CASE("steps of half the length show what the exact solution leaves",
          "[simulation][time][exact]") {
  const Scene s = swaying(Integrator::Exact);
  SimulationOptions halves;
  halves.exact_parts = 2;
  auto whole = Simulation::make(s).value(), half = Simulation::make(s, halves).value();
  double largest = 0, apart = 0;
  for (int frame = 1; frame <= 12; ++frame) {
    const Field a = whole.at(frame)->surfaces()[0].positions();
    const Field b = half.at(frame)->surfaces()[0].positions();
    apart = std::max(apart, (a - b).cwiseAbs().maxCoeff());
    largest = std::max(largest, (a - whole.rest_shapes()[0].rest).cwiseAbs().maxCoeff());
  }
  CHECK(apart > 0);
  CHECK(apart < 1e-7 * largest);
}

TEST_CASE("frames of the exact solution come in any order, and from a checkpoint",
          "[simulation][time][exact]") {
  Scene s = swaying(Integrator::Exact);
  s.surfaces[0].solver.release = GENERATE(Release::Freeze, Release::Recover);
  s.forces[0].enabled = held({{1, 1}, {4, 0}, {9, 1}});
  const auto expected = baked(s, "s");
  auto simulation = Simulation::make(s).value();
  for (const int frame : {12, 3, 7, 5, 12, 10}) {
    CHECK(simulation.at(frame)->surfaces()[0].positions() == expected[frame - 1]);
  }
  REQUIRE(simulation.at(6));
  const std::string saved = simulation.state_bytes(6).value();
  auto other = Simulation::make(s).value();
  REQUIRE(other.restore(saved));
  for (int frame = 6; frame <= 12; ++frame) {
    CHECK(other.at(frame)->surfaces()[0].positions() == expected[frame - 1]);
  }
}
