#include "pliant/simulation/report_json.hpp"

#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Surfaces of both kinds, a force that follows one, a group, a force of a program, a collider.
Scene many_parts() {
  Surface skin = sheet("t");
  skin.shape = square(12, 12, 0.2, true);
  skin.reading.uv = UvReading::Surface;
  Scene s = scene({sheet("s"), skin}, {poke("a", {0, 0, 0}), poke("b", {1, 0, 1})}, 6);
  s.surfaces[0].transform.translate = vector_curve({{1, {0, 0, 0}}, {6, {1, 2, 0}}});
  s.forces[0].follow = "s";
  s.forces[0].magnitude = curve({{1, 0}, {6, 500}});
  s.groups.push_back({.name = "g", .center = Value<3>{2, 0, 2}, .deformation_radius = 3});
  s.forces[1].group = "g";
  s.forces.push_back(poke("noise", {0, 0, -2}, 30));
  s.forces.back().kind = NoiseChannels{.center = Value<3>{0, 0, -2}};
  s.forces.push_back(poke("own", {0, 0, 0}, 10));
  s.forces.back().kind = CustomForce{
      .distance = [](const Vector3d& p, const ForceTime&) { return p.norm(); },
      .unit_force = [](const Vector3d&, const ForceTime&) { return Vector3d(0, 1, 0); }};
  Collider ball;
  ball.name = "ball";
  ball.transform.translate = Value<3>{0, 1, 0};
  s.colliders.push_back(ball);
  return s;
}

}  // namespace

TEST_CASE("a live run and a simulation tell the same of a frame", "[simulation][report_json]") {
  const Scene s = many_parts();
  auto simulation = Simulation::make(s).value();
  auto live = LiveSimulation::make(s).value();
  for (int frame = s.start; frame < s.end; ++frame) {
    const std::string told = to_json(simulation.report(frame).value(), simulation).value();
    CHECK(to_json(live.report().value(), live).value() == told);
    REQUIRE(live.advance());
    CHECK(told.find('\n') == std::string::npos);
    const auto json = nlohmann::json::parse(told);
    CHECK(json["frame"] == frame);
    const auto& forces = json["surfaces"][0]["forces"];
    REQUIRE(forces.size() == 5);
    CHECK(forces[0]["center"] ==
          nlohmann::json(std::get<PointChannels>(simulation.in_world(s.forces[0], frame).kind)
                             .center.at(frame)));
    CHECK(forces[0]["magnitude"] == s.forces[0].magnitude.at(frame)[0]);
    CHECK(forces[3]["kind"] == "custom");
    CHECK(forces[4]["center"] == nlohmann::json({2, 0, 2}));
    CHECK(json["surfaces"][1]["grid"].is_null());
    CHECK(json["surfaces"][0]["contacts"].size() == json["surfaces"][1]["contacts"].size());
  }
}

TEST_CASE("telling a frame can be stopped", "[simulation][report_json]") {
  auto simulation = Simulation::make(many_parts()).value();
  const FrameReport report = simulation.report(2).value();
  const auto told = to_json(report, simulation, [] { return true; });
  REQUIRE_FALSE(told);
  CHECK(told.error().code == ErrorCode::Interrupted);
}
