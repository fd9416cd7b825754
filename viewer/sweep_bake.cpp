#include "viewer/sweep_bake.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/result.hpp"
#include "viewer/sweep_table.hpp"
#include "viewer/take_shapes.hpp"

namespace pliant::viewer {
namespace {

Result<void> check_frame(const SweepFolder& folder, std::size_t take, int frame) {
  const auto scene = folder.sweep().scene_of(take);
  if (!scene) return fail(scene.error());
  const auto frames = folder.sweep().frames_of(*scene);
  if (!frames) return fail(frames.error());
  if (frame >= frames->first && frame <= frames->last) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("--frame {}: must be from {} to {}, those of take {}", frame,
                          frames->first, frames->last, take));
}

// The axes, the slowest first: how many rows each has, and which columns it gives.
Json axes_of(const SweepFolder& folder) {
  const TakePlan& plan = folder.sweep().takes().plan();
  Json axes = Json::array();
  const std::size_t first = plan.scene_count > 1 ? 1 : 0;
  if (first > 0) axes.push_back({{"count", plan.scene_count}, {"paths", {0}}});
  for (const TakeAxis& axis : plan.axes) {
    Json paths = Json::array();
    for (const std::size_t path : axis.paths) paths.push_back(first + path);
    axes.push_back({{"count", axis.count}, {"paths", std::move(paths)}});
  }
  return axes;
}

Json titles_of(const SweepFolder& folder) {
  Json titles = Json::array();
  if (folder.request().scenes.size() > 1) titles.push_back("scene");
  for (const VariedPath& path : folder.sweep().takes().paths()) titles.push_back(path.title());
  return titles;
}

// The log has two hashes of these takes.
Json conflicts_of(const SweepStatus& status) {
  Json conflicts = Json::array();
  for (const HashConflict& conflict : status.conflicts) {
    conflicts.push_back({{"take", conflict.take},
                         {"text", fmt::format("its hash differs between {} and {}", conflict.host,
                                              conflict.other_host)}});
  }
  return conflicts;
}

}  // namespace

std::string name_of_folder(const std::string& folder) {
  std::error_code no_folder;
  const std::filesystem::path whole =
      std::filesystem::absolute(folder, no_folder).lexically_normal();
  const std::filesystem::path name =
      whole.has_filename() ? whole.filename() : whole.parent_path().filename();
  return printable(name.empty() ? folder : name.string());
}

Result<SweepViewPlan> plan_sweep_view(const SweepFolder& folder, const SweepStatus& status,
                                      std::optional<int> frame) {
  SweepViewPlan plan;
  std::vector<std::size_t> done;
  for (std::size_t take = 0; take < status.takes.size(); ++take)
    if (status.takes[take].status == TakeStatus::Done) done.push_back(take);
  if (frame && done.empty()) {
    if (auto there = check_frame(folder, 0, *frame); !there) return fail(there.error());
  }
  for (const std::size_t k : evenly_spread(done.size(), most_pictured)) {
    const std::size_t take = done[k];
    if (frame) {
      if (auto there = check_frame(folder, take, *frame); !there) return fail(there.error());
    }
    plan.takes.push_back(take);
    plan.frames[take] = frame.value_or(status.takes[take].measures.peak_frame);
  }
  return plan;
}

Result<SweepBake> bake_sweep(const SweepFolder& folder, const SweepStatus& status,
                             const SweepViewPlan& plan, const SweepViewRun& run) {
  SweepBake bake;
  const auto count = static_cast<int>(std::max<std::size_t>(1, plan.takes.size()));
  TakeShapes shapes(std::min(most_vertices_of_take, most_shown_vertices / count));
  const auto watch = [&](std::size_t take, const Simulation& simulation,
                         const Frame& frame) -> Result<bool> {
    if (frame.number() < plan.frames.at(take)) return true;
    if (auto added = shapes.add(take, simulation, frame); !added) return fail(added.error());
    return false;
  };
  const auto take_done = [&](const TakeOutcome& outcome) -> Result<void> {
    const Measures& table = status.takes[outcome.take].measures;
    if (!outcome.measures) {
      bake.failed[outcome.take] = outcome.measures.error().message;
    } else if (plan.frames.at(outcome.take) >= table.peak_frame &&
               outcome.measures->peak != table.peak) {
      // The frames up to that of the peak give the same peak, to the bit.
      bake.failed[outcome.take] =
          fmt::format("its peak is {}, not {} as in the table", outcome.measures->peak, table.peak);
    }
    if (run.take_done) run.take_done();
    return {};
  };
  const auto ran = folder.sweep().run(
      plan.takes,
      {.threads = run.threads,
       .max_memory = run.max_memory,
       .should_stop = run.should_stop,
       .check = [&](const Scene& scene) { return folder.check_inputs(scene, run.should_stop); },
       .watch = watch,
       .take_done = take_done});
  if (!ran) return fail(ran.error());
  for (const auto& [take, reason] : bake.failed) shapes.remove(take);
  bake.pictured = plan.takes.size() - bake.failed.size();

  const auto is_stopped = [&] { return run.should_stop && run.should_stop(); };
  Arrays arrays;
  const std::vector<std::size_t> rows = table_rows(folder, status, plan.takes, run.should_stop);
  if (is_stopped()) return interrupted();
  Json failures = Json::array();
  for (const auto& [take, reason] : bake.failed)
    failures.push_back({{"take", take}, {"text", reason}});
  const Json head = {{"version", 1},
                     {"name", name_of_folder(folder.folder())},
                     {"command", run.command},
                     {"takes", status.takes.size()},
                     {"done", status.done},
                     {"failed", status.failed},
                     {"paths", titles_of(folder)},
                     {"axes", axes_of(folder)},
                     {"table", table_json(folder, status, rows, arrays, run.should_stop)},
                     {"shapes", shapes.finish(arrays)},
                     {"failures", std::move(failures)},
                     {"conflicts", conflicts_of(status)}};
  if (is_stopped()) return interrupted();
  auto packed = deflated(joined(head, arrays.take()), run.should_stop);
  if (!packed) return fail(packed.error());
  bake.packed = *std::move(packed);
  return bake;
}

}  // namespace pliant::viewer
