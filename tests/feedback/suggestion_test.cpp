#include "pliant/feedback/suggestion.hpp"

#include <cmath>

#include "pliant/core/shelf.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Suggestion suggestion_of(const Scene& s, const MotionGoals& goals) {
  return suggest_material(Simulation::make(s).value(), goals).value();
}

std::string refusal_of(const Scene& s, const MotionGoals& goals) {
  const auto one = suggest_material(Simulation::make(s).value(), goals);
  REQUIRE_FALSE(one);
  CHECK(one.error().code == ErrorCode::InvalidInput);
  return one.error().message;
}

double baked_peak(const Scene& s, std::size_t surface = 0) {
  auto simulation = Simulation::make(s).value();
  double peak = 0;
  for (const int frame : simulation.frames()) {
    const Frame shown = simulation.at(frame).value();
    peak = std::max(peak, shown.surfaces()[surface].peak_displacement());
  }
  return peak;
}

// The scene with the magnitudes, density and damping of another one.
Scene with_numbers_of(Scene s, const Scene& other) {
  for (std::size_t k = 0; k < s.forces.size(); ++k)
    s.forces[k].magnitude = other.forces[k].magnitude;
  for (std::size_t k = 0; k < s.surfaces.size(); ++k) {
    s.surfaces[k].material.density = other.surfaces[k].material.density;
    s.surfaces[k].material.damping = other.surfaces[k].material.damping;
    s.surfaces[k].material.damping_ratio = other.surfaces[k].material.damping_ratio;
  }
  return s;
}

std::string text_of(const Scene& s) { return to_xml(s).value(); }

Scene poked(int end = 40) {
  Scene s = scene({sheet("s", 17)}, {poke("f", {0.3, 0, 0.2})}, end);
  s.forces[0].magnitude = curve({{1, 0}, {6, 4000}, {14, -500}, {20, 0}});
  return s;
}

}  // namespace

TEST_CASE("the animation has the peak, and only magnitudes change", "[feedback][suggest]") {
  std::vector<std::pair<std::string, Scene>> scenes;
  scenes.emplace_back("keyed", poked());
  Scene s = poked();
  s.forces[0].magnitude = -300.0;
  scenes.emplace_back("negative", s);
  s.forces[0].magnitude = 0.0;
  scenes.emplace_back("zero", s);
  s = poked();
  s.surfaces[0].solver.integrator = Integrator::Newmark;
  s.surfaces[0].solver.measure = Measure::Rest;
  scenes.emplace_back("newmark", s);
  s.surfaces[0].solver.integrator = Integrator::Exact;
  scenes.emplace_back("exact", s);
  s = poked();
  s.surfaces[0].solver.region = SolvedRegion::All;
  scenes.emplace_back("whole", s);
  s = poked();
  s.surfaces[0].solver.measure = Measure::Rest;
  s.surfaces[0].material.yield = 5.0;
  s.forces[0].magnitude = 4000.0;
  scenes.emplace_back("yields", s);
  s = poked();
  s.groups.push_back({.name = "g", .deformation_radius = 6.0});
  s.forces.push_back(poke("h", {2, 0, 1}, -900));
  s.forces[0].group = s.forces[1].group = "g";
  scenes.emplace_back("group", s);
  s = poked();
  s.surfaces[0].transform.scale = Value<3>{1, 3, 1};
  s.surfaces[0].tangents.su0 = Channel<3>(Value<3>{0, 0.05, 0});
  scenes.emplace_back("tangents", s);
  for (const auto& [name, before] : scenes) {
    for (const double peak : {0.05, 1.7}) {
      if (is_sanitized && peak > 1) continue;  // the same code again
      CAPTURE(name, peak);
      const Suggestion one = suggestion_of(before, {.peak = peak});
      CHECK(one.meets_goals());
      REQUIRE(one.peak);
      CHECK_FALSE(one.settling);
      CHECK_THAT(baked_peak(one.scene), WithinRel(peak, 2e-3));
      CHECK_THAT(one.peak->found, WithinRel(baked_peak(one.scene), 1e-9));
      Scene magnitudes = before;
      for (std::size_t k = 0; k < before.forces.size(); ++k)
        magnitudes.forces[k].magnitude = one.scene.forces[k].magnitude;
      CHECK(text_of(magnitudes) == text_of(one.scene));
      // The sign stays, and so do the ratios of several forces.
      const double factor =
          one.values[0].before == 0 ? 0 : one.values[0].after / one.values[0].before;
      CHECK(factor >= 0);
      for (const SuggestedValue& value : one.values) {
        if (factor > 0) CHECK_THAT(value.after, WithinRel(factor * value.before, 2e-3));
      }
      // Asked again, nothing changes.
      const Suggestion again = suggestion_of(one.scene, {.peak = peak});
      CHECK(text_of(again.scene) == text_of(one.scene));
    }
  }
}

