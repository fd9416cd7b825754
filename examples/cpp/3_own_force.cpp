// A force of one's own: a wave that runs along x. pliant selects its region, adds its load, and
// plays it in any order like every other force.

#include <cmath>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main() {
  pliant::Surface sheet;
  sheet.name = "sheet";
  sheet.shape = pliant::GridSheet{.columns = 61, .rows = 41, .width = 12, .depth = 8};
  sheet.material.density = 40;

  pliant::Force wave;
  wave.name = "wave";
  wave.magnitude = 2000;
  wave.deformation_radius = 4;  // nearer nodes are solved
  wave.force_radius = 1.5;      // nearer nodes are pushed
  wave.falloff = pliant::Falloff::Smooth;
  wave.kind = pliant::CustomForce{
      // The distance that both radii are compared with: to the crest of the wave.
      .distance =
          [](const pliant::Vector3d& p, const pliant::ForceTime& time) {
            return std::abs(p.x() + 4 - 6 * time.seconds);
          },
      // The force per unit of magnitude and falloff.
      .unit_force = [](const pliant::Vector3d&,
                       const pliant::ForceTime&) { return pliant::Vector3d(0, 1, 0); },
      // Both are pure functions of place and time; threads may call them at once. The key stands
      // for them in caches: change it when they change.
      .key = "wave along x, 6 per second, version 1"};

  pliant::Scene scene;
  scene.start = 1;
  scene.end = 36;
  scene.surfaces = {sheet};
  scene.forces = {wave};
  auto simulation = pliant::Simulation::make(scene, {.threads = 2});
  if (!simulation) return tell(simulation.error());

  for (int number = 1; number <= 36; number += 5) {
    const auto frame = simulation->at(number);
    if (!frame) return tell(frame.error());
    const pliant::Field positions = frame->surface("sheet").positions();
    Eigen::Index highest = 0;
    positions.col(1).maxCoeff(&highest);
    std::printf("frame %2d: the crest is at x = %+.1f, %.3f high\n", number, positions(highest, 0),
                positions(highest, 1));
  }
}
