#include "pliant/scene/checks/check.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "pliant/scene/checks/rules.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/text/findings.hpp"

namespace pliant {

std::string title_of_object(const Scene& scene, const std::string& name) {
  const bool is_collider =
      std::ranges::find(scene.colliders, name, &Collider::name) != scene.colliders.end();
  return fmt::format("{} \"{}\"", is_collider ? "collider" : "surface", name);
}

std::string unreadable_mesh(const Error& error, const std::string& title) {
  return fmt::format("{}: {}: {}", title, error.file, error.message);
}

std::vector<Error> check_scene(const Scene& scene, const StopRequest& should_stop) {
  std::vector<xml::Named> named;
  const auto add = [&](std::string_view element, const std::string& name) {
    named.push_back({element, name, scene.origin.at(name, "name")});
  };
  for (const Surface& surface : scene.surfaces) add(Description<Surface>::element, surface.name);
  for (const Force& force : scene.forces) add(kind_of(force), force.name);
  for (const Group& group : scene.groups) add(Description<Group>::element, group.name);
  for (const Collider& collider : scene.colliders)
    add(Description<Collider>::element, collider.name);
  xml::Findings findings(scene.origin, should_stop);
  xml::check_whole(scene, named, {}, findings);
  return findings.problems();
}

}  // namespace pliant
