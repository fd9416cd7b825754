#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/read.hpp"
#include "pliant/simulation/live.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"
#include "support/shared_store.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;
using enum Warning::Kind;

// What is said so that it need not be seen: each warning by a scene that earns it, and by its
// neighbour that does not.

namespace {

std::vector<Warning> warnings_of(const Scene& s) {
  auto simulation = Simulation::make(s).value();
  REQUIRE(simulation.at(s.end));
  return simulation.warnings();
}

// The message of the only warning of a kind; empty: there is none.
std::string told(const std::vector<Warning>& warnings, Warning::Kind kind) {
  std::string message;
  for (const Warning& warning : warnings) {
    if (warning.kind != kind) continue;
    REQUIRE(message.empty());
    message = warning.message();
  }
  return message;
}

std::string told(const Scene& s, Warning::Kind kind) { return told(warnings_of(s), kind); }

Scene parsed(const std::string& contents) {
  return parse_scene("<scene version='1' start='1' end='20'>" + contents + "</scene>", "a.xml", ".")
      .value();
}

// The same sheet as a grid and as a surface of triangles.
Surface sheet_as(bool is_surface, int count = 13) {
  Surface surface = sheet("s", count);
  if (!is_surface) return surface;
  surface.reading.uv = UvReading::Surface;
  return surface;
}

std::vector<bool> both() { return {false, true}; }

Channel<3> moves_to(double x, int end = 12) {
  return vector_curve({{1, {0, 0, 0}}, {double(end), {x, 0, 0}}});
}

}  // namespace

TEST_CASE("that nothing moved is told with the nearest reason", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    CAPTURE(is_surface);
    const Scene moving = scene({sheet_as(is_surface)}, {poke("f", {0, 0, 0})}, 24);
    CHECK(warnings_of(moving).empty());
    const auto reason = [&](const auto& change) {
      Scene s = moving;
      change(s.forces[0]);
      const std::string message = told(s, NothingMoved);
      // It is known before any frame, but for what a force selects.
      std::vector<Warning> ahead;
      add_still_surfaces(ahead, s);
      CHECK(told(ahead, NothingMoved) == message);
      return message;
    };
    CHECK_THAT(reason([](Force& force) { force.enabled = false; }),
               Contains("nothing moved at frames 1-24 of \"s\":") && Contains("\"f\" is disabled"));
    CHECK_THAT(reason([](Force& force) { force.magnitude = 0.0; }),
               Contains("magnitude of \"f\" is 0"));
    CHECK_THAT(
        reason([](Force& force) {
          force.magnitude = curve({{30, 0}, {40, 5000}});
        }),
        Contains("keys of f.magnitude are outside the frames 1 to 24") && Contains("30 to 40"));
    CHECK_THAT(reason([](Force& force) {
                 force.magnitude = curve({{0, 0}, {0.5, 5000}, {1, 0}});
               }),
               Contains("as if they were seconds") && Contains("24 frames are a second"));
    CHECK(reason([](Force& force) { force.magnitude = curve({{1, 0}, {20, 0}, {22, 1}}); }) == "");
  }
  // A force that selects nothing says so itself, and that nothing moved.
  Scene far = scene({sheet("s")}, {poke("f", {0, 50, 0})});
  REQUIRE(warnings_of(far).size() == 1);
  CHECK_THAT(warnings_of(far)[0].message(),
             Contains("selects no node") && Contains("nothing moved"));
  // Without a force, or with one for another surface, nothing was to move.
  CHECK(warnings_of(scene({sheet("s")}, {})).empty());
  Scene two = scene({sheet("s"), sheet("t")}, {poke("f", {0, 0, 0}), poke("g", {0, 0, 0})});
  two.forces[0].targets = {"s"};
  two.forces[1].magnitude = 0.0;
  CHECK(warnings_of(two).empty());
  two.forces[1].targets = {"t"};
  CHECK_THAT(told(two, NothingMoved), Contains("of \"t\":"));
  // Tangents move it too.
  far.forces = {poke("f", {0, 0, 0}, 0)};
  CHECK(told(far, NothingMoved) != "");
  far.surfaces[0].tangents.su0 = TangentChannel(Channel<1>(0.5));
  CHECK(warnings_of(far).empty());
  std::vector<Warning> ahead;
  add_still_surfaces(ahead, far);
  CHECK(ahead.empty());
  // Not before all frames are played.
  far.surfaces[0].tangents = {};
  auto part = Simulation::make(far).value();
  REQUIRE(part.at(6));
  CHECK(part.warnings().empty());
}

