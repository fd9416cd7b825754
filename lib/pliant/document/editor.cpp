#include "pliant/document/editor.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/format/resolve.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::edit {

namespace {

std::string hint_of(std::string_view word, const std::vector<std::string>& known) {
  const std::vector<std::string_view> words(known.begin(), known.end());
  return xml::hint(word, words);
}

}  // namespace

Editor::Editor(Draft& draft, const Scene& scene, ParseScene parse,
               const std::vector<ElementFormat>& formats)
    : draft_(draft), scene_(scene), parse_(std::move(parse)), formats_(formats) {}

Result<void> Editor::apply(const Operation& operation) {
  if (auto done = std::visit([&](const auto& one) { return (*this)(one); }, operation); !done)
    return done;
  return draft_.commit();
}

std::vector<Editor::NamedElement> Editor::objects() const {
  std::vector<NamedElement> found;
  const auto add = [&](ElementIndex element) {
    if (const auto name = draft_.value(element, "name")) found.emplace_back(*name, element);
  };
  for (const ElementIndex child : draft_.children(Draft::root)) {
    add(child);
    if (draft_.name(child) != "group") continue;
    for (const ElementIndex member : draft_.children(child))
      if (is_force(member)) add(member);
  }
  return found;
}

/// Of an object: paths would not reach the scene any more if one had its name.
Result<void> Editor::check_new(const std::string& name) const {
  if (name != "scene") return {};
  return draft_.refuse("\"scene\" is what operations call the scene; choose another name");
}

Result<ElementIndex> Editor::object(std::string_view name) const {
  if (name.empty()) return Draft::root;
  std::vector<std::string> names;
  for (const auto& [other, element] : objects()) {
    if (other == name) return element;
    names.push_back(other);
  }
  if (name == "scene") return Draft::root;
  const auto is_it = [&](const auto& thing) { return thing.name == name; };
  const bool is_included =
      std::ranges::any_of(scene_.surfaces, is_it) || std::ranges::any_of(scene_.forces, is_it) ||
      std::ranges::any_of(scene_.groups, is_it) || std::ranges::any_of(scene_.colliders, is_it);
  if (is_included) {
    const ScenePlace place = scene_.origin.place_of(std::string(name));
    return draft_.refuse(fmt::format("{} does not stand in this file, but in {}:{}; edit that file",
                                     in_quotes(name), place.file, place.line));
  }
  names.insert(names.begin(), "scene");
  return draft_.refuse(fmt::format("nothing is named {}{}", in_quotes(name), hint_of(name, names)));
}

/// Whether it is an element with a name that may stand in a group.
bool Editor::is_force(std::string_view element) const {
  const std::vector<std::string_view>& parents = format_of(element).parents;
  const AttributeFormat* const name = find_attribute(element, "name");
  return name && name->type == "name" &&
         std::ranges::find(parents, Description<pliant::Group>::element) != parents.end();
}

bool Editor::is_force(ElementIndex element) const { return is_force(draft_.name(element)); }

Result<ElementIndex> Editor::force(std::string_view name) const {
  auto element = object(name);
  if (!element || (*element != Draft::root && is_force(*element))) return element;
  return draft_.refuse(fmt::format("{} is a <{}>, not a force",
                                   in_quotes(name.empty() ? "scene" : name),
                                   draft_.name(*element)));
}

std::string Editor::name_of(ElementIndex element) const {
  return draft_.value(element, "name").value_or("");
}

std::string Editor::free_name(const std::string& like, std::set<std::string>& taken) const {
  const std::string base = like.substr(0, like.find_last_not_of("0123456789") + 1);
  for (int number = 2;; ++number) {
    std::string name = fmt::format("{}{}", base, number);
    if (taken.insert(name).second) return name;
  }
}

std::set<std::string> Editor::taken_names() const {
  std::set<std::string> names;
  for (const auto& [name, element] : objects()) names.insert(name);
  return names;
}

const ElementFormat& Editor::format_of(std::string_view element) const {
  static const ElementFormat none;
  const ElementFormat* const found = find_format(formats_, element);
  return found ? *found : none;
}

const AttributeFormat* Editor::find_attribute(std::string_view element,
                                              std::string_view name) const {
  const std::vector<AttributeFormat>& attributes = format_of(element).attributes;
  const auto found = std::ranges::find(attributes, name, &AttributeFormat::name);
  return found != attributes.end() ? &*found : nullptr;
}

