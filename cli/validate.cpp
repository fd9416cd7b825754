#include "validate.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "interrupt.hpp"
#include "pliant/pliant.hpp"
#include "report.hpp"
#include "scene_input.hpp"

namespace pliant::cli {
namespace {

std::string counted(std::size_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

int validate(const std::string& file, const ValidateOptions& options) {
  const auto scene = read_scene(file, options.root);
  if (!scene) return report(scene.error());
  print_notes(*scene);
  if (const auto checked = Simulation::check(*scene, simulation_options(options.resources));
      !checked) {
    return report(checked.error());
  }
  if (!options.is_quiet) {
    print(stdout, fmt::format("{}: all right: {}, {}, frames {} to {}\n", scene->origin.file,
                              counted(scene->surfaces.size(), "surface"),
                              counted(scene->forces.size(), "force"), scene->start, scene->end));
  }
  return exit_done;
}

}  // namespace

void add_validate(CLI::App& app, ValidateOptions& options) {
  CLI::App* validate = app.add_subcommand("validate", "Read and check scenes without running them");
  validate->add_option("SCENE", options.scenes, "Scene files")->required();
  validate->add_flag("--quiet", options.is_quiet, "Say nothing of scenes that are all right");
  add_root(*validate, options.root);
  add_memory(*validate, options.resources);
}

int run_validate(const ValidateOptions& options) {
  catch_interrupts();
  int worst = exit_done;
  for (const std::string& file : options.scenes) {
    worst = std::max(worst, validate(file, options));
    if (!was_interrupted()) continue;
    return worst == exit_done ? report({ErrorCode::Interrupted, "interrupted"}) : exit_failed;
  }
  return worst;
}

}  // namespace pliant::cli
