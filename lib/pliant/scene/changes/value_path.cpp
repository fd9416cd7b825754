#include "pliant/scene/changes/value_path.hpp"

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
  std::erase_if(table, [](const Slot& slot) { return !slot.excluded.empty(); });
  for (ChildPlace& place : contents.children) {
    if (contents.driver && !contents.driver->empty() && !place.row.is_of_driven) continue;
    if (!place.part.empty()) append(table, std::move(place.part.front().attributes));
    if (!place.row.noun.empty())
      place.kinds.for_each([&](Contents& one) { append(table, std::move(one.attributes)); });
  }
  return table;
}

Table all_slots(const NamedThings& things, const std::string& name) {
  if (Surface* const surface = things.surface(name)) return all_slots(*surface);
  if (Force* const force = things.force(name)) return all_slots(*force);
  if (Group* const group = things.group(name)) return all_slots(*group);
  return name == Description<Scene>::element ? all_slots(things.scene()) : Table();
}

std::string no_object(const Scene& scene, std::string_view name) {
  std::vector<std::string_view> names = {Description<Scene>::element};
  for (const Surface& surface : scene.surfaces) names.push_back(surface.name);
  for (const Force& force : scene.forces) names.push_back(force.name);
  for (const Group& group : scene.groups) names.push_back(group.name);
  return fmt::format("nothing is named {}{}", in_quotes(name), hint(name, names));
}

bool may_change(const Slot& slot) {
  return slot.attribute.syntax != Syntax::Version && slot.attribute.name != "name" &&
         slot.attribute.need != Need::Later;
}

Table::iterator find_slot(Table& table, const std::string& attribute) {
  return std::find_if(table.begin(), table.end(), [&](const Slot& slot) {
    return slot.attribute.name == attribute && may_change(slot);
  });
}

bool is_part(const std::string& part) {
  return part.empty() ||
         std::find(std::begin(part_words), std::end(part_words), part) != std::end(part_words);
}

std::string no_attribute(const Scene& scene, const Table& table, const ValuePath& path) {
  std::vector<std::string_view> names;
  for (const Slot& slot : table)
    if (may_change(slot)) names.push_back(slot.attribute.name);
  for (const Slot& slot : table) {
    if (slot.attribute.name != path.attribute) continue;
    return fmt::format("{} {}", path.attribute,
                       slot.attribute.need == Need::Later ? not_supported(slot.attribute.instead)
                                                          : "cannot be changed");
  }
  std::vector<std::string_view> own;
  return fmt::format("{} has no attribute {}{}", in_quotes(path.name), in_quotes(path.attribute),
                     attribute_hint(scene, path.name, path.attribute, names, own));
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
}

bool has_slot(const NamedThings& things, std::string_view path) {
  const std::optional<ValuePath> parts = split_path(path);
  if (!parts || !is_part(parts->part)) return false;
  Table table = all_slots(things, parts->name);
  return find_slot(table, parts->attribute) != table.end();
}

Reading<SlotAt> slot_at(Scene& scene, std::string_view path) {
  return slot_at(NamedThings(scene), path);
}

Reading<SlotAt> slot_at(const NamedThings& things, std::string_view path) {
  Scene& scene = things.scene();
  std::optional<ValuePath> parts = split_path(path);
  if (!parts)
    return tl::unexpected(fmt::format(
        "{} is no path of an attribute; write NAME.ATTRIBUTE or scene.ATTRIBUTE", in_quotes(path)));
  Table table = all_slots(things, parts->name);
  if (table.empty()) return tl::unexpected(no_object(scene, parts->name));
  const auto found = find_slot(table, parts->attribute);
  if (found == table.end()) return tl::unexpected(no_attribute(scene, table, *parts));
  if (!is_part(parts->part))
    return tl::unexpected(fmt::format("{} has no part {}{}", parts->title(), in_quotes(parts->part),
                                      hint(parts->part, part_words)));
  return SlotAt{*std::move(parts), std::move(*found)};
}

}  // namespace pliant::xml
