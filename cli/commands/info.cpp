#include "cli/commands/info.hpp"

#include <algorithm>
#include <map>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/info_formats.hpp"
#include "cli/commands/scene_facts.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/mesh_objects.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

BoundingBox bounding_box(const Field& points) {
  return {points.colwise().minCoeff().transpose(), points.colwise().maxCoeff().transpose()};
}

// Plays the animation for what colliders touch, unless that takes too long.
Result<void> play_contacts(SceneFacts& facts, Simulation& simulation) {
  constexpr double most_steps = 1e8;  // of nodes
  const Scene& scene = facts.scene;
  if (facts.contacts.empty() || facts.no_first_frame) return {};
  double nodes = 0;
  for (const ContactSummary& contact : facts.contacts)
    nodes += static_cast<double>(simulation.rest_shapes()[contact.surface].rest.rows());
  double steps = 0;
  for (int frame = scene.start; frame <= scene.end; ++frame) {
    const auto report = simulation.report(frame);
    if (!report) return fail(report.error());
    for (ContactSummary& contact : facts.contacts) {
      const SurfaceReport& of = report->surfaces[contact.surface];
      add_contacts(contact, frame, of.contacts);
      steps += of.steps.count * nodes;
    }
    if (steps > most_steps) return {};
  }
  facts.is_contact_played = true;
  return {};
}

// Computes all facts that need the meshes. Returns whether there is a first frame.
Result<bool> look_at_surfaces(SceneFacts& facts, Simulation& simulation,
                              const SimulationOptions& run) {
  auto previews = preview_forces(simulation, run);
  if (!previews) return fail(previews.error());
  facts.previews = *std::move(previews);
  const auto first = simulation.at(facts.scene.start);
  if (!first && first.error().code != ErrorCode::SolverFailed) return fail(first.error());
  // A loop that does not close has no first frame, but all else that helps to close it.
  if (!first) facts.no_first_frame = first.error();
  for (std::size_t k = 0; k < facts.scene.surfaces.size(); ++k) {
    const RestShape& shape = simulation.rest_shapes()[k];
    facts.surfaces.push_back(
        {shape.grid, summary_of(shape), static_cast<std::size_t>(shape.mesh.vertex_count()),
         bounding_box(first ? first->surfaces()[k].positions()
                            : to_world(facts.scene.surfaces[k].transform.at(facts.scene.start),
                                       shape.mesh.positions)),
         bounding_box(shape.mesh.positions), cache_summary_of(shape), map_summaries_of(shape),
         shape.held ? static_cast<std::size_t>(
                          std::ranges::count_if(*shape.held, [](auto mark) { return mark != 0; }))
                    : 0});
  }
  facts.contacts = contact_summaries(facts.scene, simulation.rest_shapes());
  if (auto played = play_contacts(facts, simulation); !played) return fail(played.error());
  facts.surface_memory = simulation.surface_memory();
  for (const Preview& preview : facts.previews) {
    for (const RegionPreview& region : preview.regions) {
      facts.solver_memory = std::max(facts.solver_memory, region.solver_memory);
    }
  }
  return first.has_value();
}

// How the meshes are read.
std::vector<SceneNote> notes_on_shapes(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  std::vector<SceneNote> notes;
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    const std::string& note = simulation.rest_shapes()[k].note;
    if (auto told = note_on(scene.surfaces[k], note, scene.origin)) notes.push_back(*told);
  }
  return notes;
}

// Why a force has no preview. `group`: the one that it is in, or null.
std::string idle_reason(const Force& force, const Group* group, const Scene& scene) {
  const bool is_animated =
      force.enabled.is_animated() || (group != nullptr && group->enabled.is_animated());
  const int last = is_animated ? scene.end : scene.start;
  for (int frame = scene.start; frame <= last && !was_interrupted(); ++frame) {
    if (force.enabled.at(frame) && (group == nullptr || group->enabled.at(frame))) {
      return "no surface is solved while it is enabled";
    }
  }
  return "never enabled";
}

int tell(const SceneFacts& facts, const InfoOptions& options) {
  const std::string text = options.is_json ? info_json(facts) : info_text(facts);
  if (was_interrupted()) return report(interrupted().value());
  print(stdout, text);
  return exit_done;
}

