#include "pliant/feedback/acting_forces.hpp"

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Two forces, one of them switched, and a group with another force.
Scene grouped_scene() {
  Scene s =
      scene({sheet("a")}, {poke("f", {0, 0, 0}), poke("g", {3, 0, 0}), poke("h", {-3, 0, 0})}, 20);
  s.forces[1].enabled = switch_at({{1, false}, {5, true}, {9, false}});
  s.forces[2].group = "hand";
  Group hand;
  hand.name = "hand";
  hand.deformation_radius = 3.5;
  hand.enabled = switch_at({{1, true}, {12, false}});
  s.groups = {hand};
  return s;
}

}  // namespace

TEST_CASE("all forces act as they do on the surface", "[feedback][acting]") {
  const Scene s = grouped_scene();
  const ActingForces all(s, s.surfaces[0], {0, 1, 2}, {0});
  const auto faults = std::make_shared<ForceFaults>();
  for (int frame = 1; frame <= 20; ++frame) {
    const BodyInputs inputs = all.at(frame, faults);
    const BodyInputs expected = sample_inputs(s, SceneSampling(s), 0, frame).body;
    CAPTURE(frame);
    CHECK(inputs.selectors == expected.selectors);
    REQUIRE(inputs.forces.size() == expected.forces.size());
    for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
      CHECK(inputs.forces[k].magnitude == expected.forces[k].magnitude);
      CHECK(inputs.forces[k].deformation_radius == expected.forces[k].deformation_radius);
      const Vector3d p(1, 2, 3);
      CHECK(distance(inputs.forces[k].kind, p) == distance(expected.forces[k].kind, p));
    }
  }
  CHECK(all.enabled_at(1) == std::vector<std::size_t>{0, 2});
  CHECK(all.enabled_at(5) == std::vector<std::size_t>{0, 1, 2});
  CHECK(all.enabled_at(12) == std::vector<std::size_t>{0});
}

TEST_CASE("a force of a group is alone but for the group's region", "[feedback][acting]") {
  const Scene s = grouped_scene();
  const ActingForces one(s, s.surfaces[0], {2}, {0});
  const auto faults = std::make_shared<ForceFaults>();
  CHECK(one.at(3, faults).forces.size() == 2);
  CHECK(one.at(3, faults).selectors == std::vector<int>{1, 1});
  CHECK(one.at(12, faults).forces.empty());
  CHECK(one.is_enabled(2, 11));
  CHECK_FALSE(one.is_enabled(2, 12));
  CHECK_FALSE(one.selects_at(12));
}

TEST_CASE("what stands still differs by its magnitude alone", "[feedback][acting]") {
  Scene s = grouped_scene();
  const auto stands = [&] { return ActingForces(s, s.surfaces[0], {0, 2}, {0}).stand_still(); };
  s.forces[0].magnitude = curve({{1, 0}, {9, 5}});
  CHECK(stands());
  const Scene still = s;
  const auto moved = curve({{1, 1}, {9, 2}});
  const auto turned = vector_curve({{1, {0, 0, 1}}, {9, {0, 1, 0}}});
  const std::vector<std::function<void()>> changes = {
      [&] { s.forces[0].force_radius = moved; },
      [&] { s.forces[0].deformation_radius = moved; },
      [&] { s.forces[0].kind = PointChannels{.center = turned}; },
      [&] { s.forces[0].kind = PointChannels{.direction = turned}; },
      [&] { s.forces[0].kind = RadialChannels{.center = turned}; },
      [&] { s.forces[0].kind = LineChannels{.from = turned}; },
      [&] { s.forces[0].kind = LineChannels{.to = turned}; },
      [&] { s.forces[0].kind = LineChannels{.direction = Channel<3>(turned)}; },
      [&] { s.forces[0].kind = UniformChannels{turned}; },
      [&] { s.forces[0].kind = VortexChannels{.center = turned}; },
      [&] { s.forces[0].kind = VortexChannels{.axis = turned}; },
      [&] { s.forces[0].kind = VortexChannels{.pull = moved}; },
      [&] { s.forces[0].kind = NoiseChannels{}; },  // noise varies over time
      [&] { s.forces[0].kind = CustomForce{}; },
      [&] { s.groups[0].center = turned; },
      [&] { s.groups[0].deformation_radius = moved; },
      [&] { s.surfaces[0].transform.rotate = turned; },
      [&] { s.surfaces[0].material.b = moved; },
  };
  for (const auto& change : changes) {
    s = still;
    change();
    CHECK_FALSE(stands());
  }
  s = still;
  s.forces[0].kind = NoiseChannels{.rate = 0};
  CHECK(stands());
  s.forces[1].kind = PointChannels{.center = turned};  // not among the forces
  CHECK(stands());
}
