#include <utility>

#include <fmt/format.h>

#include "pliant/scene/reading/path.hpp"
#include "pliant/scene/reading/read_elements.hpp"

namespace pliant::xml {
namespace {

/// In a group the group selects the region, so its forces must not have a deformation radius.
void check_radius(const Element& element, Table& table, Findings& findings) {
  Slot& row = *find(table, "deformationRadius");
  if (row.line == 0) return;
  row.is_sound = false;
  findings.add_problem(row.line,
                       fmt::format("{} deformationRadius: a force in a <group> must not have one; "
                                   "the deformationRadius of the group selects the region",
                                   tag(element)));
}

/// Checks that a force has only one falloff: its attribute or a single <falloff>. `first_line` is
/// the line of an earlier <falloff>; 0: this is the first.
void check_single_falloff(const Element& falloff, const Slot& attribute, int& first_line,
                          Findings& findings) {
  const int line = falloff.line();
  const std::string parent = tag(falloff.parent());
  if (first_line != 0)
    findings.add_problem(line, fmt::format("{} has a second <falloff>; the first is at {}", parent,
                                           findings.title_of(first_line, line)));
  else if (attribute.line != 0)
    findings.add_problem(
        line,
        fmt::format("{} has both a <falloff> and the attribute falloff ({}); remove one of them",
                    parent, findings.title_of(attribute.line, line)));
  if (first_line == 0) first_line = line;
}

template <class Kind>
Force standard() {
  Force force;
  force.kind = Kind{};
  if constexpr (requires { Description<Kind>::magnitude; })
    force.magnitude = Description<Kind>::magnitude;
  return force;
}

/// One force of each kind of the variant.
template <class... Kinds>
std::vector<Force> standards(const std::variant<Kinds...>&) {
  return {standard<Kinds>()...};
}

}  // namespace

std::vector<Force> force_kinds() {
  std::vector<Force> kinds = standards(Force().kind);
  std::erase_if(kinds,
                [](const Force& force) { return std::holds_alternative<CustomForce>(force.kind); });
  return kinds;
}

Force standard_force(const Force& force) {
  return std::visit([]<class Kind>(const Kind&) { return standard<Kind>(); }, force.kind);
}

Force read_force(const Element& element, Force force, const Group* group, SceneFile& file) {
  Table table = table_of(force);
  read_attributes(element, table, file.findings);
  int falloff_line = 0;
  const Child children[] = {
      {"animate",
       [&](const Element& child) { read_animate(child, table, force.name, file.findings); }},
      {"path", [&](const Element& child) { read_path(child, table, force.name, file); }},
      {"falloff",
       [&](const Element& child) {
         check_single_falloff(child, *find(table, "falloff"), falloff_line, file.findings);
         force.falloff_curve = read_curve<1>(child, KeyAxis::Falloff, ValueKind::Number,
                                             force.name + ".falloff", file.findings);
       }},
  };
  read_children(element, children, file.findings);
  if (group) {
    force.group = group->name;
    check_radius(element, table, file.findings);
  }
  record_element(element, force.name, table, file);
  return force;
}

Group read_group(const Element& element, std::vector<Force>& forces, SceneFile& file) {
  Group group;
  Table table = table_of(group);
  read_attributes(element, table, file.findings);
  std::vector<Child> children = {
      {"animate",
       [&](const Element& child) { read_animate(child, table, group.name, file.findings); }},
      {"path", [&](const Element& child) { read_path(child, table, group.name, file); }},
  };
  for (const Force& kind : force_kinds())
    children.push_back({kind_of(kind), [&, kind](const Element& child) {
                          forces.push_back(read_force(child, kind, &group, file));
                        }});
  read_children(element, children, file.findings);
  record_element(element, group.name, table, file);
  return group;
}

}  // namespace pliant::xml