TEST_CASE("keys outside the frames are told, unless the curve goes on there",
          "[feedback][warnings]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})}, 24);
  const auto of = [&](Curve<1> magnitude) {
    s.forces[0].magnitude = std::move(magnitude);
    return told(s, KeysOutside);
  };
  CHECK_THAT(of(curve({{30, 5000}, {40, 100}})),
             Contains("keys of f.magnitude are outside the frames 1 to 24") && Contains("after"));
  CHECK_THAT(of(curve({{-20, 0}, {0, 5000}})), Contains("before") && Contains("-20 to 0"));
  CHECK(of(curve({{-20, 0}, {1, 5000}})) == "");
  CHECK(of(curve({{24, 5000}, {40, 0}})) == "");
  CHECK(of(curve({{40, 5000}})) == "");  // a constant
  CurveKeys<1> repeated = curve({{-20, 100}, {0, 5000}}).keys();
  repeated.after.kind = Extrapolation<1>::Kind::Mirror;
  CHECK(of(Curve<1>::make(repeated).value()) == "");
  repeated.after.kind = Extrapolation<1>::Kind::Linear;
  CHECK(of(Curve<1>::make(repeated).value()) == "");
  // The preroll is played.
  s.surfaces[0].solver.preroll = 30;
  CHECK(of(curve({{-20, 0}, {0, 5000}})) == "");
  // What is off is of no concern.
  s.forces.push_back(poke("g", {0, 0, 0}));
  s.forces[1].force_radius = curve({{30, 1}, {40, 2}});
  CHECK(told(s, KeysOutside) != "");
  s.forces[1].enabled = false;
  CHECK(told(s, KeysOutside) == "");
  s.surfaces[0].transform.translate = vector_curve({{50, {0, 0, 0}}, {60, {1, 0, 0}}});
  CHECK_THAT(told(s, KeysOutside), Contains("s.translate"));
}

TEST_CASE("a surface that leaves a force behind is told", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    CAPTURE(is_surface);
    Scene s = scene({sheet_as(is_surface)}, {poke("f", {0, 0, 0})});
    CHECK(told(s, Drifts) == "");
    s.surfaces[0].transform.translate = moves_to(4.4);  // the deformation radius is 4.5
    CHECK(told(s, Drifts) == "");
    s.surfaces[0].transform.translate = moves_to(4.6);
    CHECK_THAT(told(s, Drifts),
               Contains("\"f\" drifts over \"s\" at frame 12") && Contains("deformationRadius"));
    Scene keyed = s;
    std::get<PointChannels>(keyed.forces[0].kind).center = moves_to(4.6);
    CHECK(told(keyed, Drifts) == "");
    keyed = s;
    keyed.forces[0].follow = "s";
    CHECK(told(keyed, Drifts) == "");
    // While it does not push it is nowhere.
    keyed = s;
    keyed.forces[0].magnitude = curve({{1, 5000}, {10, 0}, {12, 0}});
    CHECK(told(keyed, Drifts) == "");
    // Without a place it is everywhere.
    keyed = s;
    keyed.forces[0].kind = UniformChannels{};
    CHECK(told(keyed, Drifts) == "");
    // What is solved as a whole, or by a group, is pushed in the force radius: 2.5.
    keyed = s;
    keyed.surfaces[0].transform.translate = moves_to(2.6);
    CHECK(told(keyed, Drifts) == "");
    keyed.surfaces[0].solver.region = SolvedRegion::All;
    CHECK_THAT(told(keyed, Drifts), Contains("forceRadius"));
    keyed.surfaces[0].solver.region = SolvedRegion::Forces;
    keyed.groups = {{.name = "g", .deformation_radius = 4.5}};
    keyed.forces[0].group = "g";
    CHECK_THAT(told(keyed, Drifts), Contains("\"f\" drifts") && Contains("forceRadius"));
    keyed.groups[0].deformation_radius = 2.55;
    keyed.forces[0].force_radius = 2.7;
    CHECK_THAT(told(keyed, Drifts), Contains("group \"g\" drifts"));
  }
  // A turn moves only what is far from the axis, by a chord.
  Scene turning = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  turning.forces[0].deformation_radius = 8.5;  // corners are at 6 sqrt 2 = 8.485
  turning.surfaces[0].transform.rotate = vector_curve({{1, {0, 0, 0}}, {12, {0, 60, 0}}});
  CHECK(told(turning, Drifts) == "");
  turning.forces[0].deformation_radius = 8.45;
  CHECK_THAT(told(turning, Drifts), Contains("at frame 12"));
  // The shape that a cache moves.
  const ScratchFolder folder;
  std::vector<Field> samples(12, sheet_vertices());
  samples.back().row(3) += Vector3d(0, 4.6, 0).transpose();
  Scene cached = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  cached.surfaces[0].cache.path = write_cache(folder, "a.npy", samples);
  CHECK_THAT(told(cached, Drifts), Contains("drifts over \"s\" at frame 12"));
  cached.forces[0].deformation_radius = 4.7;
  CHECK(told(cached, Drifts) == "");
}

