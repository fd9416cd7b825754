// A scene built in code: a mesh as arrays, a curve as an object; no file is read.

#include <cstdio>

#include <pliant/pliant.hpp>

int main() {
  pliant::Surface sheet;
  sheet.name = "sheet";
  sheet.shape = pliant::make_mesh({.columns = 21, .rows = 21, .width = 10, .depth = 10});
  sheet.material.density = 40;

  auto swell =
      pliant::Curve<1>::make({.keys = {{.frame = 1, .value = {0}}, {.frame = 6, .value = {4000}}}});
  if (!swell) return 1;
  pliant::Force poke;
  poke.name = "poke";
  poke.magnitude = *swell;
  poke.deformation_radius = 4;
  poke.force_radius = 2;

  pliant::Scene scene;
  scene.end = 12;
  scene.surfaces.push_back(sheet);
  scene.forces.push_back(poke);

  auto simulation = pliant::Simulation::make(scene);
  if (!simulation) {
    for (const std::string& line : pliant::to_lines(simulation.error())) std::puts(line.c_str());
    return 1;
  }
  double peak = 0;
  for (const int number : simulation->frames()) {
    const auto frame = simulation->at(number);
    if (!frame) return 1;
    peak = frame->surface("sheet").peak_displacement();
  }
  std::printf("peak displacement at the last frame: %g\n", peak);
  return peak > 0 ? 0 : 1;
}
