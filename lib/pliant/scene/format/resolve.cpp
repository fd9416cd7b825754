#include "pliant/scene/format/resolve.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/artist_words.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/nearest.hpp"

namespace pliant::xml {
namespace {

constexpr std::string_view part_words[] = {"x", "y", "z", "progress", "closed"};

void append(Table& table, Table slots) { std::ranges::move(slots, std::back_inserter(table)); }

// The slots of a thing, of its shape, and of its parts.
template <class Thing>
Table all_slots(Thing& thing) {
  Contents contents = contents_of(thing);
  Table table = std::move(contents.attributes);
  for (ChildPlace& place : contents.children) {
    if (contents.driver && !contents.driver->empty() && !place.row.is_of_driven) continue;
    if (place.part) append(table, std::move(place.part->attributes));
    if (!place.row.noun.empty())
      place.kinds.for_each([&](Contents& one) { append(table, std::move(one.attributes)); });
  }
  return table;
}

Table all_slots(const NamedThings& things, const std::string& name) {
  if (Surface* const surface = things.surface(name)) return all_slots(*surface);
  if (Force* const force = things.force(name)) return all_slots(*force);
  if (Group* const group = things.group(name)) return all_slots(*group);
  if (Collider* const collider = things.collider(name)) return all_slots(*collider);
  return name == Description<Scene>::element ? all_slots(things.scene()) : Table();
}

const ElementFormat* format_of(std::string_view element) {
  return find_format(scene_format(), element);
}

/// The formats whose attributes a thing with a shape has.
template <class Thing>
std::vector<const ElementFormat*> formats_of(std::string_view shape, bool is_driven) {
  std::vector<const ElementFormat*> formats = {format_of(Description<Thing>::element)};
  for (const ChildFormat& child : formats.front()->children) {
    if (is_driven && !child.row.is_of_driven) continue;
    if (child.is_choice()) formats.push_back(format_of(shape));
    if (child.is_part) formats.push_back(format_of(child.names.front()));
  }
  std::erase(formats, nullptr);  // a mesh of a program has no element
  return formats;
}

/// That of a force, even of a program's own kind, which has no element in a file.
const ElementFormat* format_of(const Force& force) {
  static const ElementFormat custom = [] {
    Force own;
    own.kind = CustomForce();
    return pliant::formats_of(contents_of(own)).front();
  }();
  return std::holds_alternative<CustomForce>(force.kind) ? &custom : format_of(kind_of(force));
}

/// Those of the one that is not null, or of the scene.
std::vector<const ElementFormat*> formats_of(const Surface* surface, const Force* force,
                                             const Group* group, const Collider* collider,
                                             std::string_view name) {
  if (surface) return formats_of<Surface>(shape_of(*surface), surface->is_driven());
  if (collider) return formats_of<Collider>(pliant::shape_of(*collider), false);
  if (force) return {format_of(*force)};
  if (group) return {format_of(Description<Group>::element)};
  if (name == Description<Scene>::element) return {format_of(name)};
  return {};
}

std::string no_attribute(const ValuePath& path, const std::vector<const ElementFormat*>& formats) {
  std::vector<std::string_view> names, elements;
  for (const ElementFormat* const element : formats) {
    elements.push_back(element->name);
    for (const AttributeFormat& format : element->attributes)
      if (format.need != Need::Later) names.push_back(format.name);
  }
  std::rotate(elements.begin(), elements.begin() + 1, elements.end());  // its parts first
  std::vector<std::string_view> own;
  return fmt::format("{} has no attribute {}{}", in_quotes(path.name), in_quotes(path.attribute),
                     attribute_hint(elements, path.attribute, names, own));
}

/// Why a value has no such part; empty: it has.
std::string no_part(const ResolvedPath& at) {
  const ValuePath& path = at.path;
  if (std::ranges::find(part_words, path.part) == std::end(part_words))
    return fmt::format("{} has no part {}{}", path.title(), in_quotes(path.part),
                       hint(path.part, part_words));
  if (path.is_of_path())
    return at.format->is_position
               ? ""
               : fmt::format("{} is not a position, so it has no {}", path.title(), path.part);
  return at.format->has_components()
             ? ""
             : fmt::format("{} is a single {}, so it has no x, y and z", path.title(),
                           at.format->type == "number" ? "number" : "value");
}

}  // namespace

std::optional<ValuePath> split_path(std::string_view path) {
  const std::size_t first = path.find('.');
  if (first == std::string_view::npos || first == 0) return {};
  const std::string_view rest = path.substr(first + 1);
  const std::size_t second = std::min(rest.find('.'), rest.size());
  ValuePath parts{std::string(path.substr(0, first)), std::string(rest.substr(0, second))};
  if (second < rest.size()) parts.part = rest.substr(second + 1);
  if (parts.attribute.empty() || (second < rest.size() && parts.part.empty())) return {};
  return parts;
}

NamedThings::NamedThings(Scene& scene) : scene_(scene) {
  // Of several of one name the first.
  for (Surface& surface : scene.surfaces) surfaces_.try_emplace(surface.name, &surface);
  for (Force& force : scene.forces) forces_.try_emplace(force.name, &force);
  for (Group& group : scene.groups) groups_.try_emplace(group.name, &group);
  for (Collider& collider : scene.colliders) colliders_.try_emplace(collider.name, &collider);
}

std::vector<const ElementFormat*> NamedThings::elements(const std::string& name) const {
  return formats_of(surface(name), force(name), group(name), collider(name), name);
}

PathScope scope_of(const Scene& scene) {
  const auto find = [](const auto& things, const std::string& name) {
    const auto found =
        std::ranges::find_if(things, [&](const auto& one) { return one.name == name; });
    return found != things.end() ? &*found : nullptr;
  };
  return {.names =
              [&scene] {
                std::vector<std::string_view> names = {Description<Scene>::element};
                for (const Surface& surface : scene.surfaces) names.push_back(surface.name);
                for (const Force& force : scene.forces) names.push_back(force.name);
                for (const Group& group : scene.groups) names.push_back(group.name);
                for (const Collider& collider : scene.colliders) names.push_back(collider.name);
                return names;
              },
          .elements =
              [&scene, find](const std::string& name) {
                return formats_of(find(scene.surfaces, name), find(scene.forces, name),
                                  find(scene.groups, name), find(scene.colliders, name), name);
              }};
}

Checked<ResolvedPath> resolve(const PathScope& scope, std::string_view path) {
  std::optional<ValuePath> parts = split_path(path);
  if (!parts)
    return refused(
        fmt::format("{} is not a path; write NAME.ATTRIBUTE, such as poke.magnitude or scene.fps",
                    in_quotes(path)));
  ResolvedPath at{.path = *std::move(parts), .element = {}};
  const std::vector<const ElementFormat*> elements = scope.elements(at.path.name);
  if (elements.empty())
    return refused(fmt::format("nothing is named {}{}", in_quotes(at.path.name),
                               hint(at.path.name, scope.names())));
  for (const ElementFormat* const element : elements) {
    if (at.format) break;
    at.element = element->name;
    const auto& attributes = element->attributes;
    const auto found = std::ranges::find(attributes, at.path.attribute, &AttributeFormat::name);
    if (found != attributes.end()) at.format = &*found;
  }
  if (!at.format) return refused(no_attribute(at.path, elements));
  if (at.path.part.empty()) return at;
  if (std::string problem = no_part(at); !problem.empty()) return refused(std::move(problem));
  return at;
}

Checked<SlotAt> slot_at(Scene& scene, std::string_view path) {
  return slot_at(NamedThings(scene), path);
}

Checked<SlotAt> slot_at(const NamedThings& things, std::string_view path) {
  PathScope scope = scope_of(things.scene());
  scope.elements = [&](const std::string& name) { return things.elements(name); };
  Checked<ResolvedPath> at = resolve(scope, path);
  if (!at) return tl::unexpected(at.error());
  Table table = all_slots(things, at->path.name);
  Slot* const found = find(table, at->path.attribute);
  const Attribute& attribute = found->attribute;
  if (!found->excluded.empty())
    return refused(fmt::format("{}: {}", at->path.title(), found->excluded));
  if (attribute.need == Need::Later)
    return refused(fmt::format("{} {}", at->path.attribute, not_supported(attribute.instead)));
  if (attribute.syntax == Syntax::Version || attribute.syntax == Syntax::Name)
    return refused(fmt::format("{} cannot be changed", at->path.attribute));
  return SlotAt{std::move(at->path), std::move(*found)};
}

}  // namespace pliant::xml