/// The attributes that name surfaces, where they are given.
std::vector<Editor::Reference> Editor::references() const {
  std::vector<Reference> found;
  for (const auto& [name, object] : objects()) {
    std::vector<ElementIndex> elements = {object};
    for (const ElementIndex child : draft_.children(object))
      if (!is_force(child)) elements.push_back(child);
    for (const ElementIndex element : elements)
      for (const AttributeFormat& format : format_of(draft_.name(element)).attributes)
        if (format.names_surfaces && draft_.attribute(element, format.name))
          found.push_back({fmt::format("{}.{}", name, format.name), object, element, &format});
  }
  return found;
}

/// The elements whose attributes an object has: its own, its parts, and of several kinds of which
/// one stands there the one that does.
std::vector<std::string> Editor::parts_of(ElementIndex object) const {
  std::vector<std::string> parts{std::string(draft_.name(object))};
  for (const ChildFormat& child : format_of(draft_.name(object)).children) {
    for (const std::string_view name : child.names)
      if (child.is_part || (child.is_choice() && !draft_.children(object, name).empty()))
        parts.emplace_back(name);
  }
  return parts;
}

Result<Spot> Editor::spot(const std::string& given) const {
  const std::string path = given.starts_with('.') ? "scene" + given : given;
  const auto parts = xml::split_path(path);
  const auto object = parts ? this->object(parts->name) : Result<ElementIndex>(Draft::root);
  if (!object) return fail(object.error());
  const auto at = xml::resolve({.names = {},
                                .elements =
                                    [&](const std::string&) {
                                      std::vector<const ElementFormat*> formats;
                                      for (const std::string& part : parts_of(*object))
                                        formats.push_back(&format_of(part));
                                      return formats;
                                    }},
                               path);
  if (!at) return draft_.refuse(at.error().message);
  if (at->path.is_of_path()) return spot_on_path(path, *object, at->path.attribute, at->path.part);
  Spot spot{.path = at->path.title(),
            .object = *object,
            .part = std::string(at->element),
            .format = *at->format,
            .component = at->path.component()};
  if (spot.part == draft_.name(*object)) {
    spot.element = *object;
  } else if (const auto found = draft_.children(*object, spot.part); !found.empty()) {
    spot.element = found.front();
  }
  return spot;
}

/// `center.progress`, an attribute of the <path> that a position follows.
Result<Spot> Editor::spot_on_path(const std::string& path, ElementIndex object,
                                  const std::string& position, const std::string& attribute) const {
  const std::string whole = fmt::format("{}.{}", name_of(object), position);
  const AttributeFormat& format = *find_attribute("path", attribute);
  for (const ElementIndex child : draft_.children(object, "path"))
    if (xml::trimmed(draft_.value(child, "attribute").value_or("")) == position)
      return Spot{
          .path = path, .object = object, .element = child, .part = "path", .format = format};
  return draft_.refuse(
      fmt::format("{} follows no path, so it has no {}", whole, in_quotes(attribute)));
}

std::optional<ElementIndex> Editor::animated(const Spot& spot) const {
  if (spot.attribute() == "falloff") {
    if (!spot.element) return std::nullopt;
    const std::vector<ElementIndex> curves = draft_.children(*spot.element, "falloff");
    return curves.empty() ? std::nullopt : std::optional(curves.front());
  }
  if (!spot.format.is_keyable) return std::nullopt;
  // Curves of a part may stand in the object itself.
  std::vector<ElementIndex> owners = {spot.object};
  if (spot.element && *spot.element != spot.object) owners.insert(owners.begin(), *spot.element);
  for (const ElementIndex owner : owners)
    for (const ElementIndex child : draft_.children(owner, "animate"))
      if (xml::trimmed(draft_.value(child, "attribute").value_or("")) == spot.attribute())
        return child;
  return std::nullopt;
}

std::optional<ElementIndex> Editor::on_path(const Spot& spot) const {
  if (!spot.element) return std::nullopt;
  for (const ElementIndex child : draft_.children(*spot.element, "path"))
    if (xml::trimmed(draft_.value(child, "attribute").value_or("")) == spot.attribute())
      return child;
  return std::nullopt;
}

Result<std::string> Editor::constant(const Spot& spot) const {
  if (animated(spot)) return draft_.refuse(fmt::format("{} is animated", spot.path));
  if (on_path(spot)) return draft_.refuse(fmt::format("{} follows a path", spot.path));
  if (spot.element)
    if (auto given = draft_.value(*spot.element, spot.attribute())) return *std::move(given);
  const std::string& standard = spot.format.standard;
  if (!standard.empty() && !standard.starts_with('(')) return standard;
  return draft_.refuse(fmt::format("{} is not given, and has no value to begin with", spot.path));
}

}  // namespace pliant::edit
