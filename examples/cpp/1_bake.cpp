// Bakes a scene into one file, like `pliant bake SCENE -o OUT`.
// usage: 1_bake SCENE.xml OUT.glb

#include <cstdio>
#include <vector>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main(int count, char* arguments[]) {
  if (count != 3) {
    std::fprintf(stderr, "usage: 1_bake SCENE.xml OUT.glb\n");
    return 2;
  }
  // Every function that can fail returns a Result: a value, or an error with file and line.
  const auto scene = pliant::load_scene(arguments[1]);
  if (!scene) return tell(scene.error());
  auto simulation = pliant::Simulation::make(*scene);
  if (!simulation) return tell(simulation.error());

  // At the first frame every surface is at rest. The writer needs that shape, and the meshes.
  const auto rest = simulation->at(scene->start);
  if (!rest) return tell(rest.error());
  pliant::AnimationPlan plan{.file = arguments[2],
                             .first_frame = scene->start,
                             .last_frame = scene->end,
                             .fps = scene->fps};
  for (const pliant::RestShape& shape : simulation->rest_shapes()) {
    const pliant::SurfaceFrame& surface = rest->surface(shape.name);
    plan.surfaces.push_back({.name = shape.name,
                             .mesh = &shape.mesh,
                             .rest = surface.positions(),
                             .is_mirrored = surface.transform().is_mirrored()});
  }
  const auto writer = pliant::make_writer(plan);
  if (!writer) return tell(writer.error());

  pliant::Frame frame;
  for (const int number : simulation->frames()) {
    auto next = simulation->at(number, std::move(frame));  // reuses the memory of the last one
    if (!next) return tell(next.error());
    frame = *std::move(next);
    std::vector<pliant::SurfacePose> poses;
    for (const pliant::SurfaceFrame& surface : frame.surfaces())
      poses.push_back({.positions = surface.positions(),  // vertices x 3, world space
                       .is_mirrored = surface.transform().is_mirrored()});
    if (auto written = (*writer)->write(number, poses); !written) return tell(written.error());
  }
  // The file appears now, whole.
  if (auto finished = (*writer)->finish(); !finished) return tell(finished.error());
  std::printf("%s: %d frames\n", arguments[2], plan.frame_count());
}