TEST_CASE("a piece that flies away is told", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    CAPTURE(is_surface);
    Surface surface = sheet_as(is_surface);
    surface.solver.region = SolvedRegion::All;
    surface.material.damping = 0.0;
    if (is_surface)
      surface.reading.border = Border::Free;
    else
      surface.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
    Force wind;
    wind.name = "wind";
    wind.kind = UniformChannels{};
    wind.force_radius = 100;
    wind.magnitude =
        40 * 150.0;  // an acceleration of 150: 17 after 11 frames of 1/24 s, beyond 16.97
    Scene s = scene({surface}, {wind}, 14);
    CHECK_THAT(told(s, FliesAway), Contains("\"s\" flies away at frame") && Contains("13"));
    s.forces[0].magnitude = 40 * 50.0;
    CHECK(told(s, FliesAway) == "");
    s.forces[0].magnitude = 40 * 150.0;
    if (is_surface)
      s.surfaces[0].reading.border = Border::Pinned;
    else
      s.surfaces[0].solver.edges.u0 = Edge::Clamped;
    CHECK(told(s, FliesAway) == "");
  }
  // A closed piece beside one that its border holds.
  Mesh two = square(6, 4, 0);
  const Mesh ball = sphere(1);
  const auto first = static_cast<int>(two.positions.rows());
  two.positions.conservativeResize(first + ball.positions.rows(), 3);
  two.positions.bottomRows(ball.positions.rows()) =
      ball.positions.rowwise() + Eigen::RowVector3d(0, 5, 0);
  for (const int size : ball.face_sizes) two.face_sizes.push_back(size);
  for (const int vertex : ball.corner_vertices) two.corner_vertices.push_back(first + vertex);
  two.corner_uvs.assign(two.corner_vertices.size(), -1);
  Surface surface;
  surface.name = "s";
  surface.shape = two;
  surface.reading.uv = UvReading::Surface;
  surface.solver.region = SolvedRegion::All;
  surface.material.density = 0.02;
  Force wind;
  wind.name = "wind";
  wind.kind = UniformChannels{};
  wind.force_radius = 100;
  wind.magnitude = 60;
  CHECK_THAT(told(scene({surface}, {wind}, 24), FliesAway), Contains("\"s\" flies away"));
}

