#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/sweep/sweep.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/core/text.hpp"

namespace pliant::cli {

void add_sweep_bake(CLI::App& sweep, SweepBakeOptions& options) {
  CLI::App* bake = sweep.add_subcommand("bake", "Write the animation of one take");
  bake->add_option("DIR", options.folder, "Folder of a sweep")->required();
  bake->add_option("TAKE", options.take, "Number of the take")->required();
  add_bake_options(*bake, options.bake);
  add_root(*bake, options.bake.root);
}

int run_sweep_bake(const SweepBakeOptions& options) {
  catch_interrupts();
  const auto folder = open_sweep(options.folder, options.bake.root);
  if (!folder) return report(folder.error());
  const Sweep& sweep = folder->sweep();
  const auto number = to_integer(options.take);
  if (!number || *number < 0 || static_cast<std::size_t>(*number) >= sweep.takes().count()) {
    return report(
        {.code = ErrorCode::InvalidInput,
         .message = fmt::format("TAKE {}: {} has the takes 0 to {}", printable(options.take),
                                printable(options.folder), sweep.takes().count() - 1)});
  }
  // With some frames or surfaces only, a file would no longer be what the log says.
  if (auto no_part = check_no_part("-o", options.bake.out, *folder); !no_part)
    return report(no_part.error());
  const auto take = static_cast<std::size_t>(*number);
  const auto status = folder->status(&was_interrupted);
  if (!status) return report(status.error());
  BakeOptions bake = options.bake;
  bake.solver = name_of(sweep.settings().solver);
  const TakeRecord& record = status->takes[take];
  BakeSource source{.read = [&]() -> Result<Scene> {
                      auto scene = sweep.scene_of(take);
                      if (!scene) return scene;
                      if (auto same = folder->check_inputs(*scene, &was_interrupted); !same)
                        return fail(same.error());
                      return scene;
                    },
                    .title = fmt::format("take {}", take)};
  if (!bake.frames) {
    if (record.status == TakeStatus::Done) source.hash = record.measures.hash;
    if (const auto frames = sweep.settings().frames)
      bake.frames = fmt::format("{}:{}", frames->first, frames->last);
  }
  return run_bake(bake, source);
}

}  // namespace pliant::cli
