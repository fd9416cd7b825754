#include "pliant/simulation/preview.hpp"

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::vector<ForcePreview> previews_of(const Scene& s) {
  return preview_forces(Simulation::make(s).value()).value();
}

}  // namespace

TEST_CASE("the static peak is what a massless surface comes to", "[simulation][preview]") {
  Scene s = scene({sheet("s", 21)}, {poke("f", {0.3, 0, 0.2})}, 2);
  s.surfaces[0].material.density = s.surfaces[0].material.damping = 0;
  s.surfaces[0].transform.scale = Value<3>{1, 2, 1};
  s.surfaces[0].transform.rotate = Value<3>{0, 30, 0};
  const auto previews = previews_of(s);
  REQUIRE(previews.size() == 1);
  auto simulation = Simulation::make(s).value();
  CHECK_THAT(previews[0].static_peak,
             WithinRel(simulation.at(2).value().surfaces()[0].peak_displacement(), 1e-9));
  CHECK(previews[0].frequency == 0);  // no density, no vibration
}

TEST_CASE("the first natural frequency is the one that the surface rings with",
          "[simulation][preview]") {
  // A blow, then nothing: crossings of zero from there on are half a period apart.
  Scene s = scene({sheet("s", 15)}, {poke("f", {0, 0, 0})}, 200);
  Surface& surface = s.surfaces[0];
  surface.material.density = 40;
  surface.material.damping = 0;
  surface.solver.dt = 0.0005;  // backward Euler's own damping and delay are then small
  s.forces[0].deformation_radius = 100;
  CurveKeys<1> keys;
  keys.keys = {{.frame = 1, .value = {3000}}, {.frame = 2, .value = {0}}};
  for (auto& key : keys.keys) key.next.kind = Interpolation::Kind::Step;
  s.forces[0].magnitude = Curve<1>::make(keys).value();

  const auto previews = previews_of(s);
  REQUIRE(previews.size() == 1);
  CHECK(previews[0].damping_ratio == 0);
  auto simulation = Simulation::make(s).value();
  std::vector<double> crossings;
  double before = 0;
  for (int frame = 60; frame <= s.end; ++frame) {
    const double height = simulation.at(frame).value().surfaces()[0].positions()(112, 1);
    if (before * height < 0) crossings.push_back(frame - height / (height - before));
    before = height;
  }
  REQUIRE(crossings.size() > 4);
  const double half_periods = static_cast<double>(crossings.size()) - 1;
  const double frequency = half_periods / 2 / ((crossings.back() - crossings.front()) / s.fps);
  CHECK_THAT(previews[0].frequency, WithinRel(frequency, 0.02));
}

TEST_CASE("the damping ratio is 1 where ringing ends", "[simulation][preview]") {
  Scene s = scene({sheet("s", 15)}, {poke("f", {0, 0, 0})});
  const ForcePreview light = previews_of(s)[0];
  const double omega = 2 * std::numbers::pi * light.frequency;
  s.surfaces[0].material.damping = 2 * omega * 40;  // critical: 2 rho omega
  CHECK_THAT(previews_of(s)[0].damping_ratio, WithinRel(1.0, 1e-9));
}

TEST_CASE("the first active frame is the first that selects", "[simulation][preview]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0})}, 30);
  s.surfaces[1].transform.translate = Value<3>{500, 0, 0};
  s.forces[0].shape =
      PointChannels{.center = vector_curve({{1, {0, 60, 0}}, {20, {0, 60, 0}}, {22, {0, 0, 0}}})};
  s.forces[0].magnitude = curve({{1, 0}, {10, -700}, {30, 300}});
  s.forces[0].enabled = switch_at({{1, false}, {5, true}});
  const auto previews = previews_of(s);
  REQUIRE(previews.size() == 2);
  auto simulation = Simulation::make(s).value();
  REQUIRE(previews[0].frame);
  // Nothing moves before its solve, and something does after it.
  CHECK(simulation.at(*previews[0].frame).value().surfaces()[0].peak_displacement() == 0);
  CHECK(simulation.at(*previews[0].frame + 1).value().surfaces()[0].peak_displacement() > 0);
  CHECK(previews[0].magnitude == -700);
  CHECK(previews[0].magnitude_frame == 10);
  CHECK_FALSE(previews[1].frame);  // b is out of its reach
  s.forces[0].enabled = false;
  CHECK(previews_of(s).empty());
}
