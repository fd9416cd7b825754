// Meshes that are hard to solve on, as surfaces of a scene that threads share.

#include <string>
#include <vector>

#include "body/awkward_meshes.hpp"
#include "pliant/simulation/simulation.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

namespace pliant::testing {
namespace {

constexpr int awkward_frames = 5;

// Each mesh is a surface with a force of its own, at first a push and then a pull.
Scene awkward_scene(const std::vector<AwkwardMesh>& meshes) {
  Scene scene;
  scene.end = awkward_frames;
  for (const AwkwardMesh& one : meshes) {
    const std::string number = std::to_string(scene.surfaces.size());
    Surface surface{.name = "s" + number, .shape = one.mesh};
    surface.reading = {.uv = UvReading::Surface, .weld = one.weld};
    surface.material.density = 0.01;
    surface.material.damping = 0.05;
    surface.solver.dt = 0.02;
    scene.surfaces.push_back(surface);
    Force force{.name = "f" + number, .targets = {surface.name}};
    force.magnitude = curve({{1, 9 * one.radius}, {awkward_frames, -3 * one.radius}});
    force.deformation_radius = one.radius;
    force.force_radius = 0.6 * one.radius;
    force.falloff = Falloff::Smooth;
    const Value<3> center = {one.center.x(), one.center.y(), one.center.z()};
    force.kind = PointChannels{.center = center, .direction = Value<3>{0.2, 1, -0.1}};
    scene.forces.push_back(force);
  }
  return scene;
}

// The last frame's vertices of each surface.
std::vector<Field> last_frame(const Scene& scene, int threads) {
  SimulationOptions options;
  options.threads = threads;
  auto simulation = Simulation::make(scene, options).value();
  const Frame frame = simulation.at(awkward_frames).value();
  std::vector<Field> all;
  for (const SurfaceFrame& surface : frame.surfaces()) all.push_back(surface.object_positions());
  return all;
}

}  // namespace

TEST_CASE("threads that share awkward meshes keep their bits",
          "[simulation][surface][awkward][threads]") {
  const std::vector<AwkwardMesh> meshes = awkward_meshes();
  REQUIRE(meshes.size() >= 40);
  const Scene scene = awkward_scene(meshes);
  const std::vector<Field> alone = last_frame(scene, 1);
  CHECK(last_frame(scene, 2) == alone);
  CHECK(last_frame(scene, 3) == alone);
  int moving = 0;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    CAPTURE(meshes[k].name);
    const Field ways = alone[k] - meshes[k].mesh.positions;
    CHECK(ways.allFinite());
    moving += ways.isZero(0) ? 0 : 1;
    for (Eigen::Index vertex = 0; vertex < ways.rows(); ++vertex) {
      const Vector3d place = meshes[k].mesh.positions.row(vertex).transpose();
      // Vertices that are joined are inside if their node is; none is farther from it than this.
      if ((place - meshes[k].center).norm() >= 1.001 * meshes[k].radius)
        CHECK(ways.row(vertex).isZero(0));
    }
  }
  CHECK(moving >= 38);
}

}  // namespace pliant::testing
