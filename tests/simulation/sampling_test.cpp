#include "pliant/simulation/sampling.hpp"

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("only enabled forces that target a surface act on it", "[simulation][sampling]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("everywhere", {0, 0, 0}), poke("on_b", {1, 0, 0}),
                                             poke("switched", {2, 0, 0})});
  s.forces[1].targets = {"b"};
  s.forces[2].enabled = switch_at({{1, false}, {5, true}, {8, false}});
  const auto forces = [&](int surface, int frame) {
    return sample_inputs(s, s.surfaces[surface], frame).force_indices;
  };
  CHECK(forces(0, 1) == std::vector<std::size_t>{0});
  CHECK(forces(1, 1) == std::vector<std::size_t>{0, 1});
  CHECK(forces(0, 5) == std::vector<std::size_t>{0, 2});
  CHECK(forces(1, 7) == std::vector<std::size_t>{0, 1, 2});
  CHECK(forces(1, 8) == std::vector<std::size_t>{0, 1});
}

TEST_CASE("channels are sampled at the frame", "[simulation][sampling]") {
  Scene s = scene({sheet("a")}, {poke("f", {0, 0, 0})});
  Surface& surface = s.surfaces[0];
  surface.material.c = curve({{1, 1}, {11, 2}});
  surface.tangents.su0 = Channel<1>(curve({{1, 0}, {11, 10}}));
  surface.tangents.sv1 = Channel<3>(Value<3>{1, 2, 3});
  surface.transform.translate = vector_curve({{1, {0, 0, 0}}, {11, {10, 20, 30}}});
  s.forces[0].shape = LineChannels{.from = Value<3>{1, 0, 0}, .to = Value<3>{2, 0, 0}};
  s.fps = 25;
  const BodyInputs inputs = sample_inputs(s, surface, 6).body;
  CHECK(inputs.stiffness.c == 1.5);  // the middle of two keys with flat ends, by symmetry
  CHECK(inputs.tangents.su0 == Vector3d(5, 5, 5));
  CHECK(inputs.tangents.sv1 == Vector3d(1, 2, 3));
  CHECK(inputs.transform.translation == Vector3d(5, 10, 15));
  CHECK(inputs.frame_length == 1.0 / 25);
  CHECK_FALSE(std::get<LineForce>(inputs.forces[0].shape).direction);
}
