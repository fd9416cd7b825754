#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "pliant/body/triangle_body.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/plate/vibration.hpp"
#include "pliant/simulation/live.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// A goal over whole runs.

namespace {

constexpr Edges all_free = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};

Surface free_sheet() {
  Surface surface = light(sheet("s"));
  surface.solver.edges = all_free;
  return surface;
}

// Surfaces that nothing holds.
std::vector<Surface> loose() {
  return {light_skin(sphere(2)), light_skin(square(7, 6, 0.3), Border::Free), free_sheet()};
}

Force wind(double magnitude) {
  Force force = poke("wind", {});
  force.kind = UniformChannels{};
  force.force_radius = 1e3;
  force.magnitude = magnitude;
  return force;
}

MaterialMap goal_map(const Surface& surface, const std::function<double(const Vector3d&)>& m) {
  MaterialMap map{.channel = MapChannel::Goal};
  const auto* const grid = std::get_if<GridSheet>(&surface.shape);
  const Mesh mesh = grid ? make_mesh(*grid) : std::get<Mesh>(surface.shape);
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k)
    map.values.push_back(m(mesh.positions.row(k).transpose()));
  return map;
}

std::string refusal_of(const Scene& scene) {
  const auto simulation = Simulation::make(scene);
  return simulation ? "" : simulation.error().message;
}

}  // namespace

TEST_CASE("what nothing else holds swings about its place by a goal", "[simulation][goal]") {
  constexpr double goal = 3, density = 0.02, load = 0.5;
  const double omega = std::sqrt(goal / density);
  for (Surface surface : loose()) {
    surface.material.goal = goal;
    surface.material.density = density;
    surface.material.damping = 0;
    surface.solver.integrator = Integrator::Exact;
    const auto frames = baked(scene({surface}, {wind(load)}, 60), "s");
    for (int frame = 0; frame < 60; ++frame) {
      const double way = load / goal * (1 - std::cos(omega * frame / 24));
      const Field moved = frames[frame] - frames[0];
      CHECK((moved.col(1).array() - way).abs().maxCoeff() < 1e-5 * load / goal);
      CHECK(moved.col(0).cwiseAbs().maxCoeff() < 1e-6 * load / goal);
    }
  }
}

TEST_CASE("static bodies stand where a goal meets the load", "[simulation][goal]") {
  for (Surface surface : loose()) {
    surface.material.goal = 4;
    surface.material.density = 0;
    surface.material.damping = 0;
    const auto frames = baked(scene({surface}, {wind(0.8)}, 3), "s");
    const Field moved = frames[2] - frames[0];
    CHECK((moved.col(1).array() - 0.2).abs().maxCoeff() < 1e-9);
    // Keyed to 0 nothing holds it.
    surface.material.goal = curve({{1, 4}, {3, 0}});
    CHECK_THAT(refusal_of(scene({surface}, {wind(0.8)}, 3)),
               Contains("s.density at frame 3 is 0") && Contains("or a goal"));
  }
}

TEST_CASE("a map of ones is a goal without a map", "[simulation][goal]") {
  std::vector<Surface> surfaces = loose();
  surfaces.push_back(sheet("s"));
  surfaces.back().material.density = 0.02;
  surfaces.back().material.damping = 0.02;
  surfaces.push_back(light_skin(square(7, 6, 0.3)));
  for (Surface surface : surfaces) {
    surface.material.goal = curve({{1, 1}, {8, 40}});
    const Scene even = scene({surface}, {poke("p", {0.4, 0, -0.3}, 60)});
    surface.maps = {goal_map(surface, [](const Vector3d&) { return 1.0; })};
    const Scene mapped = scene({surface}, {poke("p", {0.4, 0, -0.3}, 60)});
    const auto expected = baked(even, "s");
    CHECK(peak(expected) > 1e-3);
    const auto frames = baked(mapped, "s");
    for (std::size_t k = 0; k < frames.size(); ++k)
      CHECK(largest_difference(frames[k], expected[k]) < 1e-9 * peak(expected));
  }
}

