#include "pliant/scene/force.hpp"

#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/animate.hpp"
#include "pliant/scene/falloff.hpp"
#include "pliant/scene/path.hpp"

namespace pliant::xml {
namespace {

/// In a group the group selects the region, so its forces must not have a deformation radius.
void check_radius(const tinyxml2::XMLElement& element, Table& table, Findings& findings) {
  Slot& row = *find(table, "deformationRadius");
  if (row.line == 0) return;
  row.is_sound = false;
  findings.add_problem(row.line,
                       fmt::format("{} deformationRadius: a force in a <group> must not have one; "
                                   "the deformationRadius of the group selects the region",
                                   tag(element)));
}

template <class Kind>
Force standard() {
  Force force;
  force.shape = Kind{};
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
  std::vector<Force> kinds = standards(Force().shape);
  std::erase_if(
      kinds, [](const Force& force) { return std::holds_alternative<CustomForce>(force.shape); });
  return kinds;
}

Force standard_force(const Force& force) {
  return std::visit([]<class Kind>(const Kind&) { return standard<Kind>(); }, force.shape);
}

Force read_force(const tinyxml2::XMLElement& element, Force force, const Group* group,
                 SceneFile& file) {
  Table table = table_of(force);
  read_attributes(element, table, file.findings);
  int falloff_line = 0;
  using Element = tinyxml2::XMLElement;
  const Child children[] = {
      {"animate",
       [&](const Element& child) { read_animate(child, table, force.name, file.findings); }},
      {"path", [&](const Element& child) { read_path(child, table, force.name, file); }},
      {"falloff",
       [&](const Element& child) {
         check_single_falloff(child, *find(table, "falloff"), falloff_line, file.findings);
         force.falloff_curve = read_falloff(child, force.name, file.findings);
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

}  // namespace pliant::xml
