#include "pliant/sampling/sampling.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

using Names = std::vector<std::string>;

SurfaceInputs inputs_of(const Scene& scene, std::size_t surface, int frame) {
  return sample_inputs(scene, SceneSampling(scene), surface, frame);
}

// The names of the forces that act on a surface at a frame.
Names names(const Scene& scene, int surface, int frame) {
  Names all;
  for (const ForceSource& source : inputs_of(scene, surface, frame).sources) {
    all.emplace_back(source.name);
  }
  return all;
}

}  // namespace

TEST_CASE("a keyed rate of a noise never makes it jump", "[sampling]") {
  Scene s = scene({sheet("a")}, {});
  s.start = -3;
  s.end = 40;
  const auto time_at = [&](const Channel<1>& rate, int frame) {
    s.forces = {poke("n", {0, 0, 0})};
    s.forces[0].kind = NoiseChannels{.rate = rate};
    return std::get<NoiseForce>(inputs_of(s, 0, frame).body.forces[0].kind).time;
  };
  // A curve with equal values is constant.
  const Channel<1> steady = testing::curve({{0, 2.5}, {10, 2.5}});
  const Channel<1> slowing = testing::curve({{0, 2.5}, {20, 0}});
  for (int frame = s.start; frame < s.end; ++frame) {
    CHECK(time_at(steady, frame) == Approx(time_at(2.5, frame)).margin(1e-12));
    const double passed = time_at(slowing, frame + 1) - time_at(slowing, frame);
    CHECK(passed == Approx(slowing.at(frame)[0] / s.fps).margin(1e-12));
  }
}

TEST_CASE("the time of a noise has the same bits in any order of frames", "[sampling]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("n", {0, 0, 0})});
  s.start = -7;
  s.end = 300;
  s.fps = 24;
  s.forces[0].kind = NoiseChannels{.rate = testing::curve({{-7, 0.1}, {100, 3.3}, {300, 0.7}})};
  const SceneSampling sampling(s);
  for (const int frame : {300, -7, 299, 40, 200, 41, -6, 300, 64}) {
    const auto forces = sample_inputs(s, sampling, frame % 2 == 0 ? 0 : 1, frame).body.forces;
    const Channel<1>& rate = std::get<NoiseChannels>(s.forces[0].kind).rate;
    double cells = rate.at(s.start)[0] * s.start;
    for (int before = s.start; before < frame; ++before) cells += rate.at(before)[0];
    if (frame <= s.start) cells = rate.at(frame)[0] * (frame / s.fps) * s.fps;
    CAPTURE(frame);
    CHECK(std::get<NoiseForce>(forces[0].kind).time == cells / s.fps);
    CHECK(std::get<NoiseForce>(inputs_of(s, 0, frame).body.forces[0].kind).time == cells / s.fps);
  }
}

TEST_CASE("only enabled forces that target a surface act on it", "[sampling]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("everywhere", {0, 0, 0}), poke("on_b", {1, 0, 0}),
                                             poke("switched", {2, 0, 0})});
  s.forces[1].targets = {"b"};
  s.forces[2].enabled = switch_at({{1, false}, {5, true}, {8, false}});
  CHECK(names(s, 0, 1) == Names{"everywhere"});
  CHECK(names(s, 1, 1) == Names{"everywhere", "on_b"});
  CHECK(names(s, 0, 5) == Names{"everywhere", "switched"});
  CHECK(names(s, 1, 7) == Names{"everywhere", "on_b", "switched"});
  CHECK(names(s, 1, 8) == Names{"everywhere", "on_b"});
}

TEST_CASE("a force in a group acts when and where both do", "[sampling][group]") {
  Scene s = scene({sheet("a"), sheet("b"), sheet("c")},
                  {poke("free", {0, 0, 0}), poke("all", {0, 0, 0}), poke("narrow", {0, 0, 0})});
  s.forces[1].group = s.forces[2].group = "g";
  s.forces[2].targets = {"b", "c"};
  s.groups.push_back({.name = "g", .targets = {"a", "b"}, .deformation_radius = 3});
  s.groups[0].enabled = switch_at({{1, true}, {5, false}});
  // Forces in the order of the scene, then the regions of groups.
  CHECK(names(s, 0, 1) == Names{"free", "all", "g"});
  CHECK(names(s, 1, 1) == Names{"free", "all", "narrow", "g"});
  CHECK(names(s, 2, 1) == Names{"free"});
  CHECK(names(s, 1, 5) == Names{"free"});
  const auto forces = inputs_of(s, 1, 1).body.forces;
  CHECK(forces[0].deformation_radius == 4.5);
  CHECK(forces[1].deformation_radius == 0);  // the group selects instead
  CHECK(forces[3].deformation_radius == 3);
  CHECK(forces[3].force_radius == 0);
}

