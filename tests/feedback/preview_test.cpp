#include "pliant/feedback/preview.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::vector<Preview> previews_of(const Scene& s) {
  return preview_forces(Simulation::make(s).value()).value();
}

// The first preview of that kind and index.
Preview preview_of(const Scene& s, Preview::Of of, std::size_t index = 0) {
  for (Preview& preview : previews_of(s)) {
    if (preview.of == of && preview.index == index) return std::move(preview);
  }
  FAIL("there is no such preview");
  return {};
}

// The peak of each frame of a bake.
std::vector<double> baked_peaks(const Scene& s) {
  auto simulation = Simulation::make(s).value();
  std::vector<double> peaks;
  for (const int frame : simulation.frames()) {
    peaks.push_back(simulation.at(frame).value().surfaces()[0].peak_displacement());
  }
  return peaks;
}

}  // namespace

TEST_CASE("the static peak is what a massless surface comes to", "[feedback][preview]") {
  Scene s = scene({sheet("s", 21)}, {poke("f", {0.3, 0, 0.2})}, 2);
  s.surfaces[0].material.density = s.surfaces[0].material.damping = 0;
  s.surfaces[0].transform.scale = Value<3>{1, 2, 1};
  s.surfaces[0].transform.rotate = Value<3>{0, 30, 0};
  const auto previews = previews_of(s);
  REQUIRE(previews.size() == 2);  // the force, and all forces
  const double peak = baked_peaks(s).back();
  for (const Preview& preview : previews) {
    CHECK_THAT(preview.static_peak, WithinRel(peak, 1e-9));
    REQUIRE(preview.regions.size() == 1);
    CHECK(preview.regions[0].static_peak == preview.static_peak);
    CHECK(preview.regions[0].first_frequency == 0);  // no density, no vibration
    CHECK(preview.regions[0].settling.frames == 1);
    REQUIRE(preview.played);
    CHECK(preview.played->peak == peak);
    CHECK(preview.played->frame == 2);
  }
}

TEST_CASE("the first natural frequency is the one that the surface rings with",
          "[feedback][preview]") {
  // A short push, then nothing: from then on zero crossings are half a period apart.
  Scene s = scene({sheet("s", 15)}, {poke("f", {0, 0, 0})}, 200);
  Surface& surface = s.surfaces[0];
  surface.material.density = 40;
  surface.material.damping = 0;
  surface.solver.dt = 0.0005;  // makes the damping and delay of backward Euler small
  s.forces[0].deformation_radius = 100;
  CurveKeys<1> keys;
  keys.keys = {{.frame = 1, .value = {3000}}, {.frame = 2, .value = {0}}};
  for (auto& key : keys.keys) key.next.kind = Interpolation::Kind::Step;
  s.forces[0].magnitude = Curve<1>::make(keys).value();

  const RegionPreview told = preview_of(s, Preview::Of::Force).regions.at(0);
  CHECK(told.damping_ratio == 0);
  CHECK(told.animated.damping_ratio > 0);  // from backward Euler
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
  CHECK_THAT(told.first_frequency, WithinRel(frequency, 0.02));
  CHECK_THAT(told.animated.frequency, WithinRel(frequency, 0.005));
}

TEST_CASE("the damping ratio is 1 where ringing ends", "[feedback][preview]") {
  Scene s = scene({sheet("s", 15)}, {poke("f", {0, 0, 0})});
  const RegionPreview light = preview_of(s, Preview::Of::Force).regions.at(0);
  const double omega = 2 * std::numbers::pi * light.first_frequency;
  s.surfaces[0].material.damping = 2 * omega * 40;  // critical: 2 rho omega
  CHECK_THAT(preview_of(s, Preview::Of::Force).regions.at(0).damping_ratio, WithinRel(1.0, 1e-9));
}