// Lists the objects of a mesh file.
int run_mesh_info(const InfoOptions& options) {
  if (!options.changes.empty()) {
    return report({ErrorCode::InvalidInput,
                   fmt::format("--set: {} is a mesh, not a scene", printable(options.scene))});
  }
  const SimulationOptions run = simulation_options(options.resources);
  MemoryBudget memory(run.max_memory);
  const auto objects =
      mesh_objects(options.scene, {.memory = &memory, .should_stop = run.should_stop});
  if (!objects) return report(objects.error());
  print(stdout, options.is_json ? objects_json(options.scene, *objects)
                                : objects_text(options.scene, *objects));
  return exit_done;
}

}  // namespace

PreviewLists previews_of(const SceneFacts& facts, Preview::Of of) {
  PreviewLists lists(of == Preview::Of::Force   ? facts.scene.forces.size()
                     : of == Preview::Of::Group ? facts.scene.groups.size()
                                                : 1);
  for (const Preview& preview : facts.previews) {
    if (preview.of == of) lists[preview.index].push_back(&preview);
  }
  return lists;
}

std::vector<std::vector<std::size_t>> members_of_groups(const Scene& scene) {
  std::map<std::string_view, std::size_t> named;
  for (std::size_t k = 0; k < scene.groups.size(); ++k) named.emplace(scene.groups[k].name, k);
  std::vector<std::vector<std::size_t>> members(scene.groups.size());
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    const auto group = named.find(scene.forces[k].group);
    if (group != named.end()) members[group->second].push_back(k);
  }
  return members;
}

std::vector<std::string> idle_reasons(const SceneFacts& facts) {
  const Scene& scene = facts.scene;
  const auto members = members_of_groups(scene);
  std::vector<const Group*> group_of(scene.forces.size());
  for (std::size_t k = 0; k < members.size(); ++k) {
    for (const std::size_t force : members[k]) group_of[force] = &scene.groups[k];
  }
  const PreviewLists previews = previews_of(facts, Preview::Of::Force);
  std::vector<std::string> reasons(scene.forces.size());
  for (std::size_t k = 0; k < reasons.size() && !was_interrupted(); ++k) {
    if (previews[k].empty()) reasons[k] = idle_reason(scene.forces[k], group_of[k], scene);
  }
  return reasons;
}

void add_info(CLI::App& app, InfoOptions& options) {
  CLI::App* info = app.add_subcommand(
      "info", "Show what is in a scene and what each force would do, or the objects of a mesh");
  info->add_option("SCENE|MESH", options.scene, "Scene file, or a mesh file")->required();
  add_root(*info, options.root);
  add_changes(*info, options.changes);
  info->add_flag("--json", options.is_json, "Print JSON instead; docs/info.md describes it");
  info->add_flag("--quiet", options.is_quiet, "No progress");
  add_memory(*info, options.resources);
}

int run_info(const InfoOptions& options) {
  catch_interrupts();
  if (is_mesh_file(options.scene)) return run_mesh_info(options);
  auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) return report(scene.error());
  print_notes(scene->notes);
  SimulationOptions run = simulation_options(options.resources);
  if (scene->surfaces.empty()) {
    if (const auto checked = Simulation::check(*scene, run); !checked) {
      return report(checked.error());
    }
    return tell({.file = title_of_scene(options.scene), .scene = *scene}, options);
  }
  Shelf shelf(part_for_shelf(run));
  run.shelf = &shelf;
  WorkLine line(options.is_quiet);
  run.progressed = line.report();
  run.round_done = line.report_of_rounds();
  auto simulation = Simulation::make(*std::move(scene), run);
  if (!simulation) return report(simulation.error());
  SceneFacts facts{.file = title_of_scene(options.scene), .scene = simulation->scene()};
  const auto looked = look_at_surfaces(facts, *simulation, run);
  line.erase();
  print_notes(notes_on_shapes(*simulation));
  facts.warnings = warnings_about(simulation->rest_shapes(), facts.scene);
  add_still_surfaces(facts.warnings, facts.scene);
  print_warnings(facts.warnings, facts.scene.origin);
  if (!looked) return report(looked.error());
  if (facts.no_first_frame) report(*facts.no_first_frame);
  const int told = tell(facts, options);
  return *looked ? told : exit_failed;
}

}  // namespace pliant::cli
