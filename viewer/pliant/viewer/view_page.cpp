#include "pliant/viewer/view_page.hpp"

#include <fmt/format.h>

#include "pliant/files/atomic_file.hpp"
#include "viewer/bake.hpp"
#include "viewer/page.hpp"

namespace pliant {

Result<std::string> view_page(Simulation& simulation, const ViewPageOptions& options) {
  const auto page = viewer::page_template();
  if (!page) return fail(page.error());
  const Scene& scene = simulation.scene();
  const FrameSpan frames = options.frames.value_or(FrameSpan{scene.start, scene.end});
  if (frames.first < scene.start || frames.first > frames.last || frames.last > scene.end) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("a page of frames {} to {}: the scene has frames {} to {}",
                            frames.first, frames.last, scene.start, scene.end));
  }
  const viewer::ViewLimits limits{options.max_memory, options.should_stop};
  const auto bake = viewer::view_bake(simulation, frames, limits, [&] {
    if (options.frame_done) options.frame_done();
  });
  if (!bake) return fail(bake.error());
  return viewer::page_of(*page, scene, *bake, limits);
}

Result<void> write_view_page(Simulation& simulation, const std::string& file,
                             const ViewPageOptions& options) {
  const auto page = view_page(simulation, options);
  if (!page) return fail(page.error());
  return write_file(file, *page, options.should_stop);
}

}  // namespace pliant
