// Operations on constant values, and between constants and curves.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "pliant/document/editor.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::edit {
namespace {

/// The position of that name in a force or group, null if there is none.
template <class Thing>
const PositionChannel* position_in(const Thing& thing, std::string_view attribute) {
  const PositionChannel* found = nullptr;
  describe(
      [&](const Attribute& row, const auto&... members) {
        const auto look = [&](const auto& member) {
          if constexpr (std::is_same_v<std::decay_t<decltype(member)>, PositionChannel>)
            if (row.name == attribute) found = &member;
        };
        (look(members), ...);
      },
      thing);
  return found;
}

const PositionChannel* find_position(const Scene& scene, std::string_view name,
                                     std::string_view attribute) {
  for (const Force& force : scene.forces)
    if (force.name == name)
      return std::visit([&](const auto& kind) { return position_in(kind, attribute); }, force.kind);
  for (const pliant::Group& group : scene.groups)
    if (group.name == name) return position_in(group, attribute);
  return nullptr;
}

}  // namespace

Result<void> Editor::operator()(const Set& set) {
  const auto spot = this->spot(set.path);
  if (!spot) return fail(spot.error());
  if (spot->attribute() == "name")
    return draft_.refuse(
        fmt::format("{} is changed by a rename, so that what refers to it follows", spot->path));
  if (spot->attribute() == "version")
    return draft_.refuse(fmt::format("{} is that of the format, and cannot be set", spot->path));
  if (!spot->component) return set_constant(*spot, set.value);
  const auto value = with_component(*spot, set.value);
  if (!value) return fail(value.error());
  return set_constant(*spot, *value);
}

/// The constant vector with one component replaced; the others stay as they are written.
Result<std::string> Editor::with_component(const Spot& spot, const std::string& value) const {
  constexpr std::size_t components = 3;
  if (const auto number = xml::parse_number(value); !number)
    return draft_.refuse(fmt::format("{}: {}", spot.path, number.error().message));
  auto whole = constant(spot);
  if (!whole) {
    whole.error().message += "; a component is set of a constant vector only";
    return whole;
  }
  std::vector<std::string_view> words = xml::words_of(*whole);
  const std::string only(words.size() == 1 ? words.front() : "");
  if (words.size() == 1) whole = fmt::format("{0} {0} {0}", only);
  words = xml::words_of(*whole);
  if (words.size() != components)  // its problem is found when the whole is read
    return draft_.refuse(fmt::format("{} is not a vector of three numbers", spot.path));
  const std::string_view old = words[*spot.component];
  return whole->replace(old.data() - whole->data(), old.size(), xml::trimmed(value));
}

Result<void> Editor::set_constant(const Spot& spot, const std::string& value) {
  if (const auto curve = animated(spot)) draft_.remove(*curve);
  if (const auto path = on_path(spot)) draft_.remove(*path);
  if (spot.element) {
    std::string text = value;
    // Blanks around a single number stay.
    const std::string old = draft_.value(*spot.element, spot.attribute()).value_or("");
    const std::vector<std::string_view> words = xml::words_of(old);
    if (spot.format.is_keyable && words.size() == 1 && xml::words_of(value).size() == 1) {
      const std::size_t at = words.front().data() - old.data();
      text = old.substr(0, at) + std::string(xml::trimmed(value)) +
             old.substr(at + words.front().size());
    }
    draft_.set(*spot.element, spot.attribute(), text);
  } else {
    auto inserted = insert_part(
        spot, {.name = spot.part, .attributes = {{std::string(spot.attribute()), value}}});
    if (!inserted) return inserted;
  }
  parts_.insert(spot.path);
  return draft_.commit();
}

/// Inserts a part that an object lacks, in the order of the format. Errors: it comes from a file
/// that is included.
Result<void> Editor::insert_part(const Spot& spot, const xml::ElementText& part) {
  const std::string name = name_of(spot.object);
  for (const AttributeFormat& row : format_of(part.name).attributes) {
    const std::string attribute(row.name);
    if (!scene_.origin.gives(name, attribute) || scene_.origin.is_own(name, attribute)) continue;
    const ScenePlace at = scene_.origin.place_of(name, attribute);
    return draft_.refuse(
        fmt::format("the <{}> of {} does not stand in this file, but in {}:{}; edit that file",
                    part.name, in_quotes(name), at.file, at.line));
  }
  std::vector<std::string_view> before;
  for (const ChildFormat& child : format_of(draft_.name(spot.object)).children) {
    if (child.names.front() == part.name) break;
    before.insert(before.end(), child.names.begin(), child.names.end());
  }
  Draft::Place place{.parent = spot.object};
  for (const ElementIndex child : draft_.children(spot.object))
    if (std::ranges::find(before, draft_.name(child)) != before.end()) place.after = child;
  draft_.insert(part, place);
  return {};
}

Result<void> Editor::operator()(const Reset& reset) {
  const auto spot = this->spot(reset.path);
  if (!spot) return fail(spot.error());
  if (spot->component)
    return draft_.refuse(
        fmt::format("{} is a component; reset {} as a whole", reset.path, spot->path));
  if (const auto curve = animated(*spot)) draft_.remove(*curve);
  if (const auto path = on_path(*spot)) draft_.remove(*path);
  if (spot->element) draft_.remove_attribute(*spot->element, spot->attribute());
  parts_.insert(spot->path);
  return {};
}

