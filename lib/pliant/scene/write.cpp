#include "pliant/scene/write.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/elements/write_contents.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/markup.hpp"

namespace pliant {

using namespace xml;

namespace {

/// A <falloff> has keys from 0 to 1, and their end values outside them.
bool is_plain_falloff(const CurveKeys<1>& keys) {
  return keys.keys.front().frame >= 0 && keys.keys.back().frame <= 1 && !keys.loop &&
         keys.before == Extrapolation<1>{} && keys.after == Extrapolation<1>{};
}

std::optional<std::string> what_no_file_contains(const Scene& scene) {
  if (const auto channel = first_adjusted_channel(scene))
    return fmt::format("the curve of {} is adjusted, which a scene file cannot contain", *channel);
  const auto mesh_problem = [](std::string_view thing, const std::string& name) {
    return fmt::format(
        "{} \"{}\" has a mesh made by a program, which a scene file cannot contain; write it to a "
        "mesh file",
        thing, name);
  };
  for (const Surface& surface : scene.surfaces)
    if (std::holds_alternative<Mesh>(surface.shape)) return mesh_problem("surface", surface.name);
  const auto cache_problem = [](const std::string& name, const ShapeCache& cache) {
    return cache.samples.is_empty()
               ? std::nullopt
               : std::optional(fmt::format("{}.cache has samples of a program, which a scene file "
                                           "cannot contain; write them to a file",
                                           name));
  };
  for (const Surface& surface : scene.surfaces)
    if (auto problem = cache_problem(surface.name, surface.cache)) return problem;
  for (const Collider& collider : scene.colliders) {
    const auto* const closed = std::get_if<ClosedMesh>(&collider.shape);
    if (!closed) continue;
    if (closed->made) return mesh_problem("collider", collider.name);
    if (auto problem = cache_problem(collider.name, closed->cache)) return problem;
  }
  for (const Surface& surface : scene.surfaces) {
    for (const MaterialMap& map : surface.maps) {
      if (!map.values.empty())
        return fmt::format(
            "{}.{} has values of a program, which a scene file cannot contain; write them to a "
            "file",
            surface.name, name_of(map.channel));
    }
    for (std::size_t k = 0; k < surface.holds.size(); ++k) {
      if (!surface.holds[k].values.empty())
        return fmt::format(
            "{}.{} has values of a program, which a scene file cannot contain; write them to a "
            "file, or give it the vertices",
            surface.name, name_of_hold(k));
    }
  }
  for (const Force& force : scene.forces) {
    if (std::holds_alternative<CustomForce>(force.kind))
      return fmt::format("force \"{}\" is custom, which a scene file cannot contain", force.name);
    if (force.falloff_curve && !is_plain_falloff(force.falloff_curve->keys()))
      return fmt::format(
          "the falloff curve of \"{}\" has keys outside 0 to 1, a loop or an "
          "extrapolation, which a scene file cannot contain",
          force.name);
  }
  auto group = scene.groups.begin();
  const std::string* last = nullptr;  // the group of the force before
  for (const Force& force : scene.forces) {
    const bool is_next = last == nullptr || *last != force.group;
    last = force.group.empty() ? nullptr : &force.group;
    if (last == nullptr || !is_next) continue;
    group = std::find_if(group, scene.groups.end(),
                         [&](const Group& each) { return each.name == force.group; });
    if (group == scene.groups.end())
      return fmt::format(
          "force \"{}\" is apart from the other forces of the group \"{}\", or "
          "before those of an earlier group; in a scene file they are one after "
          "the other",
          force.name, force.group);
    ++group;
  }
  return {};
}

}  // namespace

Result<std::string> to_xml(const Scene& scene, const std::string& folder,
                           const StopRequest& should_stop) {
  std::vector<Error> errors = check_scene(scene, should_stop);
  StopPoll poll(should_stop);
  constexpr std::size_t parts_of_channel = 256;
  if (errors.empty())
    errors = check_channels(scene, {}, [&] { return poll.after(parts_of_channel); });
  if (is_stopped(should_stop)) return interrupted();
  if (!errors.empty()) return fail(std::move(errors.front()));
  if (auto problem = what_no_file_contains(scene))
    return fail(ErrorCode::InvalidInput, *std::move(problem));
  Scene own = scene;  // contents lead to values that may be changed
  const WrittenElement root = write_contents(contents_of(own), scene_format(), folder, should_stop);
  if (root.copied_keys > Findings::most_copied_keys)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the loops of the scene make {} copied keys; a scene file may have {}",
                            root.copied_keys, Findings::most_copied_keys));
  std::string text = text_of(root.element, {}, {}, should_stop) + '\n';
  if (is_stopped(should_stop)) return interrupted();
  if (const auto markup = markup_of(text, scene.origin.file, should_stop); !markup)
    return fail(markup.error());
  return text;
}

}  // namespace pliant