TEST_CASE("inertia is the load of the surface's own acceleration", "[sampling][inertia]") {
  Scene s = scene({sheet("a")}, {poke("f", {0, 0, 0}, 1)});
  Surface& surface = s.surfaces[0];
  surface.material.density = 7;
  surface.transform.translate = vector_curve({{1, {0, 0, 0}}, {6, {3, 9, -2}}, {12, {1, 0, 0}}});
  surface.transform.rotate = vector_curve({{1, {0, 10, 0}}, {12, {80, -30, 200}}});
  surface.transform.scale = vector_curve({{1, {1, 1, 2}}, {12, {2, 3, 1}}});
  s.forces[0].kind = InertiaChannels{};
  s.fps = 25;
  for (const int frame : {1, 4, 6, 12}) {  // also where it samples outside the scene's frames
    const auto inputs = inputs_of(s, 0, frame);
    const Vector3d p(0.3, -1, 2);
    const auto at = [&](int f) -> Vector3d {
      const Transform x = surface.transform.at(f);
      return x.linear * p + x.translation;
    };
    const Vector3d expected = -7 * 25 * 25 * (at(frame + 1) - 2 * at(frame) + at(frame - 1));
    const Vector3d load = unit_force(inputs.body.forces[0].kind, at(frame));
    CAPTURE(frame);
    CHECK((load - expected).norm() < 1e-9 * (1 + expected.norm()));
  }
}

TEST_CASE("a surface at rest or in even motion feels no inertia", "[sampling][inertia]") {
  Scene s = scene({sheet("a")}, {poke("f", {0, 0, 0}, 1)});
  s.forces[0].kind = InertiaChannels{};
  s.surfaces[0].transform.rotate = Value<3>{20, 30, 40};
  const auto load = [&] { return unit_force(inputs_of(s, 0, 5).body.forces[0].kind, {1, 2, 3}); };
  CHECK(load() == Vector3d::Zero());
  CurveKeys<3> even;
  even.keys = {{.frame = 0, .value = {0, 0, 0}}, {.frame = 16, .value = {32, -8, 4}}};
  even.keys[0].next.kind = Interpolation::Kind::Linear;
  s.surfaces[0].transform.translate = Curve<3>::make(even).value();
  CHECK(load() == Vector3d::Zero());  // steps of 2, -1/2 and 1/4 are exact
}

TEST_CASE("noise goes with the second and starts from the scene's seed", "[sampling][noise]") {
  Scene s = scene({sheet("a")}, {poke("f", {0, 0, 0}), poke("g", {0, 0, 0})});
  s.seed = 11;
  s.fps = 20;
  s.forces[0].kind = NoiseChannels{.frequency = 0.5, .rate = 3};
  s.forces[1].kind = NoiseChannels{.seed = 4};
  const auto forces = inputs_of(s, 0, 10).body.forces;
  const auto& noise = std::get<NoiseForce>(forces[0].kind);
  CHECK(noise.time == 3 * 10 / 20.0);
  CHECK(noise.frequency == 0.5);
  CHECK(noise.seed == 11);
  CHECK(std::get<NoiseForce>(forces[1].kind).seed == 4);
}

TEST_CASE("a custom force is asked with its time, and its answers are looked at",
          "[sampling][custom]") {
  Scene s = scene({sheet("a")}, {poke("wind", {0, 0, 0}, 1)});
  s.fps = 30;
  std::vector<double> asked;
  s.forces[0].kind = CustomForce{
      .distance =
          [&](const Vector3d& p, const ForceTime& time) {
            asked = {static_cast<double>(time.frame), time.seconds};
            return p.x();
          },
      .unit_force = [](const Vector3d& p, const ForceTime&) { return Vector3d(p / p.z()); }};
  const auto inputs = inputs_of(s, 0, 6);
  const ForceKind& shape = inputs.body.forces[0].kind;
  CHECK(distance(shape, {3, 0, 1}) == 3);
  CHECK(asked == std::vector<double>{6, 0.2});
  CHECK(unit_force(shape, {3, 0, 2}) == Vector3d(1.5, 0, 1));
  CHECK(inputs.faults->first().empty());
  CHECK(unit_force(shape, {1, 2, 0}) == Vector3d::Zero());
  CHECK_THAT(inputs.faults->first(),
             contains_text("force \"wind\": its unit_force at (1, 2, 0) is "));
  CHECK(std::isinf(distance(shape, {-1, 0, 0})));
  CHECK_THAT(inputs.faults->first(), contains_text("unit_force"));  // the first fault is reported
  // Without a distance function it acts everywhere.
  std::get<CustomForce>(s.forces[0].kind).distance = {};
  CHECK(distance(inputs_of(s, 0, 6).body.forces[0].kind, {-9, 0, 0}) == 0);
}

TEST_CASE("channels are sampled at the frame", "[sampling]") {
  Scene s = scene({sheet("a")}, {poke("f", {0, 0, 0})});
  Surface& surface = s.surfaces[0];
  surface.material.c = curve({{1, 1}, {11, 2}});
  surface.tangents.su0 = Channel<1>(curve({{1, 0}, {11, 10}}));
  surface.tangents.sv1 = Channel<3>(Value<3>{1, 2, 3});
  surface.transform.translate = vector_curve({{1, {0, 0, 0}}, {11, {10, 20, 30}}});
  s.forces[0].kind = LineChannels{.from = Value<3>{1, 0, 0}, .to = Value<3>{2, 0, 0}};
  s.fps = 25;
  const BodyInputs inputs = inputs_of(s, 0, 6).body;
  CHECK(inputs.stiffness.c == 1.5);  // the middle of two keys with flat ends, by symmetry
  CHECK(inputs.tangents.su0 == Vector3d(5, 5, 5));
  CHECK(inputs.tangents.sv1 == Vector3d(1, 2, 3));
  CHECK(inputs.transform.translation == Vector3d(5, 10, 15));
  CHECK(inputs.frame_length == 1.0 / 25);
  CHECK_FALSE(std::get<LineForce>(inputs.forces[0].kind).direction);
}
