#include <string>
#include <vector>

#include "pliant/scene/checks/check.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// `region="all"`: the whole surface is solved in every frame.

namespace {

Surface plain_mesh(Mesh mesh) {
  Surface surface;
  surface.name = "s";
  surface.shape = std::move(mesh);
  surface.material.density = 0.02;
  surface.material.damping = 0.02;
  return surface;
}

// A sheet and a mesh of triangles, each about a unit or so of displacement.
struct Body {
  std::string name;
  Surface surface;
  double magnitude;
};
std::vector<Body> bodies() {
  Surface grid = sheet("s");
  grid.tangents.su0 = TangentChannel(Channel<1>(0.3));
  return {{"grid", grid, 3000}, {"triangles", plain_mesh(square(12, 6, 0.3)), 60}};
}

Force push(double magnitude, double deformation_radius) {
  Force force = poke("p", {0.4, 0, -0.3}, magnitude);
  force.deformation_radius = deformation_radius;
  return force;
}

std::vector<std::string> problems_of(const Scene& scene) {
  std::vector<std::string> problems;
  for (const Error& error : check_scene(scene)) problems.push_back(error.message);
  return problems;
}

}  // namespace

TEST_CASE("a whole body moves as a region that holds all of it, to the bit", "[simulation][all]") {
  for (auto& [name, surface, magnitude] : bodies()) {
    CAPTURE(name);
    const Scene selected = scene({surface}, {push(magnitude, 1e3)});
    Surface whole = surface;
    whole.solver.region = SolvedRegion::All;
    const auto expected = baked(selected, "s");
    CHECK(peak(expected) > 0.05);
    CHECK(baked(scene({whole}, {push(magnitude, 1e3)}), "s") == expected);
    // The deformation radius selects nothing.
    CHECK(baked(scene({whole}, {push(magnitude, 0)}), "s") == expected);
  }
}

TEST_CASE("a whole body goes on without a force", "[simulation][all]") {
  for (auto& [name, surface, magnitude] : bodies()) {
    CAPTURE(name);
    Force force = push(magnitude, 1e3);
    force.enabled = switch_at({{1, true}, {4, false}});
    surface.tangents = {};
    const auto frozen = baked(scene({surface}, {force}), "s");
    CHECK(frozen[11] == frozen[3]);
    surface.solver.region = SolvedRegion::All;
    const auto whole = baked(scene({surface}, {force}, 600), "s");
    CHECK(whole[3] == frozen[3]);
    CHECK(whole[11] != whole[3]);
    CHECK(largest_difference(whole[599], whole[0]) < 1e-3 * peak(whole));
  }
}

TEST_CASE("tangents alone bend a whole body, and a group's sphere selects nothing of it",
          "[simulation][all]") {
  Surface surface = sheet("s");
  surface.solver.region = SolvedRegion::All;
  surface.tangents.su0 = TangentChannel(Channel<1>(0.5));
  CHECK(peak(baked(scene({surface}, {}), "s")) > 0.05);

  surface.tangents = {};
  Scene grouped = scene({surface}, {push(3000, 0)});
  const auto expected = baked(grouped, "s");
  grouped.groups = {{.name = "g", .center = Value<3>{3, 0, 3}, .deformation_radius = 0.5}};
  grouped.forces[0].group = "g";
  CHECK(baked(grouped, "s") == expected);
  grouped.groups[0].enabled = switch_at({{1, true}, {5, false}});
  const auto silenced = baked(grouped, "s");
  CHECK(silenced[4] == expected[4]);
  CHECK(silenced[5] != expected[5]);
}

TEST_CASE("a body that nothing holds flies off evenly, unless it is static", "[simulation][all]") {
  Surface ball = plain_mesh(sphere(1));
  ball.material.damping = 0;
  ball.solver.region = SolvedRegion::All;
  ball.solver.dt = 1.0 / 24;
  Force wind = poke("wind", {});
  wind.kind = UniformChannels{};
  wind.force_radius = 1e3;
  wind.magnitude = 0.01;
  const auto frames = baked(scene({ball}, {wind}), "s");
  // Steps of backward Euler under an even force: v = n a T, and w is the sum of them.
  for (int frame = 0; frame < 12; ++frame) {
    const double way = 0.01 / 0.02 / (24.0 * 24) * frame * (frame + 1) / 2;
    const Field moved = frames[frame] - frames[0];
    CHECK((moved.col(1).array() - way).abs().maxCoeff() < 1e-9);
    CHECK(moved.col(0).cwiseAbs().maxCoeff() < 1e-9);
  }
  ball.material.density = 0;
  for (const bool checks : {false, true}) {  // in the same words
    const Scene s = scene({ball}, {wind});
    const Error refused = checks ? Simulation::check(s).error() : Simulation::make(s).error();
    CHECK(refused.code == ErrorCode::InvalidInput);
    CHECK_THAT(refused.message, Contains("s.density is 0, and so is damping, but nothing holds the "
                                         "piece with vertex 0"));
  }
}

