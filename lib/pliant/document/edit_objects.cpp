// Operations on surfaces, forces, groups and colliders.

#include <algorithm>

#include <fmt/format.h>

#include "pliant/document/editor.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::edit {

namespace {

/// Names between blanks, without those of a list. Null: nothing is left.
std::optional<std::string> without(std::string_view names,
                                   const std::vector<std::string>& removed) {
  std::string left;
  for (const std::string_view word : xml::words_of(names)) {
    if (std::ranges::find(removed, word) != removed.end()) continue;
    left += left.empty() ? "" : " ";
    left += word;
  }
  return left.empty() ? std::nullopt : std::optional(left);
}

}  // namespace

Result<void> Editor::operator()(const Add& addition) {
  std::vector<std::string_view> known;
  for (const ChildFormat& child : format_of(draft_.name(Draft::root)).children)
    known.insert(known.end(), child.names.begin(), child.names.end());
  if (std::ranges::find(known, addition.kind) == known.end())
    return draft_.refuse(
        fmt::format("no kind {}{}", in_quotes(addition.kind), xml::hint(addition.kind, known)));
  if (auto good = check_new(addition.name); !good) return good;
  if (!addition.group.empty() && !is_force(addition.kind))
    return draft_.refuse(fmt::format("a <{}> cannot be in a group", addition.kind));

  xml::ElementText element{.name = addition.kind, .attributes = {{"name", addition.name}}};
  const ElementFormat& format = format_of(addition.kind);
  std::vector<std::string> parts = {addition.kind};
  for (const ChildFormat& child : format.children) {
    if (child.is_choice()) {
      parts.push_back(addition.shape.empty() ? std::string(child.names.front()) : addition.shape);
      element.children.push_back({.name = parts.back()});
    }
    if (child.is_part) parts.emplace_back(child.names.front());
  }
  if (!addition.shape.empty() && element.children.empty())
    return draft_.refuse(fmt::format("a <{}> has no shape", addition.kind));
  if (parts.size() > 1) {
    for (const Given& given : addition.attributes) {
      const auto part = std::ranges::find_if(parts, [&](const std::string& one) {
        return find_attribute(one, given.first) != nullptr;
      });
      if (part == parts.begin() || part == parts.end()) {
        element.attributes.push_back(given);  // an unknown one is found when it is read
        continue;
      }
      auto own = std::ranges::find(element.children, *part, &xml::ElementText::name);
      if (own == element.children.end()) {
        const auto rank = [&](const xml::ElementText& child) {
          return std::ranges::find(parts, child.name) < part;
        };
        own = element.children.insert(std::ranges::partition_point(element.children, rank),
                                      {.name = *part});
      }
      own->attributes.push_back(given);
    }
  } else {
    element.attributes.insert(element.attributes.end(), addition.attributes.begin(),
                              addition.attributes.end());
  }

  Draft::Place place{.parent = Draft::root, .keeps_blank_line = true};
  if (!addition.group.empty()) {
    const auto group = object(addition.group);
    if (!group) return fail(group.error());
    if (draft_.name(*group) != "group")
      return draft_.refuse(
          fmt::format("{} is a <{}>, not a group", in_quotes(addition.group), draft_.name(*group)));
    place.parent = *group;
  }
  // Surfaces stand behind surfaces, if there are some; all else at the end.
  const bool is_surface = addition.kind == Description<Surface>::element;
  for (const ElementIndex child : draft_.children(place.parent))
    if (!is_surface || draft_.name(child) == addition.kind) place.after = child;
  draft_.insert(element, place);
  parts_.insert(addition.name);
  return {};
}