TEST_CASE("a force is told of at the frame of its greatest effect", "[feedback][preview]") {
  Scene s = scene({sheet("s", 41)}, {poke("f", {0, 0, 0})}, 40);
  Force& force = s.forces[0];
  SECTION("the largest magnitude, where nothing else changes") {
    force.magnitude = curve({{1, 0}, {10, 300}, {20, -900}, {30, 0}});
    CHECK(preview_of(s, Preview::Of::Force).frame == 20);
    CHECK(preview_of(s, Preview::Of::Force).magnitude == -900);
  }
  SECTION("the largest region, where it is the softest") {
    force.deformation_radius = curve({{1, 3}, {25, 12}, {39, 3}});
    CHECK(preview_of(s, Preview::Of::Force).selected.columns() == 23);
  }
  SECTION("a weaker push at the middle rather than a stronger one at the rim") {
    force.deformation_radius = 100.0;
    force.kind = PointChannels{.center = vector_curve({{1, {18, 0, 0}}, {30, {0, 0, 0}}})};
    force.magnitude = curve({{1, 1200}, {30, 1000}});  // weaker by a sixth
    CHECK(preview_of(s, Preview::Of::Force).frame.value_or(0) >= 25);
  }
  SECTION("only where it is enabled") {
    force.magnitude = curve({{1, 100}, {39, 500}});
    force.enabled = switch_at({{1, true}, {12, false}});
    CHECK(preview_of(s, Preview::Of::Force).frame == 11);
  }
  SECTION("not where it selects nothing") {
    force.kind =
        PointChannels{.center = vector_curve({{1, {0, 60, 0}}, {20, {0, 60, 0}}, {22, {0, 0, 0}}})};
    force.magnitude = curve({{1, 0}, {10, -700}, {30, 300}});
    const Preview told = preview_of(s, Preview::Of::Force);
    CHECK(told.frame == 30);
    CHECK(told.largest_magnitude == -700);
    CHECK(told.largest_magnitude_frame == 10);
  }
  // The frame with the largest peak, found the slow way: the load of each frame alone.
  const Preview told = preview_of(s, Preview::Of::Force);
  CHECK(told.is_every_frame);
  Scene held = s;
  held.surfaces[0].material.density = held.surfaces[0].material.damping = 0;
  double largest = 0;
  for (const double peak : baked_peaks(held)) largest = std::max(largest, peak);
  if (told.frame != 11 && told.selected.columns() < 41) {
    CHECK(told.static_peak >= 0.999 * largest);
  }
}

TEST_CASE("an animation is played as it is baked", "[feedback][preview]") {
  Scene s = scene({sheet("s", 31)}, {poke("f", {-4, 0, 0}), poke("g", {4, 0, 1}, 3000)}, 40);
  s.forces[0].magnitude = curve({{1, 0}, {8, 5000}, {16, 0}});
  s.forces[1].kind = PointChannels{.center = vector_curve({{1, {4, 0, 0}}, {30, {-6, 0, 2}}})};
  Surface& surface = s.surfaces[0];
  SECTION("box") {}
  SECTION("islands") { surface.solver.combine = Combine::Islands; }
  SECTION("union") { surface.solver.combine = Combine::Union; }
  SECTION("recover") { surface.solver.release = Release::Recover; }
  SECTION("reference") { surface.solver.reference = Reference::None; }
  SECTION("a surface that moves") {
    surface.transform.translate = vector_curve({{1, {0, 0, 0}}, {20, {0, 2, 0}}});
    surface.transform.scale = vector_curve({{1, {1, 1, 1}}, {20, {1, 3, 1}}});
  }
  SECTION("a late start") { surface.solver.start_frame = 9; }
  SECTION("a keyed dt") { surface.solver.dt = curve({{1, 0.002}, {30, 0.04}}); }
  SECTION("tangents") { surface.tangents.sv1 = Channel<3>(Value<3>{0, 4, 0}); }
  const auto peaks = baked_peaks(s);
  const auto largest = std::max_element(peaks.begin(), peaks.end());
  const Preview all = preview_of(s, Preview::Of::All);
  REQUIRE(all.played);
  CHECK_THAT(all.played->peak, WithinRel(*largest, 1e-13));
  CHECK(all.played->frame == 1 + static_cast<int>(largest - peaks.begin()));
}

TEST_CASE("a large surface of triangles is played as it is baked", "[feedback][preview]") {
  Scene s = scene({sheet("s")}, {poke("f", {-2, 0, 1}), poke("g", {2, 0, 0}, 3000)}, 24);
  Surface& surface = s.surfaces[0];
  surface.shape = square(is_sanitized ? 22 : 56, 12, 0.2);  // 3249 nodes
  surface.solver.dt = 0.005;
  surface.solver.integrator = Integrator::Newmark;
  s.forces[0].magnitude = curve({{1, 0}, {8, 5000}, {16, 0}});
  SECTION("one force") { s.forces.pop_back(); }
  SECTION("two at a time") {}
  SECTION("backward Euler") { surface.solver.integrator = Integrator::BackwardEuler; }
  SECTION("a damping ratio") {
    surface.material.damping_ratio = 0.1;
    surface.material.damping = 1.0;
  }
  SECTION("a force that moves") {
    s.forces[1].kind = PointChannels{.center = vector_curve({{1, {2, 0, 0}}, {20, {-3, 0, 2}}})};
  }
  SECTION("all of a surface that turns") {
    surface.solver.region = SolvedRegion::All;
    surface.transform.rotate = vector_curve({{1, {0, 0, 0}}, {20, {0, 20, 40}}});
    s.forces = {s.forces[0]};
    s.forces[0].kind = InertiaChannels{};
    s.forces[0].magnitude = 1.0;
  }
  SECTION("keyed density") { surface.material.density = curve({{1, 40}, {20, 80}}); }
  const auto peaks = baked_peaks(s);
  const auto largest = std::max_element(peaks.begin(), peaks.end());
  const Preview all = preview_of(s, Preview::Of::All);
  REQUIRE(all.played);
  CHECK_THAT(all.played->peak, WithinRel(*largest, 1e-4));
  CHECK(all.played->frame == 1 + static_cast<int>(largest - peaks.begin()));
}