TEST_CASE("a sheet with free edges flies off evenly, unless it is static",
          "[simulation][all][edges]") {
  Surface kite = sheet("s");
  kite.tangents = {};
  kite.material.density = 0.02;
  kite.material.damping = 0;
  kite.solver.region = SolvedRegion::All;
  kite.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
  kite.solver.dt = 1.0 / 24;
  Force wind = poke("wind", {});
  wind.kind = UniformChannels{};
  wind.force_radius = 1e3;
  wind.magnitude = 0.01;
  const auto frames = baked(scene({kite}, {wind}), "s");
  for (int frame = 0; frame < 12; ++frame) {
    const double way = 0.01 / 0.02 / (24.0 * 24) * frame * (frame + 1) / 2;
    const Field moved = frames[frame] - frames[0];
    CHECK((moved.col(1).array() - way).abs().maxCoeff() < 1e-9);
  }
  // A single hinge does not hold a static sheet, two do.
  kite.material.density = 0;
  for (const Edge second : {Edge::Free, Edge::Pinned}) {
    kite.solver.edges = {Edge::Pinned, Edge::Free, second, Edge::Free};
    auto simulation = Simulation::make(scene({kite}, {wind}));
    CHECK(simulation.has_value() == (second == Edge::Pinned));
    if (simulation)
      CHECK(simulation->at(2));
    else
      CHECK_THAT(simulation.error().message,
                 Contains("s.density is 0") && Contains("nothing holds"));
  }
}

TEST_CASE("edges that are clamped leave every bit as it is", "[simulation][all][edges]") {
  Surface whole = sheet("s");
  whole.solver.region = SolvedRegion::All;
  const auto expected = baked(scene({whole}, {push(3000, 0)}), "s");
  whole.material.poisson = 7;  // acts with free edges only
  CHECK(baked(scene({whole}, {push(3000, 0)}), "s") == expected);
  whole.solver.edges.v1 = Edge::Pinned;
  const auto pinned = baked(scene({whole}, {push(3000, 0)}), "s");
  CHECK(pinned != expected);
  whole.material.poisson = 0.3;
  CHECK(baked(scene({whole}, {push(3000, 0)}), "s") == pinned);
}

TEST_CASE("a plate of one edge is the mirror of one of the other", "[simulation][all][edges]") {
  // u0 <-> u1 mirrors the columns.
  Surface surface = sheet("s");
  surface.tangents = {};
  surface.solver.region = SolvedRegion::All;
  Force middle = poke("p", {0, 0, 0.5}, 2000);
  const auto with = [&](const Edges& edges) {
    surface.solver.edges = edges;
    return baked(scene({surface}, {middle}), "s").back();
  };
  const auto& grid = std::get<GridSheet>(surface.shape);
  for (const Edge edge : {Edge::Pinned, Edge::Free}) {
    const Field first = with({edge, Edge::Clamped, Edge::Clamped, Edge::Pinned});
    const Field last = with({Edge::Clamped, edge, Edge::Clamped, Edge::Pinned});
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const int here = j * grid.columns + i, there = j * grid.columns + grid.columns - 1 - i;
        CHECK_THAT(first(here, 1), WithinAbs(last(there, 1), 1e-10));
      }
    }
  }
}