TEST_CASE("a surface that is frozen while it moves is told", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    CAPTURE(is_surface);
    Surface surface = sheet_as(is_surface);
    surface.material.density = 200.0;
    surface.material.damping = 50.0;
    Scene s = scene({surface}, {poke("f", {0, 0, 0})}, 24);
    CHECK(told(s, FrozenMoving) == "");
    s.forces[0].enabled = switch_at({{1, true}, {6, false}});
    CHECK_THAT(told(s, FrozenMoving), Contains("\"s\" is frozen while it moves at frame 6:"));
    Scene slides = s;  // half of what it has moved leaves
    slides.forces[0].enabled = true;
    slides.forces[0].kind = PointChannels{
        .center = vector_curve({{1, {-1.5, 0, 0}}, {5, {-1.5, 0, 0}}, {8, {1.5, 0, 0}}})};
    CHECK_THAT(told(slides, FrozenMoving), Contains("is frozen while it moves"));
    // At rest, and when it goes back to rest.
    Scene rests = s;
    rests.surfaces[0].material.damping = 8000.0;
    rests.end = 200;
    rests.forces[0].enabled = switch_at({{1, true}, {190, false}});
    CHECK(told(rests, FrozenMoving) == "");
    Scene lets_go = s;
    lets_go.surfaces[0].solver.release = Release::Recover;
    CHECK(told(lets_go, FrozenMoving) == "");
    Scene whole = s;
    whole.surfaces[0].solver.region = SolvedRegion::All;
    CHECK(told(whole, FrozenMoving) == "");
  }
}

TEST_CASE("warnings about motion are the same from stored states, and in any order",
          "[feedback][warnings]") {
  Surface surface = sheet("s");
  surface.material.density = 200.0;
  Scene s = scene({surface}, {poke("f", {0, 0, 0})}, 24);
  s.forces[0].enabled = switch_at({{1, true}, {6, false}, {12, true}, {15, false}});
  const std::string expected = told(s, FrozenMoving);
  REQUIRE_THAT(expected, Contains("at frames 6, 15"));
  MemoryStateStore store(std::size_t{1} << 24);
  for (int run = 0; run < 2; ++run) {
    auto simulation = Simulation::make(s, {.store = &store}).value();
    for (const int frame : simulation.frames()) REQUIRE(simulation.at(frame));
    CHECK(told(simulation.warnings(), FrozenMoving) == expected);
    CHECK((run == 0 || simulation.frame_counts().read > 0));
  }
  auto simulation = Simulation::make(s).value();
  for (const int frame : {9, 3, 24, 1, 7}) REQUIRE(simulation.at(frame));
  CHECK(told(simulation.warnings(), FrozenMoving) == expected);
}

TEST_CASE("a force radius beyond the deformation radius is told", "[feedback][warnings]") {
  Scene s = scene({sheet("s"), sheet("t")}, {poke("f", {0, 0, 0})});
  s.forces[0].force_radius = 4.5;
  CHECK(warnings_of(s).empty());
  s.forces[0].force_radius = curve({{1, 4}, {7, 4}, {8, 5}, {12, 5}});
  CHECK_THAT(told(s, RadiusExceeds),
             Contains("forceRadius of \"f\" exceeds deformationRadius at frames 8-11"));
  Scene other = s;  // where only one of its surfaces is cut off
  other.surfaces[1].solver.region = SolvedRegion::All;
  CHECK(told(other, RadiusExceeds) == "");
  other.forces[0].targets = {"s"};
  CHECK(told(other, RadiusExceeds) != "");
  other = s;
  other.forces[0].kind = UniformChannels{};
  CHECK(told(other, RadiusExceeds) == "");
  other = s;
  other.groups = {{.name = "g", .deformation_radius = 4.5}};
  other.forces[0].group = "g";
  CHECK(told(other, RadiusExceeds) == "");
  other = s;
  other.forces[0].deformation_radius = 0.0;  // it pushes in the regions of others
  CHECK(told(other, RadiusExceeds) == "");
}

TEST_CASE("a deformation radius that is written in vain is told", "[feedback][warnings]") {
  const auto read = [](const std::string& region, const std::string& radius) {
    return parsed(
        "<surface name='s'><grid columns='13' rows='13' width='12' depth='12'/>"
        "<solver region='" +
        region + "'/></surface><point name='f' forceRadius='0.5' " + radius + " magnitude='100'/>");
  };
  const Scene s = read("all", "deformationRadius='3'");
  CHECK_THAT(told(s, RadiusUnused),
             Contains("\"f\": deformationRadius has no effect") && Contains("\"s\""));
  CHECK(told(warnings_about(s), RadiusUnused) == told(s, RadiusUnused));
  CHECK(told(read("all", ""), RadiusUnused) == "");
  CHECK(told(read("forces", "deformationRadius='3'"), RadiusUnused) == "");
}

