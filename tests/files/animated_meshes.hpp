#pragma once

#include <cmath>
#include <filesystem>
#include <vector>

#include "pliant/files/writer.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant::testing {

/// A sheet of quads whose first face is flat, with a seam in (u,v), two materials and a group.
inline Mesh dressed_sheet() {
  Mesh mesh = make_mesh({.columns = 4, .rows = 3, .width = 3, .depth = 2});
  mesh.object = "Sheet";
  mesh.uvs.push_back({0.25, 0.75});
  mesh.corner_uvs[5] = static_cast<int>(mesh.uvs.size()) - 1;  // of a vertex shared by other faces
  mesh.corner_normals = shared_normals(mesh, {{}, {}, {Shading::flat, 1, 1, 1, 1, 1}}).value();
  mesh.materials = {{"Skin red", "Steel"}, {0, 0, 1, 1, 0, -1}};
  mesh.groups = {{"left"}, {0, -1, -1, 0, 0, 0}};
  return mesh;
}

/// A growing bump: vertex `middle` rises by 0.1 per frame, all others stay.
inline std::vector<Field> bump(const Field& rest, int middle, int frames) {
  std::vector<Field> all;
  for (int k = 0; k < frames; ++k) {
    all.push_back(rest);
    all.back()(middle, 1) += 0.1 * k;
  }
  return all;
}

/// Writes frames 1, 2, … of surfaces without placements.
inline Result<void> write_all(AnimationPlan plan, const std::vector<std::vector<Field>>& frames) {
  plan.first_frame = 1;
  plan.last_frame = static_cast<int>(frames.front().size());
  auto writer = make_writer(plan);
  if (!writer) return fail(writer.error());
  for (int frame = 1; frame <= plan.last_frame; ++frame) {
    std::vector<SurfacePose> poses;
    for (const auto& of_surface : frames)
      poses.push_back({of_surface[static_cast<std::size_t>(frame - 1)]});
    if (auto written = (*writer)->write(frame, poses); !written) return written;
  }
  return (*writer)->finish();
}

/// Frames 1 to 4 of a still sheet and a collider that goes, grows, turns, and is hidden at frame 3;
/// `points` are those of frame k + 1.
inline Result<void> write_collider(AnimationPlan plan, const Mesh& solid,
                                   const std::vector<Field>& points) {
  plan.colliders = {{"ball-1", &solid, solid.positions}};
  plan.first_frame = 1;
  plan.last_frame = 4;
  auto writer = make_writer(plan);
  if (!writer) return fail(writer.error());
  for (int frame = 1; frame <= 4; ++frame) {
    const SurfacePose sheet{plan.surfaces[0].rest};
    const SurfacePose ball{
        .positions = points[static_cast<std::size_t>(frame - 1)],
        .placement = {{1.0 * frame, 2, 3}, {0, 30.0 * frame, 0}, {1.0 * frame, 1, 1}},
        .is_shown = frame != 3};
    if (auto written = (*writer)->write(frame, {&sheet, 1}, {&ball, 1}); !written) return written;
  }
  return (*writer)->finish();
}

inline AnimationPlan plan_of(const std::filesystem::path& file, const Mesh& mesh) {
  return {.file = file, .surfaces = {{"sheet", &mesh, mesh.positions}}};
}

}  // namespace pliant::testing
