#include "cli/view/view_scene.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"

namespace pliant::cli {
namespace {

void print_weight(const viewer::ViewBake& bake) {
  if (bake.position_bytes <= viewer::heavy_positions) return;
  print(stderr, fmt::format("pliant: note: the page unpacks to {} of positions and may be slow to "
                            "open; choose fewer frames with --frames A:B\n",
                            bytes_text(bake.position_bytes)));
}

}  // namespace

viewer::ViewLimits view_limits(const ViewOptions& options, const StopRequest& should_stop) {
  return {simulation_options(options.resources).max_memory, should_stop,
          "choose fewer frames with --frames A:B"};
}

Result<BakedScene> bake_scene(Scene scene, const ViewOptions& options,
                              const StopRequest& should_stop, MemoryStateStore* store) {
  print_notes(scene.notes);
  const auto frames = parse_frames(options.frames, scene);
  if (!frames) return fail(frames.error());
  SimulationOptions run = simulation_options(options.resources);
  run.should_stop = should_stop;
  run.store = store;
  run.round_done = round_line(options.is_quiet);
  if (store != nullptr) run.max_memory -= std::min(run.max_memory, store->byte_budget());
  auto simulation = Simulation::make(std::move(scene), run);
  if (!simulation) return fail(simulation.error());
  auto baked = [&] {
    Progress progress(frames->last - simulation->scene().start + 1, options.is_quiet);
    viewer::ViewLimits limits = view_limits(options, should_stop);
    limits.max_memory = run.max_memory;
    return viewer::view_bake(*simulation, *frames, limits, [&] { progress.advance(); });
  }();
  print_warnings(*simulation);
  if (!baked) return fail(baked.error());
  if (!options.is_quiet) print_weight(*baked);
  return BakedScene{simulation->scene(), *frames, *std::move(baked), simulation->frame_counts()};
}

}  // namespace pliant::cli