TEST_CASE("density and damping make it settle and ring, and leave the magnitudes alone",
          "[feedback][suggest]") {
  for (const bool has_ratio : {false, true}) {
    for (const bool has_keys : {false, true}) {
      Scene s = poked();
      MaterialChannels& material = s.surfaces[0].material;
      s.surfaces[0].solver.dt = 0.001;
      if (has_keys) material.density = curve({{1, 20}, {40, 60}});
      if (has_ratio) material.damping_ratio = 0.5;
      if (has_ratio) material.damping = 1.0;
      const Suggestion one = suggestion_of(s, {.settling = 1.1, .frequency = 2});
      CAPTURE(has_ratio, has_keys);
      CHECK(one.meets_goals());
      CHECK(text_of(with_numbers_of(s, one.scene)) == text_of(one.scene));
      CHECK(one.values.size() == 2);
      CHECK(one.values[0].path == (has_ratio ? "s.dampingRatio" : "s.damping"));
      CHECK(one.values[1].path == "s.density");
      CHECK(one.scene.forces[0].magnitude.curve().keys() == s.forces[0].magnitude.curve().keys());
      if (has_keys) {
        const Channel<1>& density = one.scene.surfaces[0].material.density;
        CHECK_THAT(density.at(40)[0] / density.at(1)[0], WithinRel(3, 2e-3));
      }
      // A preview of the scene tells the same.
      const auto previews = preview_forces(Simulation::make(one.scene).value()).value();
      const RegionPreview& region = previews.back().regions[0];
      CHECK(region.settling.time == one.settling->found);
      CHECK(region.animated.frequency == one.frequency->found);
    }
  }
}

TEST_CASE("all goals at once, and one of them alone", "[feedback][suggest]") {
  Scene s = poked();
  s.surfaces[0].solver.dt = 0.002;
  const Suggestion all = suggestion_of(s, {.peak = 0.7, .settling = 1.1, .frequency = 2});
  CHECK(all.meets_goals());
  CHECK_THAT(baked_peak(all.scene), WithinRel(0.7, 2e-3));
  const Suggestion settles = suggestion_of(s, {.settling = 0.9});
  CHECK(settles.meets_goals());
  CHECK(settles.scene.surfaces[0].material.density.at(1) == Value<1>{40});
  const Suggestion rings = suggestion_of(s, {.frequency = 3});
  CHECK(rings.meets_goals());
  CHECK(rings.scene.surfaces[0].material.damping.at(1) == Value<1>{20});
}

TEST_CASE("a force is examined alone", "[feedback][suggest]") {
  Scene s = poked();
  s.forces.push_back(poke("h", {-5, 0, -4}, 2000));
  s.surfaces[0].solver.combine = Combine::Islands;
  s.forces[1].magnitude = curve({{1, 0}, {12, 0}, {16, 2000}, {20, 0}});
  s.surfaces[0].solver.integrator = GENERATE(Integrator::BackwardEuler, Integrator::Exact);
  const Suggestion one = suggestion_of(s, {.force = "h", .peak = 0.4});
  CHECK(one.meets_goals());
  CHECK(one.values.size() == 1);
  CHECK(one.scene.forces[0].magnitude.curve().keys() == s.forces[0].magnitude.curve().keys());
  Scene alone = one.scene;
  alone.forces.erase(alone.forces.begin());
  CHECK_THAT(baked_peak(alone), WithinRel(0.4, 2e-3));
}