TEST_CASE("inertia of what never moves is told", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    Surface surface = sheet_as(is_surface);
    surface.solver.region = SolvedRegion::All;
    Scene s = scene({surface}, {sway("sway")}, 24);
    // It is why nothing moves.
    REQUIRE(warnings_of(s).size() == 1);
    CHECK_THAT(told(s, NothingMoved), Contains("\"sway\"") && Contains("never moves"));
    CHECK_THAT(told(warnings_about(s), NeverMoves), Contains("\"s\", which never moves"));
    s.forces.push_back(poke("f", {0, 0, 0}));
    CHECK_THAT(told(s, NeverMoves), Contains("\"sway\" has no effect on \"s\""));
    s.surfaces[0].transform.translate = vector_curve({{1, {0, 0, 0}}, {20, {0, 0, 0}}});
    CHECK(told(s, NeverMoves) != "");
    s.surfaces[0].transform.translate = vector_curve({{1, {0, 0, 0}}, {20, {0, 1, 0}}});
    CHECK(told(s, NeverMoves) == "");
  }
  // Of several surfaces one is enough, unless they are named.
  Scene s = scene({sheet("s"), sheet("t")}, {sway("sway"), poke("f", {0, 0, 0})}, 24);
  s.surfaces[1].transform.translate = vector_curve({{1, {0, 0, 0}}, {20, {0, 1, 0}}});
  CHECK(told(s, NeverMoves) == "");
  s.forces[0].targets = {"s", "t"};
  CHECK_THAT(told(s, NeverMoves), Contains("\"s\", which") && !Contains("\"t\""));
}

TEST_CASE("values of a map outside 0 to 1 are told", "[feedback][warnings]") {
  for (const bool is_surface : both()) {
    Surface surface = sheet_as(is_surface);
    const auto with = [&](double least, double most, double low, double high) {
      std::vector<double> values(13 * 13, least);
      values.back() = most;
      surface.maps = {{.channel = MapChannel::Density, .low = low, .high = high, .values = values}};
      return told(scene({surface}, {poke("f", {0, 0, 0})}, 3), MapOutside);
    };
    CHECK(with(0, 1, 0, 1) == "");
    CHECK(with(0.25, 0.75, 0.5, 3) == "");  // factors above 1 are what high is for
    const std::string bytes = with(0, 255, 0, 1);
    CHECK_THAT(bytes, Contains("s.map.density") && Contains("outside 0 to 1") &&
                          Contains("of 0 to 255") && Contains("high=\"0.00392157\""));
    CHECK(with(0, 255, 0, 1.0 / 255) == "");
    CHECK_THAT(with(0.5, 4, 0, 1), Contains("0.5 to 4") && Contains("high=\"0.25\""));
    CHECK_THAT(with(51, 255, 0.2, 1), Contains("of 0 to 255") && Contains("high=\"0.203137\""));
    CHECK(with(51, 255, 0.2, 0.2 + 0.8 / 255) == "");
  }
}

TEST_CASE("a live run warns of what happens in it", "[feedback][warnings]") {
  Surface surface = sheet("s");
  surface.material.density = 200.0;
  const Scene s = scene({surface}, {poke("f", {0, 0, 0})}, 24);
  auto live = LiveSimulation::make(s).value();
  for (int k = 0; k < 5; ++k) REQUIRE(live.advance());
  CHECK(live.warnings().empty());
  REQUIRE(live.set("f.enabled", 0));
  REQUIRE(live.advance());
  CHECK_THAT(told(live.warnings(), FrozenMoving), Contains("frozen while it moves at frame 6:"));
  REQUIRE(live.set("f.enabled", 1));
  REQUIRE(live.set("f.center", Value<3>{0, 50, 0}));
  auto far = LiveSimulation::make(scene({surface}, {poke("f", {0, 50, 0})}, 24)).value();
  REQUIRE(far.advance());
  CHECK(told(far.warnings(), SelectsNothing) != "");
}
