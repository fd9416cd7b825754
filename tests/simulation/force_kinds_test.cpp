#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "pliant/sampling/sampling.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

bool are_same(const std::vector<Field>& a, const std::vector<Field>& b) { return a == b; }

double difference(const std::vector<Field>& a, const std::vector<Field>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, largest_difference(a[k], b[k]));
  return most;
}

// The same scene with its force as the only one of a group with the same region.
Scene grouped(Scene s) {
  Force& force = s.forces[0];
  s.groups.push_back({.name = "g",
                      .center = std::get<PointChannels>(force.kind).center,
                      .deformation_radius = force.deformation_radius});
  force.group = "g";
  force.deformation_radius = 1;  // not used
  return s;
}

}  // namespace

TEST_CASE("a group with one force in its centre is that force, bit for bit",
          "[simulation][group]") {
  Scene alone = scene({sheet("s")}, {poke("f", {0.3, 0, -0.7})});
  alone.forces[0].magnitude = curve({{1, 0}, {5, 4000}, {9, -2000}});
  alone.forces[0].deformation_radius = curve({{1, 4}, {12, 6}});
  CHECK(are_same(baked(alone, "s"), baked(grouped(alone), "s")));
  CHECK(peak(baked(alone, "s")) > 0.01);
}

TEST_CASE("a disabled group silences its forces, and has no region", "[simulation][group]") {
  Scene s = grouped(scene({sheet("s")}, {poke("f", {0, 0, 0})}));
  s.groups[0].enabled = false;
  CHECK(peak(baked(s, "s")) == 0);
  s.groups[0].enabled = switch_at({{1, true}, {4, false}});
  Scene alone = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  alone.forces[0].enabled = switch_at({{1, true}, {4, false}});
  CHECK(are_same(baked(alone, "s"), baked(s, "s")));
}

TEST_CASE("a force in a group pushes only within the group's region", "[simulation][group]") {
  Scene s = scene({sheet("s")}, {poke("f", {5, 0, 0})});
  s.forces[0].group = "g";
  s.groups.push_back({.name = "g", .center = Value<3>{-4, 0, 0}, .deformation_radius = 2.5});
  s.forces[0].force_radius = 20;
  for (const Field& frame : baked(s, "s")) {
    for (int node = 0; node < 13 * 13; ++node) {
      if (node % 13 > 4) CHECK(frame(node, 1) == 0);  // columns right of x = -2
    }
  }
  CHECK(peak(baked(s, "s")) > 0);
  // There is no warning about its missing region.
  auto simulation = Simulation::make(s).value();
  REQUIRE(simulation.at(s.end));
  CHECK(simulation.warnings().empty());
  s.forces[0].force_radius = 0.1;
  auto outside = Simulation::make(s).value();
  REQUIRE(outside.at(s.end));
  for (const Warning& warning : outside.warnings()) {
    CHECK(warning.kind != Warning::Kind::SelectsNothing);
  }
}

TEST_CASE("the order of forces changes the last bits only", "[simulation][forces]") {
  Scene s = scene({sheet("s")}, {poke("a", {-2, 0, 1}), poke("b", {1.5, 0, 0}, -3000),
                                 poke("c", {0.2, 0, -2}, 800)});
  s.forces[1].kind = RadialChannels{.center = Value<3>{1.5, -1, 0}};
  Scene turned = s;
  std::swap(turned.forces[0], turned.forces[2]);
  CHECK(difference(baked(s, "s"), baked(turned, "s")) < 1e-12 * peak(baked(s, "s")));
}

TEST_CASE("a uniform force on the whole plate is the load of SPEC 11", "[simulation][uniform]") {
  Scene s = scene({sheet("s", 41)}, {poke("f", {0, 0, 0}, 2000)}, 2);
  s.surfaces[0].material.density = s.surfaces[0].material.damping = 0;
  s.forces[0].kind = UniformChannels{.direction = Value<3>{0, 3, 0}};
  s.forces[0].deformation_radius = 0.01;  // any radius will do
  s.forces[0].force_radius = 0.01;
  const double height = baked(s, "s")[1](41 * 20 + 20, 1);
  CHECK_THAT(height, WithinRel(0.00126532 * 2000, 0.01));
  s.forces[0].deformation_radius = 0;  // except 0, since no distance is less than 0
  CHECK(peak(baked(s, "s")) == 0);
}

