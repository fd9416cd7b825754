// A scene without a file: a mesh as arrays, a force whose magnitude is a curve.

#include <cmath>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "tell.hpp"

namespace {

// A wavy sheet of 31 x 31 vertices. Its (u,v) form an even grid; the order of the vertices is free.
pliant::Mesh wavy_sheet() {
  constexpr int side = 31;
  pliant::Mesh mesh;
  mesh.positions.resize(side * side, 3);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double u = i / (side - 1.0), v = j / (side - 1.0);
      mesh.positions.row(j * side + i) << 10 * u - 5, 0.3 * std::sin(9 * u), 10 * v - 5;
      mesh.uvs.push_back({u, v});
    }
  for (int j = 0; j + 1 < side; ++j)
    for (int i = 0; i + 1 < side; ++i) {
      const int corner = j * side + i;
      mesh.face_sizes.push_back(4);
      for (const int vertex : {corner, corner + side, corner + side + 1, corner + 1}) {
        mesh.corner_vertices.push_back(vertex);
        mesh.corner_uvs.push_back(vertex);
      }
    }
  return mesh;
}

}  // namespace

int main() {
  pliant::Surface sheet;
  sheet.name = "sheet";
  sheet.shape = wavy_sheet();
  sheet.material.density = 40;
  sheet.material.damping = 20;

  // Up within 6 frames, down at once at frame 12.
  auto push = pliant::Curve<1>::make(
      {.keys = {{.frame = 1, .value = {0}},
                {.frame = 6, .value = {4000}},
                {.frame = 12, .value = {0}, .left = pliant::Value<1>{4000}}}});
  if (!push) {
    std::fprintf(stderr, "key %zu: %s\n", push.error().index, push.error().message.c_str());
    return 2;
  }
  pliant::Force poke;  // a point force unless its shape is another
  poke.name = "poke";
  poke.magnitude = *push;
  poke.deformation_radius = 4;
  poke.force_radius = 2;

  pliant::Scene scene;
  scene.start = 1;
  scene.end = 24;
  scene.surfaces = {sheet};
  scene.forces = {poke};

  auto simulation = pliant::Simulation::make(scene);
  if (!simulation) return tell(simulation.error());
  for (const int number : {6, 12, 24, 6}) {  // in any order, with the same bits
    const auto frame = simulation->at(number);
    if (!frame) return tell(frame.error());
    std::printf("frame %2d: peak displacement %.6f\n", number,
                frame->surface("sheet").peak_displacement());
  }
  for (const pliant::Warning& warning : simulation->warnings())
    std::printf("warning: %s\n", warning.message().c_str());
}
