#include "pliant/scene/force.hpp"

#include <utility>

#include <tinyxml2.h>

#include "pliant/scene/animate.hpp"
#include "pliant/scene/tables.hpp"

namespace pliant::xml {

Force read_force(const tinyxml2::XMLElement& element, decltype(Force::shape) shape,
                 SceneFile& file) {
  Force force;
  force.shape = std::move(shape);
  Table table = attributes_of(force);
  read_attributes(element, table, file.findings);
  const Child children[] = {
      {"animate",
       [&](const tinyxml2::XMLElement& child) {
         read_animate(child, table, force.name, file.findings);
       }},
      {"falloff", {}},
  };
  read_children(element, children, file.findings);
  if (!force.targets.empty())
    file.targets.push_back({element.Name(), force.targets, find(table, "targets")->line});
  if (!force.name.empty()) {
    file.origin.lines[force.name] = element.GetLineNum();
    record(force.name, table, file);
  }
  return force;
}

}  // namespace pliant::xml