TEST_CASE("edges need a whole grid, tangents a clamped edge", "[simulation][all][edges]") {
  Surface surface = sheet("s");
  surface.solver.edges.u1 = Edge::Free;
  const auto needs = problems_of(scene({surface}, {}));
  REQUIRE(needs.size() == 1);
  CHECK_THAT(needs[0], Contains("s.edges") && Contains("region=\"all\""));
  surface.solver.region = SolvedRegion::All;
  CHECK(problems_of(scene({surface}, {})).empty());
  surface.tangents.su1 = TangentChannel(Channel<1>(0.5));
  surface.tangents.su0 = TangentChannel(Channel<1>(0.5));
  const auto error = [&] { return Simulation::make(scene({surface}, {})).error().message; };
  CHECK_THAT(error(), Contains("s.su1 is 0.5") && Contains("makes free") && !Contains("s.su0"));
  surface.tangents = {};
  surface.material.poisson = 1.2;
  CHECK_THAT(error(), Contains("s.poisson is 1.2") && Contains("smaller poisson helps"));

  Surface mesh = plain_mesh(sphere(1));
  mesh.solver.region = SolvedRegion::All;
  mesh.solver.edges = surface.solver.edges;
  const auto made = Simulation::make(scene({mesh}, {}));
  REQUIRE_FALSE(made);
  CHECK_THAT(made.error().message, Contains("edges are those of a grid"));
  mesh.solver.edges = {};
  mesh.tangents.su1 = TangentChannel(Channel<1>(0.5));
  for (const Border border : {Border::Clamped, Border::Pinned, Border::Free}) {
    mesh.reading.border = border;
    mesh.solver.region = SolvedRegion::Forces;  // its rim is clamped
    CHECK(Simulation::make(scene({mesh}, {})));
    mesh.solver.region = SolvedRegion::All;
    const auto whole = Simulation::make(scene({mesh}, {}));
    CHECK(whole.has_value() == (border == Border::Clamped));
    if (!whole) CHECK_THAT(whole.error().message, Contains("su1 is 0.5") && Contains("border"));
  }
}

TEST_CASE("edges are given with a whole grid only", "[simulation][all]") {
  const auto complaint = [](const std::string& solver) {
    const auto read = parse_scene(
        "<scene version='1' start='1' end='2'><surface name='s'>"
        "<grid columns='5' rows='5'/><solver " +
            solver + "/></surface></scene>",
        "a.xml", ".");
    return read ? std::string() : read.error().message;
  };
  CHECK(complaint("region='all' edges='clamped'") == "");
  CHECK_THAT(complaint("edges='clamped'"), Contains("s.edges") && Contains("s.region"));
  CHECK_THAT(complaint("region='forces' edges='free'"),
             Contains("s.edges") && Contains("s.region"));
}

TEST_CASE("a force that never reaches a whole body is told", "[simulation][all]") {
  Surface surface = sheet("s");
  surface.solver.region = SolvedRegion::All;
  Force far = push(3000, 0);
  far.kind = PointChannels{.center = Value<3>{0, 50, 0}};
  const auto warnings_of = [&](const Force& force) {
    auto simulation = Simulation::make(scene({surface}, {force})).value();
    for (const int frame : simulation.frames()) REQUIRE(simulation.at(frame));
    return simulation.warnings();
  };
  REQUIRE(warnings_of(far).size() == 1);
  CHECK(warnings_of(far)[0].kind == Warning::Kind::PushesNothing);
  CHECK(warnings_of(push(1000, 0)).empty());
}

TEST_CASE("a whole body of which all nodes are held is told, not its tangents and forces",
          "[simulation][all]") {
  Surface quad = plain_mesh(square(1, 1, 0));
  quad.reading.uv = UvReading::Surface;
  quad.solver.region = SolvedRegion::All;
  quad.tangents.su0 = TangentChannel(Channel<1>(0.3));
  Scene s = scene({quad}, {push(1000, 0)}, 4);
  s.origin = origin_of("s.xml", {{"s.region", 7}});
  auto simulation = Simulation::make(s).value();
  for (const int frame : simulation.frames()) REQUIRE(simulation.at(frame));
  const std::vector<Warning> warnings = simulation.warnings();
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0].message(),
             Contains("all nodes of \"s\" are held at frames 1-3: none can move"));
  CHECK(place_of(warnings[0], s.origin).line == 7);
}

TEST_CASE("a whole body has no other choice of regions", "[simulation][all]") {
  Surface surface = sheet("s");
  surface.solver.region = SolvedRegion::All;
  CHECK(problems_of(scene({surface}, {})).empty());
  const auto check = [&](const auto& change, const char* attribute) {
    Surface changed = surface;
    change(changed.solver);
    const auto problems = problems_of(scene({changed}, {}));
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], Contains("region=\"all\"") && Contains(attribute));
  };
  check([](SolverSettings& solver) { solver.reference = Reference::None; }, "s.reference");
  check([](SolverSettings& solver) { solver.combine = Combine::Islands; }, "s.combine");
  check([](SolverSettings& solver) { solver.release = Release::Recover; }, "s.release");
}
