#include "pliant/scene/group.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/animate.hpp"
#include "pliant/scene/force.hpp"
#include "pliant/scene/path.hpp"
#include "pliant/scene/tables.hpp"

namespace pliant::xml {
namespace {

/// A force in a group may have fewer targets than the group; other targets have no effect.
void note_idle_targets(const Group& group, std::span<const Force> forces, SceneFile& file) {
  if (group.targets.empty()) return;
  for (const Force& force : forces)
    for (const std::string& target : force.targets)
      if (std::find(group.targets.begin(), group.targets.end(), target) == group.targets.end())
        file.findings.add_note(
            file.origin.line_of(force.name, "targets"),
            fmt::format(
                "{}.targets: {} is not a target of the group {}: the force has no effect there",
                force.name, in_quotes(target), in_quotes(group.name)));
}

}  // namespace

Group read_group(const tinyxml2::XMLElement& element, std::vector<Force>& forces, SceneFile& file) {
  Group group;
  Table table = attributes_of(group);
  read_attributes(element, table, file.findings);
  const std::size_t first = forces.size();
  using Element = tinyxml2::XMLElement;
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
  record_acting(element, group.name, group.targets, table, file);
  note_idle_targets(group, std::span(forces).subspan(first), file);
  return group;
}

}  // namespace pliant::xml
