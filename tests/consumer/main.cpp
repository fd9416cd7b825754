// A scene built in code: a mesh as arrays, a curve as an object, a custom force; no file is read.

#include <cmath>
#include <cstdio>
#include <span>
#include <string>

#include <pliant/pliant.hpp>
#include <pliant/timeline/edit/edit.hpp>

int main() {
  pliant::Surface sheet;
  sheet.name = "sheet";
  sheet.shape = pliant::make_mesh({.columns = 21, .rows = 21, .width = 10, .depth = 10});
  sheet.material.density = 40;

  auto swell =
      pliant::Curve<1>::make({.keys = {{.frame = 1, .value = {0}}, {.frame = 6, .value = {4000}}}});
  if (swell) swell = pliant::insert_key(*swell, 3);
  if (!swell) return 1;
  pliant::Force poke;
  poke.name = "poke";
  poke.magnitude = *swell;
  poke.deformation_radius = 4;
  poke.force_radius = 2;

  // A wave that moves along x: a function of one position, and one of many. They depend only on
  // position and time, so any thread may call them.
  pliant::Force wave;
  wave.name = "wave";
  wave.magnitude = 300;
  wave.deformation_radius = 100;
  wave.force_radius = 3;
  wave.falloff = pliant::Falloff::Smooth;
  wave.kind =
      pliant::CustomForce{.distance =
                              [](const pliant::Vector3d& p, const pliant::ForceTime& time) {
                                return std::abs(p.x() + 5 - 20 * time.seconds);  // to its crest
                              },
                          .unit_force =
                              [](std::span<const pliant::Vector3d>, const pliant::ForceTime&,
                                 std::span<pliant::Vector3d> forces) {
                                for (pliant::Vector3d& force : forces) force = {0, 1, 0};
                              }};

  pliant::Scene scene;
  scene.end = 12;
  scene.surfaces.push_back(sheet);
  scene.forces.push_back(poke);
  scene.forces.push_back(wave);

  auto simulation = pliant::Simulation::make(scene);
  if (!simulation) {
    for (const std::string& line : pliant::to_lines(simulation.error())) std::puts(line.c_str());
    return 1;
  }
  const auto report = simulation->report(3);
  const auto told = report ? pliant::to_json(*report, *simulation) : pliant::fail(report.error());
  if (!told || told->find("\"kind\":\"custom\"") == std::string::npos) return 1;
  if (pliant::read_mesh("no_file.obj")) return 1;
  double peak = 0;
  for (const int number : simulation->frames()) {
    const auto frame = simulation->at(number);
    if (!frame) return 1;
    peak = frame->surface("sheet").peak_displacement();
  }
  std::printf("peak displacement at the last frame: %g\n", peak);
  return peak > 0 ? 0 : 1;
}