Result<void> Editor::operator()(const Animate& animate) {
  for (const std::string& channel : animate.channels) {
    const auto spot = this->spot(channel);
    if (!spot) return fail(spot.error());
    const auto value = constant(*spot);
    if (!value) return fail(value.error());
    if (auto done = insert_animate(*spot, animate.frame, *value); !done) return done;
  }
  return {};
}

/// Makes a curve of one key of a channel that is constant.
Result<void> Editor::insert_animate(const Spot& spot, double frame, const std::string& value) {
  if (!spot.format.is_keyable || spot.component)
    return draft_.refuse(fmt::format("{} cannot be animated", spot.path));
  return insert_animate(
      spot,
      {.name = "animate",
       .attributes = {{"attribute", std::string(spot.attribute())}},
       .children = {{.name = "key", .attributes = {{"frame", to_text(frame)}, {"value", value}}}}});
}

Result<void> Editor::insert_animate(const Spot& spot, const xml::ElementText& animate) {
  parts_.insert(spot.path);
  if (!spot.element) {
    auto inserted = insert_part(spot, {.name = spot.part, .children = {animate}});
    return inserted ? draft_.commit() : inserted;
  }
  draft_.remove_attribute(*spot.element, spot.attribute());
  if (auto done = draft_.commit(); !done) return done;
  // Elements keep their numbers. The curves of an element stand together, behind its waypoints.
  Draft::Place place{.parent = *spot.element};
  for (const ElementIndex child : draft_.children(*spot.element)) {
    const std::string_view name = draft_.name(child);
    if (name == "animate" || name == "path" || name == "waypoint") place.after = child;
  }
  draft_.insert(animate, place);
  return draft_.commit();
}

Result<void> Editor::operator()(const Freeze& freeze) {
  if (!std::isfinite(freeze.frame))
    return draft_.refuse(fmt::format("the frame must be finite, not {}", freeze.frame));
  for (const std::string& channel : freeze.channels) {
    const auto spot = this->spot(channel);
    if (!spot) return fail(spot.error());
    const auto value = value_at(*spot, freeze.frame);
    if (!value) return fail(value.error());
    if (auto done = set_constant(*spot, *value); !done) return done;
  }
  return {};
}

Result<void> Editor::operator()(const SetPart& set) {
  const auto object = this->object(set.surface);
  if (!object) return fail(object.error());
  std::vector<std::string_view> allowed;
  for (const ChildFormat& child : format_of(draft_.name(*object)).children)
    if (child.is_part) allowed.push_back(child.names.front());
  if (allowed.empty())
    return draft_.refuse(
        fmt::format("{} is not a surface or collider, so it has no parts", in_quotes(set.surface)));
  if (std::ranges::find(allowed, set.part) == allowed.end())
    return draft_.refuse(fmt::format("{} is not a part that can be set; allowed: {}",
                                     in_quotes(set.part), fmt::join(allowed, ", ")));
  if (set.comment.find("--") != std::string::npos || set.comment.ends_with('-'))
    return draft_.refuse("a comment must not contain --, or end with -");
  const auto name_part = [&](std::string_view attribute) {
    parts_.insert(fmt::format("{}.{}", set.surface, attribute));
  };
  for (const auto& [attribute, value] : set.attributes) name_part(attribute);
  const xml::ElementText text{.name = set.part, .attributes = set.attributes};
  // Curves of the part may stand in the object itself.
  for (const ElementIndex child : draft_.children(*object, "animate")) {
    const std::string of(xml::trimmed(draft_.value(child, "attribute").value_or("")));
    if (!find_attribute(set.part, of)) continue;
    name_part(of);
    draft_.remove(child);
  }
  const std::vector<ElementIndex> present = draft_.children(*object, set.part);
  if (present.empty()) {
    auto inserted = insert_part({.path = {}, .object = *object, .part = set.part}, text);
    if (!inserted) return inserted;
    if (auto done = draft_.commit(); !done || set.comment.empty()) return done;
  } else {
    for (const xml::AttributePlace& one : draft_.attributes(present.front()))
      name_part(one.name.of(draft_.text()));
    for (const ElementIndex child : draft_.children(present.front())) {
      const bool is_curve = draft_.name(child) == "animate";  // others: such as a map
      name_part(is_curve ? xml::trimmed(draft_.value(child, "attribute").value_or(""))
                         : draft_.name(child));
    }
    draft_.replace_element(present.front(), text);
    if (auto done = draft_.commit(); !done || set.comment.empty()) return done;
  }
  // The object has its number still: only what stands in it has changed.
  draft_.set_comment(draft_.children(*object, set.part).front(), set.comment);
  return draft_.commit();
}

/// The text of an animated channel's value at a frame.
Result<std::string> Editor::value_at(const Spot& spot, double frame) const {
  if (on_path(spot)) {
    const auto scene = parse_(draft_.text());
    if (!scene) return fail(scene.error());
    const PositionChannel* const position =
        find_position(*scene, name_of(spot.object), spot.attribute());
    if (!position) return draft_.refuse(fmt::format("{} is not a position", spot.path));
    const Value<3> value = position->at(frame);
    return xml::value_text<3>(value, xml::ValueKind::Vector);
  }
  if (!animated(spot) || spot.attribute() == "falloff")
    return draft_.refuse(fmt::format("{} is not animated", spot.path));
  const auto curve = curve_of(spot);
  if (!curve) return fail(curve.error());
  return std::visit(
      [&]<int D>(const KeyedCurve<D>& one) {
        return xml::value_text<D>(one.curve.value(frame), one.kind);
      },
      *curve);
}

}  // namespace pliant::edit