TEST_CASE("a goal pulls where its map is not 0, and holds back what it pulls",
          "[simulation][goal]") {
  // The stronger it is, the nearer to rest; the other half moves on.
  for (Surface surface : {free_sheet(), light_skin(square(8, 6, 0), Border::Free)}) {
    surface.maps = {goal_map(surface, [](const Vector3d& p) { return p.x() < -1 ? 1 : 0; })};
    double before = 1e300;
    for (const double goal : {0.1, 10.0, 1e3, 1e5}) {
      surface.material.goal = goal;
      surface.material.density = surface.material.damping = 0;
      const auto frames = baked(scene({surface}, {wind(0.01)}, 3), "s");
      double pulled = 0, other = 0;
      for (Eigen::Index k = 0; k < frames[0].rows(); ++k) {
        const double way = std::abs(frames[2](k, 1) - frames[0](k, 1));
        double& most = frames[0](k, 0) < -1.5 ? pulled : other;
        most = std::max(most, way);
      }
      CHECK(pulled < before);
      CHECK(other > pulled);
      before = pulled;
    }
    CHECK(before < 1e-4);
  }
}

TEST_CASE("a static body needs a goal at nodes that are not in one line", "[simulation][goal]") {
  for (Surface surface :
       {free_sheet(), light_skin(square(8, 6, 0), Border::Free), light_skin(sphere(1))}) {
    surface.material.goal = 3;
    const bool is_ball =
        std::get_if<Mesh>(&surface.shape) && std::get<Mesh>(surface.shape).positions.rows() == 42;
    int place = 0;
    // Nodes of the ball: one. Of sheets: those of a line.
    const auto line = [&](const Vector3d& p) {
      return is_ball ? (place++ == 3 ? 1.0 : 0.0) : std::abs(p.x() + 1) < 0.3 ? 1.0 : 0.0;
    };
    surface.maps = {goal_map(surface, line)};
    CHECK(refusal_of(scene({surface}, {wind(0.1)})).empty());  // it has a density
    Surface still = surface;
    still.material.density = still.material.damping = 0;
    CHECK_THAT(refusal_of(scene({still}, {wind(0.1)})),
               Contains("s.density is 0, and so is damping, but nothing holds") &&
                   Contains("a goal at nodes that are not in one line"));
    CHECK_FALSE(Simulation::check(scene({still}, {wind(0.1)})));
    still.maps = {goal_map(still, [](const Vector3d& p) { return p.x() > 0.2 ? 1 : 0; })};
    const auto frames = baked(scene({still}, {wind(0.1)}, 3), "s");
    CHECK(frames[2].allFinite());
    CHECK(peak(frames) > 0.01);
  }
}

TEST_CASE("a piece within a sphere moves if a goal holds it", "[simulation][goal]") {
  Surface ball = light_skin(sphere(2));
  ball.solver.region = SolvedRegion::Forces;
  Force push = wind(0.3);
  push.kind = PointChannels{};
  push.deformation_radius = 5;
  CHECK(peak(baked(scene({ball}, {push}), "s")) == 0);
  ball.material.goal = 2;
  CHECK(peak(baked(scene({ball}, {push}), "s")) > 0.1);
  ball.material.density = ball.material.damping = 0;
  const auto frames = baked(scene({ball}, {push}, 3), "s");
  CHECK(((frames[2] - frames[0]).col(1).array() - 0.15).abs().maxCoeff() < 1e-9);
}