TEST_CASE("a vortex at rest turns the sheet and lifts nothing", "[simulation][vortex]") {
  // No node is on the axis: a rounding error off it, a node would be pushed with full strength.
  Scene s = scene({sheet("s", 14)}, {poke("f", {0, 0, 0}, 500)}, 6);
  s.forces[0].kind = VortexChannels{};
  s.forces[0].deformation_radius = s.forces[0].force_radius = 20;
  const std::vector<Field> frames = baked(s, "s");
  CHECK(peak(frames) > 1e-3);
  const Field moved = frames.back() - frames.front();
  CHECK(moved.col(1).cwiseAbs().maxCoeff() == 0);
  // Half a turn about the axis maps the motion onto itself.
  for (int node = 0; node < 14 * 14; ++node) {
    const int opposite = 14 * 14 - 1 - node;
    CHECK_THAT(moved(node, 0), WithinAbs(-moved(opposite, 0), 1e-12));
    CHECK_THAT(moved(node, 2), WithinAbs(-moved(opposite, 2), 1e-12));
  }
}

TEST_CASE("noise has the same bits in whatever order frames are asked for", "[simulation][noise]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})}, 20);
  s.forces[0].kind = NoiseChannels{.frequency = 0.4, .rate = 5};
  s.forces[0].deformation_radius = 20;
  s.forces[0].force_radius = 20;
  const std::vector<Field> forwards = baked(s, "s");
  auto simulation = Simulation::make(s).value();
  for (const int frame : {20, 3, 11, 2, 19}) {
    CHECK(simulation.at(frame).value().surface("s").positions() == forwards[frame - 1]);
  }
  Scene other = s;
  other.seed = 1;
  CHECK(difference(baked(other, "s"), forwards) > 0.1 * peak(forwards));
}

TEST_CASE("inertia leaves a surface behind when it sets off", "[simulation][inertia]") {
  Scene s = scene({sheet("s", 15)}, {poke("f", {0, 0, 0}, 1)}, 10);
  s.forces[0].kind = InertiaChannels{};
  s.surfaces[0].transform.translate = vector_curve({{3, {0, 0, 0}}, {9, {0, 4, 0}}});
  auto simulation = Simulation::make(s).value();
  const auto sag = [&](int frame) {
    const auto at = simulation.at(frame).value();
    const auto positions = at.surface("s").positions();
    return positions(112, 1) - positions(0, 1);  // the middle relative to a corner
  };
  CHECK(sag(2) == 0);
  CHECK(sag(5) < -1e-4);
  // In the surface's space it makes no difference whether the surface or the world is turned.
  Scene turned = s;
  turned.surfaces[0].transform.rotate = Value<3>{90, 0, 0};
  turned.surfaces[0].transform.translate = vector_curve({{3, {0, 0, 0}}, {9, {0, 0, 4}}});
  auto other = Simulation::make(turned).value();
  const auto positions = other.at(6).value().surface("s").positions();
  const auto here = simulation.at(6).value().surface("s").positions();
  CHECK_THAT(positions(112, 2) - positions(0, 2), WithinAbs(here(112, 1) - here(0, 1), 1e-12));
}

TEST_CASE("a custom force that is a point force has its bits", "[simulation][custom]") {
  const Scene built_in = scene({sheet("s")}, {poke("f", {0.3, 0, 0.4})});
  Scene own = built_in;
  const PointForce point{{0.3, 0, 0.4}, {0, 1, 0}};
  own.forces[0].kind = CustomForce{
      .distance = [=](const Vector3d& p, const ForceTime&) { return point.distance(p); },
      .unit_force = [=](const Vector3d& p, const ForceTime&) { return point.unit_force(p); }};
  CHECK(are_same(baked(built_in, "s"), baked(own, "s")));
  const auto a = preview_forces(Simulation::make(built_in).value()).value();
  const auto b = preview_forces(Simulation::make(own).value()).value();
  CHECK(a[0].static_peak == b[0].static_peak);
  CHECK(a[0].selected == b[0].selected);
}

