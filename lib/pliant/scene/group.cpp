#include "pliant/scene/group.hpp"

#include <utility>

#include <tinyxml2.h>

#include "pliant/scene/animate.hpp"
#include "pliant/scene/force.hpp"
#include "pliant/scene/path.hpp"

namespace pliant::xml {

Group read_group(const tinyxml2::XMLElement& element, std::vector<Force>& forces, SceneFile& file) {
  Group group;
  Table table = table_of(group);
  read_attributes(element, table, file.findings);
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
  record_element(element, group.name, table, file);
  return group;
}

}  // namespace pliant::xml
