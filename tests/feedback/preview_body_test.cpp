#include "pliant/feedback/preview_body.hpp"

#include "pliant/sampling/rest_shape.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("what is settled is what a massless surface comes to", "[feedback][preview]") {
  Scene s = scene({sheet("s", 21)}, {poke("f", {0.3, 0, 0.2})}, 2);
  s.surfaces[0].tangents.su0 = Channel<3>(Value<3>{0, 3, 0});
  const RestShape shape = make_rest_shape(s.surfaces[0], {})->shape;
  PreviewBody body(shape, s.surfaces[0], 1 / s.fps, true, {});
  REQUIRE(body.reserve());
  const BodyInputs inputs = sample_inputs(s, SceneSampling(s), 0, 1).body;
  const auto settled_peak = [&](bool is_plain) {
    REQUIRE(body.settle(inputs, is_plain));
    return body.peak(inputs.transform).size;
  };
  const double real = settled_peak(false), plain = settled_peak(true);
  const auto massless_peak = [&] {
    Scene massless = s;
    massless.surfaces[0].material.density = massless.surfaces[0].material.damping = 0;
    auto simulation = Simulation::make(massless).value();
    return simulation.at(2).value().surfaces()[0].peak_displacement();
  };
  CHECK_THAT(real, WithinRel(massless_peak(), 1e-12));
  s.surfaces[0].tangents = {};
  CHECK_THAT(plain, WithinRel(massless_peak(), 1e-12));
  CHECK(std::abs(real - plain) > 0.01 * plain);
}

TEST_CASE("a plain body knows no rest but its own shape", "[feedback][preview]") {
  // With reference="none" a force of magnitude 0 alone moves the nodes of a flat sheet.
  Scene s = scene({sheet("s", 21)}, {poke("f", {0, 0, 0}, 0)}, 2);
  s.surfaces[0].solver.reference = Reference::None;
  const RestShape shape = make_rest_shape(s.surfaces[0], {})->shape;
  PreviewBody body(shape, s.surfaces[0], 1 / s.fps, true, {});
  REQUIRE(body.reserve());
  const BodyInputs inputs = sample_inputs(s, SceneSampling(s), 0, 1).body;
  REQUIRE(body.settle(inputs, false));
  CHECK(body.peak(inputs.transform).size > 0.01);
  REQUIRE(body.settle(inputs, true));
  CHECK(body.peak(inputs.transform).size == 0);
}

TEST_CASE("a preview takes its memory out of the budget", "[feedback][preview]") {
  const Scene s = scene({sheet("s", 21)}, {poke("f", {0, 0, 0})}, 2);
  const RestShape shape = make_rest_shape(s.surfaces[0], {})->shape;
  MemoryBudget little(1000);
  PreviewBody body(shape, s.surfaces[0], 1 / s.fps, true, {.memory = &little});
  const auto reserved = body.reserve();
  REQUIRE_FALSE(reserved);
  CHECK(reserved.error().code == ErrorCode::OutOfMemory);
}
