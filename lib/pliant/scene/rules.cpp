#include "pliant/scene/rules.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/scene/force.hpp"
#include "pliant/scene/nearest.hpp"

namespace pliant::xml {
namespace {

bool are_constant(std::span<Slot> table, std::initializer_list<std::string_view> names) {
  return std::all_of(names.begin(), names.end(), [&](std::string_view name) {
    const Slot* row = find(table, name);
    return row != nullptr && row->is_constant();
  });
}

bool is_force_element(std::string_view element) {
  const std::vector<Force> kinds = force_kinds();
  return element == "group" || std::any_of(kinds.begin(), kinds.end(), [&](const Force& kind) {
           return kind_of(kind) == element;
         });
}

/// The largest line of these attributes that are given, but at least `line`.
int last_line(std::span<Slot> table, std::initializer_list<std::string_view> names, int line = 0) {
  for (const std::string_view name : names) line = std::max(line, find(table, name)->line);
  return line;
}

}  // namespace

void check_frames(const Scene& scene, std::span<Slot> table, Findings& findings) {
  if (!are_constant(table, {"start", "end"})) return;
  const std::int64_t frames = std::int64_t{scene.end} - scene.start + 1;
  const int line = find(table, "end")->line;
  find(table, "end")->is_sound = frames >= 1 && frames <= max_frames;
  if (frames < 1)
    findings.add_problem(line, fmt::format("<scene> end=\"{}\": must not be before start=\"{}\"",
                                           scene.end, scene.start));
  else if (frames > max_frames)
    findings.add_problem(line, fmt::format("<scene> has {} frames from {} to {}; at most {} are "
                                           "allowed",
                                           frames, scene.start, scene.end, max_frames));
}

void check_nodes(const GridSheet& grid, std::span<Slot> table, int line, Findings& findings) {
  if (!are_constant(table, {"columns", "rows"})) return;
  const std::int64_t nodes = std::int64_t{grid.columns} * grid.rows;
  if (nodes > max_sheet_vertices)
    findings.add_problem(last_line(table, {"columns", "rows"}, line),
                         fmt::format("<grid> has {} x {} = {} vertices; at most {} are allowed",
                                     grid.columns, grid.rows, nodes, max_sheet_vertices));
}

void check_well_posed(const MaterialChannels& material, std::span<Slot> table, Findings& findings) {
  if (!are_constant(table, {"b", "c", "d"})) return;
  const Stiffness stiffness{material.b.at(0)[0], material.c.at(0)[0], material.d.at(0)[0]};
  if (stiffness.is_elliptic()) return;
  find(table, "c")->is_sound = false;
  findings.add_problem(
      last_line(table, {"b", "c", "d"}),
      fmt::format("<material> c = {}: must be greater than -2 sqrt(b d) = {}, "
                  "with b = {} and d = {}; otherwise the plate has no stable shape",
                  stiffness.c, stiffness.least_c(), stiffness.b, stiffness.d));
}

void check_steps(const SolverSettings& solver, std::span<Slot> table, double fps, int line,
                 Findings& findings) {
  if (!are_constant(table, {"dt"})) return;
  const double dt = solver.dt.at(0)[0];
  if (const auto checked = check_time_step(1 / fps, dt); !checked) {
    find(table, "dt")->is_sound = false;
    findings.add_problem(last_line(table, {"dt"}, line), "<solver> dt " + checked.error().message);
  }
}

void check_unique(std::span<const Named> named, Findings& findings) {
  std::map<std::string_view, int> first_lines;
  for (const Named& one : named) {
    const auto [first, is_new] = first_lines.emplace(one.name, one.line);
    if (!is_new)
      findings.add_problem(one.line,
                           fmt::format("<{}> name={}: the name is already used at line {}; "
                                       "surfaces, forces and groups must have different names",
                                       one.element, in_quotes(one.name), first->second));
  }
}

void check_targets(const Scene& scene, std::span<const Targets> targets,
                   std::span<const Named> named, Findings& findings) {
  std::map<std::string_view, std::string_view> elements;
  for (const Named& one : named) elements.emplace(one.name, one.element);
  std::set<std::string_view> names;
  std::vector<std::string_view> surfaces;  // each once, in the order of the file
  for (const Surface& surface : scene.surfaces)
    if (names.insert(surface.name).second) surfaces.push_back(surface.name);
  if (names.contains("")) return;  // a target may mean a surface with an unreadable name

  for (const Targets& listed : targets)
    for (const std::string& target : listed.surfaces) {
      if (findings.is_full()) return;
      if (names.contains(target)) continue;
      const auto found = elements.find(target);
      const bool is_named = found != elements.end();
      const bool is_force = is_named && is_force_element(found->second);
      if (is_named && !is_force) continue;
      findings.add_problem(
          listed.line,
          fmt::format("<{}> targets: {}{}", listed.element,
                      is_force ? fmt::format("{} is a <{}>, not a surface", in_quotes(target),
                                             found->second)
                               : fmt::format("no surface is named {}", in_quotes(target)),
                      hint(target, surfaces)));
    }
}

void note_idle_targets(const Scene& scene, Findings& findings) {
  std::map<std::string_view, const std::vector<std::string>*> targets_of;
  for (const Group& group : scene.groups) targets_of.emplace(group.name, &group.targets);
  for (const Force& force : scene.forces) {
    const auto group = targets_of.find(force.group);
    if (group == targets_of.end() || group->second->empty()) continue;
    const std::vector<std::string>& known = *group->second;
    for (const std::string& target : force.targets)
      if (std::find(known.begin(), known.end(), target) == known.end())
        findings.add_note(
            scene.origin.line_of(force.name, "targets"),
            fmt::format(
                "{}.targets: {} is not a target of the group {}: the force has no effect there",
                force.name, in_quotes(target), in_quotes(force.group)));
  }
}

void check_further(const Scene& scene, std::span<const Named> named, SceneFile& file) {
  std::map<std::string_view, int> times;  // times that a name is used
  for (const Named& one : named) ++times[one.name];
  const auto is_sound = [&](const std::string& name, std::string_view attribute) {
    const auto found = times.find(name);
    return found != times.end() && found->second == 1 &&
           !file.unsound.contains(fmt::format("{}.{}", name, attribute));
  };
  const auto is_plain = [&](std::string_view attribute) {
    return !file.unsound.contains(fmt::format(".{}", attribute));
  };
  if (is_plain("start") && is_plain("end")) {
    const auto is_checked = [&](const std::string& name, std::string_view attribute) {
      return is_sound(name, attribute) && (attribute != "dt" || is_plain("fps"));
    };
    for (Error& error : check_channels(scene, is_checked)) {
      file.findings.add_problem(error.line, std::move(error.message));
    }
  }
  for (const NamedMesh& mesh : file.meshes) {
    if (const auto readable = check_mesh_file(mesh.path); !readable)
      file.findings.add_problem(
          mesh.line, unreadable_mesh(readable.error(), mesh.surface, scene.origin).message);
  }
}

}  // namespace pliant::xml