TEST_CASE("a group is examined alone", "[feedback][suggest]") {
  Scene s = poked();
  s.forces.push_back(poke("h", {-2, 0, -3}, 2000));
  s.groups.push_back({.name = "g", .center = Value<3>{-2, 0, -3}, .deformation_radius = 4.0});
  s.forces[1].group = "g";
  const Suggestion one = suggestion_of(s, {.force = "g", .peak = 0.4});
  CHECK(one.meets_goals());
  REQUIRE(one.values.size() == 1);
  CHECK(one.values[0].path == "h.magnitude");
  CHECK_THAT(one.after.played->peak, WithinRel(0.4, 2e-3));
}

TEST_CASE("one of several surfaces", "[feedback][suggest]") {
  Scene s = poked();
  s.surfaces.push_back(sheet("t", 13));
  CHECK(refusal_of(s, {.peak = 1}).find("several surfaces move: s, t") != std::string::npos);
  const Suggestion one = suggestion_of(s, {.surface = "t", .peak = 0.6, .frequency = 3});
  CHECK(one.meets_goals());
  CHECK_THAT(baked_peak(one.scene, 1), WithinRel(0.6, 2e-3));
  CHECK(one.scene.surfaces[0].material.density.at(1) == Value<1>{40});
  REQUIRE(one.notes.size() == 1);
  CHECK(one.notes[0] == "f acts on s too");
  s.forces[0].targets = {"t"};
  CHECK(suggestion_of(s, {.peak = 0.6}).after.surface == 1);
}

TEST_CASE("a force that is 0 begins with 1 if those that are not push nothing",
          "[feedback][suggest]") {
  Scene s = poked();
  Force far = s.forces[0], farther = s.forces[0];
  far.name = "far", farther.name = "farther";
  for (Force* force : {&far, &farther})
    std::get<PointChannels>(force->kind).center = Value<3>{50, 0, 0};
  s.forces.push_back(far);
  s.forces.push_back(farther);
  s.forces[0].magnitude = 0.0;
  s.forces[2].magnitude = 0.0;
  const Suggestion one = suggestion_of(s, {.peak = 1});
  CHECK(one.meets_goals());
  CHECK(one.scene.forces[0].magnitude.at(1)[0] > 0);
  CHECK(one.scene.forces[2].magnitude.at(1)[0] == 0);  // it reaches nothing
}

TEST_CASE("a surface of triangles", "[feedback][suggest]") {
  Scene s = poked();
  s.surfaces[0].shape = square(8, 12, 0.2);
  s.forces[0].deformation_radius = 5.0;
  s.forces[0].force_radius = 4.0;
  s.surfaces[0].solver.dt = 0.002;
  const Suggestion one = suggestion_of(s, {.peak = 0.7, .settling = 1.1, .frequency = 2});
  CHECK(one.meets_goals());
  CHECK_THAT(baked_peak(one.scene), WithinRel(0.7, 2e-3));
}

TEST_CASE("a loop is played from the beginning of its cycle on", "[feedback][suggest]") {
  Scene s = poked();
  s.forces[0].magnitude = curve({{1, 0}, {6, 4000}, {14, -500}, {21, 0}});
  s.surfaces[0].solver.loop = 20;
  s.surfaces[0].transform.scale = vector_curve({{1, {1, 1, 1}}, {40, {1, 2, 1}}});
  for (const int end : {12, 40}) {  // a part of a round, and two
    s.end = end;
    const Suggestion one = suggestion_of(s, {.peak = 0.8});
    CAPTURE(end);
    CHECK(one.meets_goals());
    CHECK_THAT(one.peak->found, WithinRel(baked_peak(one.scene), 1e-5));
    CHECK_THAT(baked_peak(one.scene), WithinRel(0.8, 2e-3));
  }
}