Result<void> Editor::operator()(const Duplicate& duplication) {
  const auto found = object(duplication.object);
  if (!found) return fail(found.error());
  const ElementIndex original = *found;
  if (original == Draft::root) return draft_.refuse("the scene cannot be duplicated");
  if (auto good = check_new(duplication.name); !good) return good;
  auto copy = Draft::make(std::string(draft_.whole(original)), draft_.file(), draft_.should_stop());
  if (!copy) return fail(copy.error());
  copy->set(Draft::root, "name", duplication.name);
  parts_.insert(duplication.name);
  if (draft_.name(original) == "group") {
    std::set<std::string> taken = taken_names();
    taken.insert(duplication.name);
    for (const ElementIndex member : copy->children(Draft::root)) {
      const auto name = copy->value(member, "name");
      if (!name) continue;
      const std::string own = free_name(*name, taken);
      copy->set(member, "name", own);
      parts_.insert(own);
    }
  }
  if (auto done = copy->commit(); !done) return done;
  draft_.insert(
      std::vector{copy->text()},
      {.parent = draft_.place(original).parent, .after = original, .keeps_blank_line = true});
  return {};
}

Result<void> Editor::operator()(const Delete& deletion) {
  std::vector<ElementIndex> elements;
  for (const std::string& name : deletion.objects) {
    const auto element = object(name);
    if (!element) return fail(element.error());
    if (*element == Draft::root) return draft_.refuse("the scene cannot be deleted");
    elements.push_back(*element);
    parts_.insert(name);
    for (const ElementIndex member : draft_.children(*element))
      if (is_force(member)) parts_.insert(name_of(member));
  }
  std::ranges::sort(elements);
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
  const auto is_deleted = [&](ElementIndex element) {
    return std::ranges::binary_search(elements, element);
  };
  for (const auto& [path, object, element, format] : references()) {
    if (is_deleted(object) || is_deleted(draft_.place(object).parent)) continue;
    const std::string names = *draft_.value(element, format->name);
    const auto left = without(names, deletion.objects);
    if (!left)
      return draft_.refuse(
          fmt::format("{0}: only {1} is left to delete there; without it {0} is the default {2}. "
                      "Delete {3} too, or change {0} first",
                      path, names, format->standard, name_of(object)));
    if (xml::words_of(*left).size() == xml::words_of(names).size()) continue;
    draft_.set(element, format->name, *left);
    parts_.insert(path);
  }
  for (const ElementIndex element : elements)
    if (!is_deleted(draft_.place(element).parent)) draft_.remove(element);
  return {};
}

Result<void> Editor::operator()(const Rename& rename) {
  const auto found = object(rename.object);
  if (!found) return fail(found.error());
  if (*found == Draft::root) return draft_.refuse("the scene has no name");
  if (auto good = check_new(rename.name); !good) return good;
  draft_.set(*found, "name", rename.name);
  parts_.insert(rename.object);
  parts_.insert(rename.name);
  for (const auto& [path, object, element, format] : references()) {
    const std::string value = *draft_.value(element, format->name);
    std::string renamed;
    std::size_t copied = 0;
    bool is_changed = false;
    for (const std::string_view word : xml::words_of(value)) {
      if (word != rename.object) continue;
      const std::size_t at = word.data() - value.data();
      renamed.append(value, copied, at - copied).append(rename.name);
      copied = at + word.size();
      is_changed = true;
    }
    if (!is_changed) continue;
    draft_.set(element, format->name, renamed.append(value, copied));
    parts_.insert(path);
  }
  return {};
}

Result<void> Editor::operator()(const Target& target) {
  for (const std::string& name : target.objects) {
    const auto element = object(name);
    if (!element) return fail(element.error());
    if (!find_attribute(draft_.name(*element), targets_attribute.name))
      return draft_.refuse(fmt::format("{} has no targets",
                                       *element == Draft::root ? "the scene" : in_quotes(name)));
    set_or_remove(*element, targets_attribute.name,
                  fmt::format("{}", fmt::join(target.surfaces, " ")));
    parts_.insert(name + ".targets");
    if (auto done = draft_.commit(); !done) return done;
  }
  return {};
}

}  // namespace pliant::edit
