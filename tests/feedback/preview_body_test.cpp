#include "pliant/feedback/preview_body.hpp"

#include <cmath>
#include <string>

#include "pliant/sampling/rest_shape.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
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

namespace {

NurbsNet tube() {
  NurbsNet net{.u = {.count = 12, .degree = 1, .is_closed = true, .samples = 12},
               .v = {.count = 9, .degree = 1, .samples = 9}};
  net.points.resize(108, 3);
  for (int k = 0; k < 108; ++k) {
    const double angle = k % 12 * 0.5235987755982988;
    net.points.row(k) << 2 * std::cos(angle), k / 12, 2 * std::sin(angle);
  }
  return net;
}

// Forces all over a surface, many of them at a place of another, in a group or none.
Scene crowded(SurfaceShape shape, Combine combine, double radius) {
  Surface surface = sheet("s");
  surface.shape = std::move(shape);
  surface.solver.combine = combine;
  Scene s = scene({surface}, {}, 2);
  const int places[] = {0, 1, 2, 3, 4, 2, 0, 3, 1, 1, 4, 0};
  for (const int place : places) {
    Force force = poke("f" + std::to_string(s.forces.size()),
                       {2 * std::cos(place), place % 2 * 3.0, 2 * std::sin(place)});
    force.magnitude = 100.0 + 10 * static_cast<double>(s.forces.size());
    force.deformation_radius = radius * (1 + place % 3);
    force.force_radius = 2 * radius;
    if (s.forces.size() % 3 == 0) force.group = "g";
    s.forces.push_back(force);
  }
  Group group;
  group.name = "g";
  group.center = Value<3>{-2, 0, 0.3};
  group.deformation_radius = 1.5 * radius;
  s.groups = {group};
  return s;
}

}  // namespace

TEST_CASE("a single force moves what it moves among others of magnitude 0", "[feedback][preview]") {
  const Combine combine = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  const GridSheet square{.columns = 25, .rows = 25, .width = 6, .depth = 6};
  const SurfaceShape shapes[] = {square, tube(), sphere(3)};
  for (const SurfaceShape& shape : shapes) {
    CAPTURE(static_cast<int>(combine), shape.index());
    const Scene s = crowded(shape, combine, 0.6);
    const RestShape rest = make_rest_shape(s.surfaces[0], {})->shape;
    PreviewBody body(rest, s.surfaces[0], 1 / s.fps, true, {});
    REQUIRE(body.reserve());
    const BodyInputs inputs = sample_inputs(s, SceneSampling(s), 0, 1).body;
    const auto ways = [&](const BodyInputs& of) {
      Field ways(body.node_count(), 3);
      REQUIRE(body.settle(of, true));
      for (int node = 0; node < body.node_count(); ++node)
        ways.row(node) = body.displacement(of.transform, node).transpose();
      return ways;
    };
    const auto plan = body.look(inputs, true);
    REQUIRE(plan);
    const SingleForces single(inputs, body.selecting(inputs, **plan));
    bool is_moved = false;
    for (std::size_t k = 0; k < s.forces.size(); ++k) {
      BodyInputs among = inputs;
      for (std::size_t other = 0; other < among.forces.size(); ++other)
        if (other != k) among.forces[other].magnitude = 0;
      CHECK(single.of(k).forces.size() < inputs.forces.size());
      const Field moved = ways(among);
      is_moved = is_moved || !moved.isZero(0);
      CHECK(ways(single.of(k)) == moved);
    }
    CHECK(is_moved);
  }
}