TEST_CASE("a loop without a cycle has no peak, and that is told", "[feedback][suggest]") {
  Scene s = poked();
  s.surfaces[0].shape = sheet("s", 9).shape;
  s.surfaces[0].solver.loop = 20;
  s.surfaces[0].solver.integrator = Integrator::Newmark;
  s.surfaces[0].solver.region = SolvedRegion::All;
  s.surfaces[0].solver.measure = Measure::Rest;
  s.surfaces[0].material.damping = 0.0;
  const auto edges = Edge::Free;
  s.surfaces[0].solver.edges = {edges, edges, edges, edges};
  s.forces[0].magnitude = 400.0;  // it flies away
  const Suggestion one = suggestion_of(s, {.peak = 0.8});
  CHECK_FALSE(one.meets_goals());
  CHECK_FALSE(one.peak->is_known);
  CHECK(one.peak->obstacle == Obstacle::NoCycle);
  CHECK(one.peak->reason.find("does not close to a cycle") != std::string::npos);
  CHECK(text_of(one.scene) == text_of(s));
}

TEST_CASE("with a shelf no matrix is factored twice", "[feedback][suggest]") {
  Scene s = poked();
  s.surfaces[0].shape = square(8, 12, 0.2);
  s.forces[0].deformation_radius = 5.0;
  s.forces[0].force_radius = 4.0;
  for (const bool has_ratio : {false, true}) {
    if (has_ratio) s.surfaces[0].material.damping_ratio = 0.2;
    s.surfaces[0].material.damping = has_ratio ? 1.0 : 20.0;
    Shelf shelf(std::size_t{1} << 30);
    SimulationOptions options;
    options.shelf = &shelf;
    const auto made = Simulation::make(s, options);
    if (!made) FAIL(made.error().message);
    const Simulation& simulation = *made;
    // The mesh is one item, and so is the slowest vibration. Of factors there are the static one,
    // and one for the steps with each density.
    const std::size_t of_mesh = shelf.kept();
    CHECK(preview_forces(simulation, options));
    CHECK(shelf.kept() == of_mesh + 3);
    CHECK(suggest_material(simulation, {.peak = 0.7}, options)->meets_goals());
    CHECK(shelf.kept() == of_mesh + 3);
    CHECK(suggest_material(simulation, {.peak = 0.7, .frequency = 2}, options)->peak->is_known);
    CHECK(shelf.kept() == of_mesh + 4);
  }
}