TEST_CASE("an unsound answer of a custom force ends the run and is located",
          "[simulation][custom]") {
  Scene s = scene({sheet("s")}, {poke("wind", {0, 0, 0}, 1)});
  int bad_from = 4;
  s.forces[0].kind = CustomForce{.unit_force = [&](const Vector3d& p, const ForceTime& time) {
    return time.frame < bad_from ? Vector3d(0, 1, 0) : Vector3d(0, p.x() / 0.0, 0);
  }};
  auto simulation = Simulation::make(s).value();
  CHECK(simulation.at(4));
  const auto failed = simulation.at(5);
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::NotFinite);
  CHECK_THAT(failed.error().message, contains_text("surface \"s\", frame 4: force \"wind\": "));
  CHECK_THAT(failed.error().message, contains_text("not finite"));
  bad_from = 100;  // the force is valid again, and so is the simulation
  CHECK(simulation.at(5));
  std::get<CustomForce>(s.forces[0].kind).distance = [](const Vector3d&, const ForceTime&) {
    return std::nan("");
  };
  CHECK_FALSE(Simulation::make(s).value().at(3));
  CHECK_FALSE(preview_forces(Simulation::make(s).value()));
}

TEST_CASE("what a custom force throws reaches the caller, and the simulation lives on",
          "[simulation][custom][threads]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0}, 300)});
  bool throws = false;
  const auto of_one = [&](const Vector3d&, const ForceTime& time) {
    if (throws && time.frame == 3) throw std::runtime_error("no wind");
    return Vector3d(0, 1, 0);
  };
  const auto of_many = [&](std::span<const Vector3d> points, const ForceTime& time,
                           std::span<Vector3d> values) {
    for (std::size_t k = 0; k < points.size(); ++k) values[k] = of_one(points[k], time);
  };
  s.forces[0].kind = GENERATE(false, true) ? CustomForce{.unit_force = of_many}
                                           : CustomForce{.unit_force = of_one};
  const std::vector<Field> calm = baked(s, "b");
  throws = true;
  auto simulation = Simulation::make(s, {.threads = 2}).value();
  CHECK_THROWS_AS(simulation.at(8), std::runtime_error);
  throws = false;
  CHECK(simulation.at(8).value().surface("b").positions() == calm[7]);
}

TEST_CASE("scenes built in code are held to the rules of groups and custom forces",
          "[simulation][forces]") {
  const auto message = [](const Scene& s) {
    const auto made = Simulation::make(s);
    REQUIRE_FALSE(made);
    return made.error().message;
  };
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.forces[0].group = "g";
  CHECK(message(s) == "force \"f\" is in \"g\", which is not a group");
  s.groups.push_back({.name = "f"});
  s.forces[0].group = "f";
  CHECK_THAT(message(s), contains_text("<group> name=\"f\": the name is already used"));
  s.groups[0].name = s.forces[0].group = "g";
  s.groups[0].targets = {"t"};
  CHECK(message(s) == "g.targets: no surface is named \"t\"; allowed: s");
  s.groups[0].targets.clear();
  s.groups[0].deformation_radius = curve({{1, 1}, {10, -1}});
  CHECK_THAT(message(s), contains_text("g.deformationRadius at frame 6 is "));
  s.groups[0].deformation_radius = 1;
  s.forces[0].kind = CustomForce{};
  CHECK_THAT(message(s), contains_text("custom, but has no unit_force"));
  s.forces[0].kind = PointChannels{
      .center = PathMotion{Path::make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}).value(), 1.25}};
  CHECK(message(s) == "f.center.progress is 1.25, but must be from 0 to 1");
}

TEST_CASE("a preview of a force in a group is of the group's region", "[simulation][preview]") {
  const Scene alone = scene({sheet("s")}, {poke("f", {0.3, 0, -0.7})});
  const auto a = preview_forces(Simulation::make(alone).value()).value();
  const auto b = preview_forces(Simulation::make(grouped(alone)).value()).value();
  REQUIRE(a.size() == 2);
  REQUIRE(b.size() == 3);  // the force, its group, all
  CHECK(a[0].selected == b[0].selected);
  CHECK(a[0].static_peak == b[0].static_peak);
  Scene silent = grouped(alone);
  silent.groups[0].enabled = false;
  CHECK(preview_forces(Simulation::make(silent).value()).value().empty());
}
