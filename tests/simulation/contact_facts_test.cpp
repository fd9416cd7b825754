#include <algorithm>
#include <string>
#include <vector>

#include "pliant/states/state_store.hpp"
#include "support/catch.hpp"
#include "support/met_scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

// What is told of colliders. docs/collisions.md.

TEST_CASE("a floor carries the weight of a free sheet, which its contacts tell at every frame",
          "[simulation][contact]") {
  Surface surface = wide_mat();
  surface.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
  surface.material.density = 0.5;
  const double weight = 2;
  const Scene lying = met_scene(surface, {floor_at(0)}, {weight_of(weight)});
  Simulation simulation = Simulation::make(lying).value();
  const auto contacts_at = [](Simulation& of, int frame) {
    return of.report(frame).value().surfaces[0].contacts;
  };
  const Grid& grid = simulation.rest_shapes()[0].grid.value();
  const double whole = weight * (grid.columns - 1) * grid.hu * (grid.rows - 1) * grid.hv;
  CHECK(contacts_at(simulation, 1).empty());
  std::vector<std::vector<ContactFacts>> told;
  for (int frame = 2; frame <= 12; ++frame) {
    told.push_back(contacts_at(simulation, frame));
    REQUIRE(told.back().size() == 1);
    const ContactFacts& facts = told.back()[0];
    CHECK(facts.touched);
    CHECK(facts.force.y() == Approx(whole).epsilon(1e-9));
    CHECK(std::ranges::is_sorted(facts.nodes));
    CHECK_FALSE(facts.nodes.empty());
  }
  // Backwards, from a store and from saved bytes they are the same.
  for (int frame = 12; frame >= 2; --frame)
    CHECK(contacts_at(simulation, frame) == told[frame - 2]);
  MemoryStateStore store(1 << 24);
  for (int run = 0; run < 2; ++run) {
    SimulationOptions options;
    options.store = &store;
    Simulation stored = Simulation::make(lying, options).value();
    for (int frame = 2; frame <= 12; ++frame) CHECK(contacts_at(stored, frame) == told[frame - 2]);
  }
  Simulation other = Simulation::make(lying).value();
  REQUIRE(other.restore(simulation.state_bytes(7).value()) == 7);
  CHECK(contacts_at(other, 7) == told[5]);
}

TEST_CASE("nothing touches once a collider is disabled, or a surface is not solved",
          "[simulation][contact]") {
  Collider ball = ball_on_keys(1, {{1, {0, 1.2, 0}}, {4, {0, 0.4, 0}}});
  ball.enabled = switch_at({{1, true}, {6, false}});
  Surface halted = wide_mat();
  halted.solver.time_scale = curve({{1, 1}, {6, 1}, {7, 0}});
  for (const Scene& scene : {met_scene(wide_mat(), {ball}), met_scene(halted, {ball})}) {
    Simulation simulation = Simulation::make(scene).value();
    const auto count_at = [&](int frame) {
      std::size_t count = 0;
      const FrameReport report = simulation.report(frame).value();
      for (const ContactFacts& facts : report.surfaces[0].contacts) count += facts.nodes.size();
      return count;
    };
    CHECK(count_at(1) == 0);
    CHECK(count_at(5) > 0);
    CHECK(count_at(6) > 0);  // by the solve at frame 5
    CHECK(count_at(8) == 0);
  }
}

TEST_CASE("nodes that begin inside are counted once, however a step is tried",
          "[simulation][contact]") {
  const Collider inside = ball_on_keys(2, {{1, {0.1, 1.2, 0.05}}});
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    for (const bool yields : {false, true}) {
      for (Surface surface : {wide_mat(), wide_skin()}) {
        surface.solver.integrator = integrator;
        if (yields) surface.material.yield = 0.3;
        Simulation simulation = Simulation::make(met_scene(surface, {inside})).value();
        const Field& rest = simulation.rest_shapes()[0].rest;
        NodesInside expected;
        for (Eigen::Index k = 0; k < rest.rows(); ++k) {
          const double depth = 2 - (rest.row(k) - Eigen::RowVector3d(0.1, 1.2, 0.05)).norm();
          if (depth > 0) expected.add(depth);
        }
        REQUIRE(expected.count > 4);
        const FrameReport report = simulation.report(2).value();
        const NodesInside& found = report.surfaces[0].contacts[0].thrown;
        CHECK(found.count == expected.count);
        CHECK(found.depth == Approx(expected.depth));
      }
    }
  }
}

TEST_CASE("what is inside, held or squeezed is told with its frames", "[simulation][contact]") {
  const auto warnings_of = [](const Scene& scene) {
    Simulation simulation = Simulation::make(scene).value();
    REQUIRE(simulation.at(scene.end));
    std::vector<std::string> all;
    for (const Warning& warning : simulation.warnings()) all.push_back(warning.message());
    return all;
  };
  const auto tells = [](const std::vector<std::string>& all, const std::string& words) {
    return std::ranges::count_if(
        all, [&](const std::string& one) { return one.find(words) != std::string::npos; });
  };
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    const Collider outside = ball_on_keys(2, {{1, {0, 2.5, 0}}, {6, {0, 1.5, 0}}});
    CHECK(warnings_of(met_scene(surface, {outside})).empty());

    Collider inside = ball_on_keys(2, {{1, {0.1, 1.7, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {inside})),
                "begin inside \"ball\" at frame 1, up to 0.2") == 1);
    inside.enabled = switch_at({{1, false}, {5, true}});
    CHECK(tells(warnings_of(met_scene(surface, {inside})), "inside \"ball\" at frame 5,") == 1);

    const Collider through = ball_on_keys(2, {{1, {6, 3, 0}}, {5, {6, 0, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {through})), "inside \"ball\" at frames 3-12,") ==
          1);

    const Collider above = ball_on_keys(2, {{1, {0, 2.2, 0}}, {8, {0, 1.2, 0}}});
    Collider below = ball_on_keys(2, {{1, {0, -2.2, 0}}, {8, {0, -1.2, 0}}});
    below.name = "below";
    const std::vector<std::string> squeezed = warnings_of(met_scene(surface, {above, below}));
    CHECK(tells(squeezed, "presses nodes of \"s\" against") >= 1);
    CHECK(tells(squeezed, "begin inside") == 0);

    const Collider needle = ball_on_keys(0.1, {{1, {0, 3, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {needle})),
                "\"ball\" may pass between the nodes of \"s\"") == 1);
  }
}