TEST_CASE("what cannot be reached has its reason, and the rest is found", "[feedback][suggest]") {
  const auto obstacle_of = [](const Scene& s, MotionGoals goals) {
    const Suggestion one = suggestion_of(s, goals);
    CHECK_FALSE(one.meets_goals());
    for (const auto& goal : {one.peak, one.settling, one.frequency}) {
      if (goal && goal->obstacle != Obstacle::None) {
        CHECK(!goal->reason.empty());
        return goal->obstacle;
      }
    }
    return Obstacle::None;
  };
  SECTION("a force far away") {
    Scene s = poked();
    std::get<PointChannels>(s.forces[0].kind).center = Value<3>{0, 30, 0};
    CHECK(obstacle_of(s, {.peak = 1}) == Obstacle::NothingMoves);
    CHECK(obstacle_of(s, {.settling = 1}) == Obstacle::NothingMoves);
    const Suggestion one = suggestion_of(s, {.force = "f", .peak = 1});
    CHECK(one.peak->reason.find("selects nothing") != std::string::npos);
    CHECK(text_of(one.scene) == text_of(s));
    s.forces[0].magnitude = 0.0;
    CHECK(text_of(suggestion_of(s, {.peak = 1}).scene) == text_of(s));
  }
  SECTION("a force that is never enabled, or keyed to 0, or that pushes nothing") {
    Scene s = poked();
    s.forces[0].enabled = false;
    CHECK(obstacle_of(s, {.peak = 1}) == Obstacle::NothingMoves);
    s = poked();
    s.forces[0].magnitude = curve({{1, 0}, {10, 0}});
    CHECK(obstacle_of(s, {.peak = 1}) == Obstacle::NothingMoves);
    s = poked();
    s.forces[0].force_radius = 0.0;
    CHECK(obstacle_of(s, {.peak = 1}) == Obstacle::NothingMoves);
    s = poked(1);
    CHECK(obstacle_of(s, {.peak = 1}) == Obstacle::NothingMoves);
  }
  SECTION("tangents move it further") {
    Scene s = poked();
    s.surfaces[0].tangents.su0 = Channel<3>(Value<3>{0, 80, 0});
    s.surfaces[0].tangents.su1 = Channel<3>(Value<3>{0, -80, 0});
    CHECK(obstacle_of(s, {.peak = 1e-3}) == Obstacle::MovesAnyway);
  }
  SECTION("keys that no factor brings up") {
    Scene s = poked();
    s.surfaces[0].material.damping = curve({{1, 0}, {40, 0}});
    CHECK(obstacle_of(s, {.settling = 1}) == Obstacle::NoDamping);
    s.surfaces[0].material.density = curve({{1, 0}, {40, 0}});
    CHECK(obstacle_of(s, {.frequency = 2}) == Obstacle::NoInertia);
    s.surfaces[0].material.damping = 2.0;
    s.surfaces[0].material.density = 0.0;
    CHECK(suggestion_of(s, {.frequency = 2}).meets_goals());
  }
  SECTION("nothing holds it") {
    Scene s = poked();
    s.surfaces[0].solver.region = SolvedRegion::All;
    s.surfaces[0].solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
    CHECK(obstacle_of(s, {.settling = 1}) == Obstacle::NotHeld);
    CHECK(suggestion_of(s, {.peak = 2}).meets_goals());
    s.surfaces[0].material.damping = 1.0;
    CHECK(suggestion_of(s, {.frequency = 2}).meets_goals());
  }
  SECTION("backward Euler damps") {
    Scene s = poked();
    s.surfaces[0].solver.dt = 0.05;
    const MotionGoals goals{.peak = 1, .settling = 4, .frequency = 2};
    CHECK(obstacle_of(s, goals) == Obstacle::StepsDamp);
    const Suggestion one = suggestion_of(s, goals);
    CHECK(one.scene.surfaces[0].material.damping.at(1) == Value<1>{0});
    CHECK(one.peak->miss() < 2e-3);
    CHECK(one.frequency->miss() < 2e-3);
    s.surfaces[0].solver.integrator = Integrator::Newmark;
    CHECK(suggestion_of(s, goals).meets_goals());
  }
}

TEST_CASE("goals that make no sense are refused", "[feedback][suggest]") {
  const Scene s = poked();
  CHECK(refusal_of(s, {}).find("no goal") != std::string::npos);
  CHECK(refusal_of(s, {.peak = -1}).find("the peak -1") != std::string::npos);
  CHECK(refusal_of(s, {.settling = 0}).find("greater than 0") != std::string::npos);
  CHECK(refusal_of(s, {.frequency = std::nan("")}).find("greater than 0") != std::string::npos);
  CHECK(refusal_of(s, {.force = "g", .peak = 1}).find("there are: f") != std::string::npos);
  CHECK(refusal_of(s, {.surface = "g", .peak = 1}).find("there are: s") != std::string::npos);
  Scene off = s;
  off.surfaces[0].enabled = false;
  CHECK(refusal_of(off, {.surface = "s", .peak = 1}).find("not enabled") != std::string::npos);
  CHECK(refusal_of(off, {.peak = 1}).find("no surface is solved") != std::string::npos);
  Scene other = s;
  other.surfaces.push_back(sheet("t"));
  other.forces[0].targets = {"t"};
  CHECK(refusal_of(other, {.surface = "s", .force = "f", .peak = 1}).find("does not act on") !=
        std::string::npos);
}