TEST_CASE("a goal adds itself to the eigenvalue of triangles", "[simulation][goal][vibration]") {
  for (const Border border : {Border::Clamped, Border::Pinned, Border::Free}) {
    const TriangleBody body(
        std::make_shared<TriangleSurface>(
            make_surface(square(7, 1, 0.2), {.unit = std::array<double, 2>{1, 1}}).value()),
        {.measure = Measure::Rest, .region = SolvedRegion::All, .border = border});
    BodyInputs inputs;
    inputs.frame_length = inputs.dt = 1;
    const bool is_free = border == Border::Free;
    const auto smallest = [&](double goal) {
      inputs.goal = goal;
      const StepPlan plan = body.look(inputs).value();
      CHECK(plan.is_held() == (!is_free || goal > 0));
      const TrianglePatch& patch = plan.surface->patches.at(0);
      TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
      return smallest_eigenvalue(plate, bending_of(inputs, body.surface().unit, border),
                                 patch.is_held(), goal)
          .value();
    };
    const double without = is_free ? 0 : smallest(0);
    for (const double goal : {0.5, 300.0})
      CHECK_THAT(smallest(goal), WithinRel(without + goal, 1e-7));
  }
}

TEST_CASE("a damping ratio counts with a goal", "[simulation][goal]") {
  // Of what swings as a whole by its goal: eta = 2 zeta sqrt(g rho).
  for (Surface surface : loose()) {
    surface.material.goal = 5;
    surface.solver.integrator = Integrator::Newmark;
    surface.material.damping = 2 * 0.1 * std::sqrt(5 * 0.02);
    const auto expected = baked(scene({surface}, {wind(0.8)}), "s");
    surface.material.damping = MaterialChannels().damping;
    surface.material.damping_ratio = 0.1;
    const auto frames = baked(scene({surface}, {wind(0.8)}), "s");
    CHECK(largest_difference(frames.back(), expected.back()) < 1e-6 * peak(expected));
    // And the preview tells that vibration.
    const auto simulation = Simulation::make(scene({surface}, {wind(0.8)})).value();
    const auto preview = preview_slowest(simulation, 0, {}).value();
    REQUIRE(preview);
    CHECK(preview->is_held);
    REQUIRE(preview->regions.size() == 1);
    CHECK_THAT(preview->regions[0].first_frequency,
               WithinRel(std::sqrt(5 / 0.02) / 6.283185307179586, 1e-6));
    CHECK_THAT(preview->regions[0].damping_ratio, WithinRel(0.1, 1e-6));
    CHECK_THAT(preview->regions[0].static_peak, WithinRel(0.16, 1e-6));
  }
}

TEST_CASE("a loop closes about the place of a goal", "[simulation][goal]") {
  Surface ball = light_skin(sphere(1));
  ball.material.goal = 4;
  ball.material.damping = 0.2;
  ball.solver.loop = 12;
  Force push = wind(0);
  push.magnitude = curve({{1, 0.5}, {7, -0.5}, {13, 0.5}});
  const auto frames = baked(scene({ball}, {push}, 25), "s");
  CHECK(frames[12] == frames[0]);
  CHECK(frames[24] == frames[0]);
  CHECK(peak(frames) > 0.01);
}

TEST_CASE("a goal needs a shape at rest, and a map of it a goal", "[simulation][goal]") {
  Surface surface = sheet("s");
  surface.material.goal = 2;
  surface.solver.reference = Reference::None;
  CHECK_THAT(refusal_of(scene({surface}, {})),
             Contains("s.goal is 2, but must be 0 with reference=\"none\""));
  surface.material.goal = 0;
  CHECK(refusal_of(scene({surface}, {})).empty());
  auto live = LiveSimulation::make(scene({surface}, {})).value();
  REQUIRE(live.advance());
  REQUIRE(live.set("s.goal", 2.0));
  CHECK_THAT(live.advance().error().message, Contains("but must be 0 with reference=\"none\""));
  surface.solver.reference = Reference::Rest;
  surface.material.goal = -1;
  CHECK_THAT(refusal_of(scene({surface}, {})), Contains("s.goal is -1, but must be at least 0"));
  surface.material.goal = 2;
  surface.maps = {goal_map(surface, [](const Vector3d& p) { return p.x(); })};
  CHECK_THAT(refusal_of(scene({surface}, {})), Contains("s.goal is -12 at node (0, 0) by its map"));
}