TEST_CASE("shares tell who makes the peak", "[feedback][preview]") {
  Scene s = scene(
      {sheet("s", 31)},
      {poke("f", {-1, 0, 0}, 4000), poke("g", {1, 0, 1}, -1000), poke("far", {10, 0, 10})}, 20);
  s.surfaces[0].solver.combine = Combine::Islands;
  const Preview all = preview_of(s, Preview::Of::All);
  REQUIRE(all.regions.size() == 2);
  REQUIRE(all.shares.size() == 3);
  double sum = 0;
  for (const ForceShare& one : all.shares) sum += one.share;
  CHECK_THAT(sum, WithinRel(1.0, 1e-9));
  // The peak is that of the far force, alone in its island: the others have no share.
  CHECK_THAT(all.shares[2].share, WithinRel(1.0, 1e-9));
  CHECK(all.shares[0].share == 0);
  s.forces[2].magnitude = 100.0;
  const Preview near = preview_of(s, Preview::Of::All);
  CHECK(near.shares[0].share > 1);  // g pushes against it
  CHECK(near.shares[1].share < -0.1);
  CHECK(near.shares[2].share == 0);
}

TEST_CASE("a group is told of with what its members do there", "[feedback][preview][group]") {
  Scene s = scene(
      {sheet("s", 31)},
      {poke("palm", {-2, 0, 0}, 4000), poke("thumb", {3, 0, 0}, 1000), poke("f", {9, 0, 9})}, 20);
  Group hand;
  hand.name = "hand";
  hand.center = Value<3>{0, 0, 0};
  hand.deformation_radius = 7.5;
  s.groups = {hand};
  s.forces[0].group = s.forces[1].group = "hand";
  s.forces[1].magnitude = curve({{1, 0}, {12, 1000}, {19, 0}});
  const Preview told = preview_of(s, Preview::Of::Group);
  CHECK(told.frame == 12);
  CHECK(told.selected.columns() == 15);
  REQUIRE(told.shares.size() == 2);
  CHECK(told.shares[0].force == 0);
  CHECK_THAT(told.shares[0].share + told.shares[1].share, WithinRel(1.0, 1e-9));
  CHECK(told.shares[0].share > told.shares[1].share);
  CHECK(told.shares[1].share > 0.05);
  // By linearity the peaks of the two forces alone, in the same region, add up to at least that of
  // both together.
  const double palm = preview_of(s, Preview::Of::Force, 0).static_peak;
  const double thumb = preview_of(s, Preview::Of::Force, 1).static_peak;
  CHECK(told.static_peak <= palm + thumb);
  CHECK(told.static_peak > palm);
}

TEST_CASE("what selects nothing is told how far away it is", "[feedback][preview]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 60, 0})}, 30);
  s.surfaces[1].transform.translate = Value<3>{100, 0, 0};
  s.forces[0].kind = PointChannels{.center = vector_curve({{1, {0, 60, 0}}, {10, {0, 5, 0}}})};
  const auto previews = previews_of(s);
  REQUIRE(previews.size() == 4);
  const Preview& a = previews[0];
  CHECK_FALSE(a.frame);
  REQUIRE(a.gap);
  CHECK(a.gap->frame == 10);
  CHECK_THAT(a.gap->to_vertex, WithinRel(5.0, 1e-12));
  CHECK_THAT(a.gap->to_centre, WithinRel(5.0, 1e-12));
  CHECK(a.gap->deformation_radius == 4.5);
  const Preview& b = previews[2];
  CHECK(b.surface == 1);
  REQUIRE(b.gap);
  CHECK_THAT(b.gap->to_vertex, WithinRel(std::hypot(94, 5), 1e-12));
  CHECK_THAT(b.gap->to_centre, WithinRel(std::hypot(100, 5), 1e-12));
  s.forces[0].enabled = false;
  CHECK(previews_of(s).empty());
}

TEST_CASE("a long range is looked at here and there", "[feedback][preview]") {
  if (is_sanitized) return;  // the search would need minutes, and is the same as for shorter ranges
  Scene s = scene({sheet("s", 101)}, {poke("f", {0, 0, 0})}, 200'000);
  s.forces[0].kind =
      PointChannels{.center = vector_curve({{1, {-20, 0, 0}}, {200'000, {20, 0, 0}}})};
  s.forces[0].magnitude = curve({{1, 0}, {777, 4000}, {2000, 0}});
  const Preview told = preview_of(s, Preview::Of::Force);
  CHECK_FALSE(told.is_every_frame);
  CHECK(told.frame == 777);
  CHECK_FALSE(told.played);
}
