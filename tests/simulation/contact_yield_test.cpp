#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/met_scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Colliders that bend a surface for good. docs/model.md, "Contact".

namespace {

Surface metal(Surface surface, double yield) {
  surface.material.yield = yield;
  surface.material.hardening = 0.2;
  return surface;
}

Collider press() {
  return ball_on_keys(1.5, {{1, {0, 1.8, 0}}, {4, {0, 1, 0}}, {6, {0, 1, 0}}, {9, {0, 4, 0}}});
}

// A node of a surface at rest near the origin, and its share of area.
struct Middle {
  Vector3d place;
  double area;
};

Middle middle_of(const Simulation& simulation) {
  const RestShape& shape = simulation.rest_shapes()[0];
  Eigen::Index node = 0;
  (shape.rest.col(0).cwiseAbs2() + shape.rest.col(2).cwiseAbs2()).minCoeff(&node);
  return {shape.rest.row(node).transpose(), shape.grid->hu * shape.grid->hv};
}

}  // namespace

TEST_CASE("what presses one node of a plate that yields does what a force on it does",
          "[simulation][contact][plastic]") {
  for (const Edge edge : {Edge::Clamped, Edge::Pinned}) {
    Surface surface = metal(wide_mat(), 0.3);
    surface.solver.edges = {edge, edge, edge, edge};
    surface.solver.dt = 1.0;  // one step a frame
    Collider finger = press();
    finger.shape = SphereChannels{.radius = 0.4};
    finger.transform.translate =
        vector_curve({{1, {0, 0.45, 0}}, {4, {0, 0, 0}}, {6, {0, 0, 0}}, {9, {0, 4, 0}}});
    Simulation met = Simulation::make(met_scene(surface, {finger})).value();
    const Middle middle = middle_of(met);
    std::vector<std::pair<double, double>> pushes;
    for (int frame = 1; frame <= 12; ++frame) {
      const FrameReport report = met.report(frame).value();
      double push = 0;
      for (const ContactFacts& facts : report.surfaces[0].contacts) {
        REQUIRE(facts.nodes.size() <= 1);
        push += facts.force.y();
      }
      if (frame > 1) pushes.push_back({frame - 1, push / middle.area});
    }
    CHECK(pushes[3].second < 0);
    CHECK(met.state(0).plastic.cwiseAbs().maxCoeff() > 1e-3);
    Force force = weight_of(1);
    force.magnitude = curve(pushes);
    force.kind = CustomForce{.unit_force = [middle](const Vector3d& p, const ForceTime&) {
      const double dx = p.x() - middle.place.x(), dz = p.z() - middle.place.z();
      return Vector3d(0, dx * dx + dz * dz < 1e-4 ? 1 : 0, 0);
    }};
    const std::vector<Field> found = frames_met(met_scene(surface, {finger}));
    const std::vector<Field> expected = frames_met(met_scene(surface, {}, {force}));
    REQUIRE(peak(expected) > 0.1);
    for (std::size_t k = 0; k < found.size(); ++k) {
      CAPTURE(k);
      CHECK(largest_difference(found[k], expected[k]) < 1e-7 * peak(expected));
    }
  }
}

TEST_CASE("a press dents a plate that yields, which no node enters",
          "[simulation][contact][plastic]") {
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    for (Surface surface : {metal(wide_mat(), 0.3), metal(wide_skin(), 0.3)}) {
      surface.solver.integrator = integrator;
      Collider one = press();
      one.friction = integrator == Integrator::Newmark ? 0.3 : 0;
      const std::vector<Field> frames = frames_met(met_scene(surface, {one}));
      for (std::size_t k = 0; k < frames.size(); ++k) {
        CAPTURE(k, surface.reading.uv == UvReading::Surface);
        REQUIRE(frames[k].allFinite());
        CHECK(depth_in(one, double(k) + 1, frames[k]) < 1e-8);
      }
      surface.material.yield = 1e9;
      const std::vector<Field> elastic = frames_met(met_scene(surface, {one}));
      CHECK(largest_difference(frames[11], elastic[11]) > 0.01);
      // One that never yields does what one does that cannot.
      surface.material.yield.reset();
      const std::vector<Field> plain = frames_met(met_scene(surface, {one}));
      for (std::size_t k = 0; k < plain.size(); ++k)
        CHECK(largest_difference(plain[k], elastic[k]) < 1e-9);
    }
  }
}

TEST_CASE("a collider that stays away leaves the bits of what yields",
          "[simulation][contact][plastic]") {
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    for (Surface surface : {metal(wide_mat(), 0.01), metal(wide_skin(), 0.01)}) {
      surface.solver.integrator = integrator;
      const Force push = poke("push", {0.3, 0, 0.2}, 300);
      const std::vector<Field> alone = frames_met(met_scene(surface, {}, {push}));
      const Collider far = ball_on_keys(1, {{1, {0, 30, 0}}, {6, {0, 20, 0}}});
      CHECK(frames_met(met_scene(surface, {far}, {push})) == alone);
      CHECK(peak(alone) > 0.1);
    }
  }
}
