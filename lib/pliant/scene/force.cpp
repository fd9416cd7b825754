#include "pliant/scene/force.hpp"

#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/animate.hpp"
#include "pliant/scene/falloff.hpp"
#include "pliant/scene/path.hpp"
#include "pliant/scene/tables.hpp"

namespace pliant::xml {
namespace {

/// In a group the group selects the region, so its forces must not have a deformation radius.
void check_radius(const tinyxml2::XMLElement& element, Table& table, Findings& findings) {
  Attribute& row = *find(table, "deformationRadius");
  if (row.line == 0) return;
  row.is_sound = false;
  findings.add_problem(row.line,
                       fmt::format("{} deformationRadius: a force in a <group> must not have one; "
                                   "the deformationRadius of the group selects the region",
                                   tag(element)));
}

}  // namespace

std::vector<Force> force_kinds() {
  std::vector<Force> kinds(7);
  kinds[0].shape = PointChannels{};
  kinds[1].shape = RadialChannels{};
  kinds[2].shape = LineChannels{};
  kinds[3].shape = UniformChannels{};
  kinds[4].shape = VortexChannels{};
  kinds[5].shape = NoiseChannels{};
  kinds[6].shape = InertiaChannels{};
  kinds[6].magnitude = 1;
  return kinds;
}

Force read_force(const tinyxml2::XMLElement& element, Force force, const Group* group,
                 SceneFile& file) {
  Table table = attributes_of(force);
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
  record_acting(element, force.name, force.targets, table, file);
  return force;
}

}  // namespace pliant::xml
