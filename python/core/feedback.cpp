#include "feedback.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "call.hpp"
#include "parts.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/simulation/simulation.hpp"
#include "simulations.hpp"

namespace pliant::python {
namespace {

using py::literals::operator""_a;

/// What a preview and the simulation that it is of share, in bytes: an eighth, as in the command.
std::size_t part_for_shelf(SimulationOptions& options) {
  const std::size_t part = options.max_memory / 8;
  options.max_memory -= part;
  return part;
}

/// Calls `work(simulation, options)` with a simulation of the scene.
template <class Work>
auto with_scene(const py::object& scene, int threads, const std::string& solver,
                const py::object& max_memory, Work&& work) {
  Asking asking;
  SimulationOptions options = options_of(threads, solver, asking, max_memory, py::none());
  Shelf shelf(part_for_shelf(options));
  options.shelf = &shelf;
  Scene native = scene_of(scene, &asking);
  Turn turn(asking);
  return turn.run([&]() -> decltype(work(std::declval<Simulation&>(), options)) {
    auto simulation = Simulation::make(std::move(native), options);
    if (!simulation) return fail(simulation.error());
    return work(*simulation, options);
  });
}

py::object box_object(const Box& box) {
  if (box.is_empty()) return py::none();
  return py::make_tuple(box.i0, box.i1, box.j0, box.j1);
}

/// Counts of a surface of triangles, or None.
py::object counts_object(const CutCounts& counts) {
  if (counts == CutCounts()) return py::none();
  return class_named("CutCounts")(counts.inside_nodes, counts.held_nodes, counts.cells);
}

py::object region_object(const RegionPreview& region) {
  return class_named("RegionPreview")(
      "region"_a = box_object(region.region.box), "counts"_a = counts_object(region.counts),
      "is_solvable"_a = region.is_solvable, "static_peak"_a = region.static_peak,
      "first_frequency"_a = region.first_frequency, "damping_ratio"_a = region.damping_ratio,
      "animated"_a = class_named("Swing")(region.animated.frequency, region.animated.damping_ratio),
      "settling"_a = class_named("Settling")(region.settling.time, region.settling.frames,
                                             region.settling.is_counted),
      "is_held"_a = region.is_held, "has_vibration"_a = region.has_vibration,
      "solver_memory"_a = region.solver_memory);
}

py::object preview_object(const Preview& preview, const Scene& scene) {
  using Of = Preview::Of;
  py::list regions, shares;
  for (const RegionPreview& region : preview.regions) regions.append(region_object(region));
  for (const ForceShare& each : preview.shares)
    shares.append(class_named("ForceShare")(scene.forces[each.force].name, each.share));
  const auto name_if = [&](bool is_one, const auto& things) -> py::object {
    return is_one ? py::object(py::str(things[preview.index].name)) : py::object(py::none());
  };
  const char* const of = preview.of == Of::Force   ? "force"
                         : preview.of == Of::Group ? "group"
                                                   : "all";
  const py::object played =
      preview.played ? class_named("PlayedPeak")(preview.played->peak, preview.played->frame)
                     : py::object(py::none());
  const py::object gap =
      preview.gap ? class_named("Gap")(preview.gap->frame, preview.gap->to_vertex,
                                       preview.gap->to_centre, preview.gap->deformation_radius)
                  : py::object(py::none());
  return class_named("Preview")(
      "surface"_a = scene.surfaces[preview.surface].name, "of"_a = of,
      "force"_a = name_if(preview.of == Of::Force, scene.forces),
      "group"_a = name_if(preview.of == Of::Group, scene.groups),
      "largest_magnitude"_a = preview.largest_magnitude,
      "largest_magnitude_frame"_a = preview.largest_magnitude_frame, "frame"_a = preview.frame,
      "is_every_frame"_a = preview.is_every_frame, "magnitude"_a = preview.magnitude,
      "selected"_a = box_object(preview.selected), "counts"_a = counts_object(preview.counts),
      "is_apart"_a = preview.is_apart, "is_solvable"_a = preview.is_solvable,
      "is_held"_a = preview.is_held, "is_solved"_a = preview.is_solved,
      "static_peak"_a = preview.static_peak, "regions"_a = py::tuple(regions),
      "shares"_a = py::tuple(shares), "played"_a = played, "gap"_a = gap);
}

py::list preview(const py::object& scene, int threads, const std::string& solver,
                 const py::object& max_memory) {
  std::optional<Scene> previewed;
  const auto previews =
      with_scene(scene, threads, solver, max_memory,
                 [&](const Simulation& simulation, const SimulationOptions& options) {
                   previewed = simulation.scene();
                   return preview_forces(simulation, options);
                 });
  py::list list;
  for (const Preview& each : previews) list.append(preview_object(each, *previewed));
  return list;
}

py::object goal_object(const std::optional<GoalResult>& goal) {
  if (!goal) return py::none();
  const bool is_told = goal->obstacle != Obstacle::None;
  return class_named("Goal")(
      goal->wanted, goal->is_known ? py::object(py::float_(goal->found)) : py::object(py::none()),
      is_told ? py::object(py::str(std::string(name_of(goal->obstacle)))) : py::object(py::none()),
      is_told ? py::object(py::str(goal->reason)) : py::object(py::none()));
}

py::object suggest(const py::object& scene, const std::optional<double>& peak,
                   const std::optional<double>& settling, const std::optional<double>& frequency,
                   const std::string& surface, const std::string& force) {
  const MotionGoals goals{surface, force, peak, settling, frequency};
  const Suggestion one =
      with_scene(scene, 1, "auto", py::none(),
                 [&](const Simulation& simulation, const SimulationOptions& options) {
                   return suggest_material(simulation, goals, options);
                 });
  py::list values;
  for (const SuggestedValue& value : one.values)
    values.append(class_named("SuggestedValue")(value.path, value.before, value.after, value.keys));
  return class_named("Suggestion")(python_scene(one.scene, scene), py::tuple(values),
                                   goal_object(one.peak), goal_object(one.settling),
                                   goal_object(one.frequency), one.meets_goals(),
                                   py::tuple(py::cast(one.notes)));
}

}  // namespace

void add_feedback(Module& module) {
  module.def("preview", &preview);
  module.def("suggest", &suggest);
}

}  // namespace pliant::python
