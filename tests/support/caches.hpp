#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/text.hpp"
#include "pliant/files/formats.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {

/// Writes positions as a cache, whose samples are one frame apart from `first` on; the name's
/// ending selects the format. A .npy has no first frame.
inline std::string write_cache(const ScratchFolder& folder, const std::string& name,
                               const std::vector<Field>& samples, int first = 1, double fps = 24) {
  Mesh mesh;
  mesh.positions = samples.front();
  const std::string ending = ending_of(name);
  const SurfacePlan plan{.file = folder.file(name),
                         .mesh = &mesh,
                         .first_frame = first,
                         .last_frame = first + static_cast<int>(samples.size()) - 1,
                         .fps = fps};
  auto writer = ending == ".npy"   ? make_npy_writer(plan)
                : ending == ".pc2" ? make_pc2_writer(plan)
                                   : make_mdd_writer(plan);
  bool is_written = true;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto written = (*writer)->write(first + static_cast<int>(k), {samples[k]});
    is_written = is_written && written;
  }
  const auto finished = (*writer)->finish();
  if (!is_written || !finished) std::abort();
  return folder.file(name).string();
}

/// The vertices of `sheet` at rest.
inline Field sheet_vertices(int count = 13) {
  return make_mesh(std::get<GridSheet>(sheet("s", count).shape)).positions;
}

/// A force that pushes nothing, and lets the whole surface be selected.
inline Force everywhere(const std::string& name, Force force) {
  force.name = name;
  force.deformation_radius = force.force_radius = 1000;
  return force;
}

/// Inertia of the whole surface.
inline Force sway(const std::string& name = "sway") {
  Force force;
  force.kind = InertiaChannels{};
  force.magnitude = 1;
  return everywhere(name, force);
}

}  // namespace pliant::testing
