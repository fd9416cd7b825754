#include "pliant/scene/elements/element.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/files/open_file.hpp"
#include "pliant/scene/format/artist_words.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/format/sharing_text.hpp"
#include "pliant/scene/text/element_text.hpp"

namespace pliant::xml {
namespace {

std::vector<std::string_view> supported_names(std::span<const Slot> table) {
  std::vector<std::string_view> names;
  for (const Slot& row : table)
    if (row.attribute.need != Need::Later) names.push_back(row.attribute.name);
  return names;
}

/// `; it belongs in <surface>` for an element that the format allows elsewhere.
std::string where_it_belongs(std::string_view name) {
  std::string places;
  if (const ElementFormat* const format = find_format(scene_format(), name))
    for (const std::string_view parent : format->parents)
      places += fmt::format("{}<{}>", places.empty() ? "" : " or ", parent);
  return places.empty() ? "" : "; it belongs in " + places;
}

std::string unknown_child(const Element& parent, const Element& child,
                          std::span<const ChildReader> children) {
  std::vector<std::string_view> names;
  for (const ChildReader& known : children) names.push_back(known.name);
  // Those are gone from the text that is read, unless one is misspelt.
  constexpr std::string_view expanded[] = {Description<IncludeText>::element,
                                           Description<DefineText>::element};
  const std::vector<std::string_view> parents = including_elements();
  if (nearest_word(child.name(), expanded) &&
      std::find(parents.begin(), parents.end(), parent.name()) != parents.end())
    names.insert(names.end(), std::begin(expanded), std::end(expanded));
  std::string place = where_it_belongs(child.name());
  if (const std::string_view meant = meant_by_element(child.name());
      place.empty() && !meant.empty())
    place = fmt::format("; use {}", meant);
  return fmt::format("{} has no element {}{}", tag(parent), in_quotes(child.name()),
                     place.empty()
                         ? hint(child.name(), names)
                         : place + "; allowed: " + (names.empty() ? "none" : listed(names)));
}

/// An <include> is still there if it could not be replaced, which is reported.
bool is_include(const Element& element) {
  return element.name() == Description<IncludeText>::element;
}

void read_value(const Element& element, const GivenAttribute& given, Slot& row,
                Findings& findings) {
  const TextPlace place = given.value_place();
  if (row.at.is_known())
    return findings.add_problem(
        place, value_problem(element, given.name, given.value,
                             fmt::format("{} is already animated ({}); remove one of them",
                                         given.name, findings.sources().title_of(row.at, place))));
  row.at = place;
  if (given.is_unknown) {
    row.is_sound = false;
    return findings.add_consequence();
  }
  if (row.attribute.need == Need::Later) {
    row.is_sound = false;
    return findings.add_problem(given.name_place(),
                                fmt::format("the attribute {} of {} {}", in_quotes(given.name),
                                            tag(element), not_supported(row.attribute.instead)));
  }
  if (const Checked<void> read = row.read(given.value); !read) {
    row.is_sound = false;
    findings.add_problem(place,
                         value_problem(element, given.name, given.value, read.error().message));
  }
}

/// Whether an attribute of the root only tells editors and validators where the schema is.
bool names_schema(const Element& element, const GivenAttribute& given) {
  if (!element.is_root()) return false;
  return given.name == "xsi:noNamespaceSchemaLocation" ||
         (given.name == "xmlns:xsi" && given.value == "http://www.w3.org/2001/XMLSchema-instance");
}

}  // namespace

void read_attributes(const Element& element, Table& table, Findings& findings) {
  const std::vector<std::string_view> names = supported_names(table);
  std::vector<std::string_view> meant;  // attributes that a misspelt one probably stands for
  for (const GivenAttribute& given : element.attributes()) {
    constexpr std::size_t parts_of_attribute = 64;  // besides those of its bytes
    if (findings.is_over(parts_of_attribute + given.value.size())) break;
    if (names_schema(element, given)) continue;
    if (Slot* row = find(table, given.name)) {
      read_value(element, given, *row, findings);
      continue;
    }
    findings.add_problem(
        given.name_place(),
        fmt::format("{} has no attribute {}{}", tag(element), in_quotes(given.name),
                    attribute_hint(element.name(), given.name, names, meant)));
  }
  for (Slot& row : table) {
    if (std::find(meant.begin(), meant.end(), row.attribute.name) != meant.end())
      row.is_sound = false;
    if (row.attribute.need != Need::Required || row.at.is_known() || !row.is_sound) continue;
    row.is_sound = false;
    findings.add_problem(element.place(), fmt::format("{} needs the attribute \"{}\"", tag(element),
                                                      row.attribute.name));
  }
}

bool read_children(const Element& element, std::span<const ChildReader> children,
                   Findings& findings) {
  bool all_known = true;
  constexpr std::size_t parts_of_child = 1024;
  ContentReader content(element, findings);
  for (auto part = content.next(); part; part = content.next()) {
    if (findings.is_over(parts_of_child)) break;
    if (!part->element) {
      findings.add_problem(
          part->place, fmt::format("{} contains the text {}; no text is allowed here", tag(element),
                                   in_quotes(trimmed(part->value()))));
      continue;
    }
    const Element& child = *part->element;
    const auto known =
        std::find_if(children.begin(), children.end(),
                     [&](const ChildReader& candidate) { return candidate.name == child.name(); });
    if (known != children.end()) {
      known->read(child);
      continue;
    }
    all_known = false;
    if (is_include(child))
      findings.add_consequence();
    else
      findings.add_problem(child.place(), unknown_child(element, child, children));
  }
  return all_known;
}

bool read_numbers(const Element& element, std::vector<double>& numbers, Findings& findings) {
  constexpr std::size_t longest_number = 1024;  // bytes
  constexpr std::size_t parts_of_number = 32;
  bool is_sound = true;
  const auto complain = [&](const TextPlace& place, std::string message) {
    is_sound = false;
    findings.add_problem(place, std::move(message));
  };
  ContentReader content(element, findings);
  // Whether it is a number; `written`: in the text at a place.
  const auto read = [&](std::string_view word, std::string_view written, const TextPlace& place) {
    const Checked<double> number =
        written.size() < longest_number ? parse_number(word) : refused("is too long for a number");
    if (number)
      numbers.push_back(*number);
    else
      complain(place, fmt::format("{} number {}, {}: {}", tag(element), numbers.size() + 1,
                                  in_quotes(word), number.error().message));
    return number.has_value();
  };
  for (auto part = content.next(); part; part = content.next()) {
    if (part->element && is_include(*part->element))
      is_sound = false;
    else if (part->element)
      complain(part->element->place(), unknown_child(element, *part->element, {}));
    for (std::string_view text = part->text; !text.empty();) {
      const std::string_view ahead = text.substr(0, longest_number);
      const std::string_view word = ahead.substr(0, ahead.find_first_of(blanks));
      const bool has_reference = !part->is_cdata && word.find('&') != std::string_view::npos;
      const std::string value = has_reference ? decoded(word) : "";
      for (const std::string_view inner : has_reference ? words_of(value) : std::vector{word})
        if (!read(inner, word, part->place_of(word))) return false;
      text.remove_prefix(first_not_blank(text, word.size(), findings));
      if (findings.is_over(parts_of_number)) return false;
    }
  }
  return is_sound;
}

std::string tag(const Element& element) {
  const std::string name = in_quotes(element.name());
  return '<' + name.substr(1, name.size() - 2) + '>';
}

std::string value_problem(const Element& element, std::string_view attribute, std::string_view text,
                          std::string_view complaint) {
  return fmt::format("{} {}={}: {}", tag(element), attribute, in_quotes(text), complaint);
}

void take_over(const Element& element, const GivenAttribute& given, Slot& row, Findings& findings) {
  const TextPlace place = given.value_place();
  if (row.at.is_known())
    findings.add_problem(place,
                         value_problem(element, given.name, trimmed(given.value),
                                       fmt::format("is already {} ({}); remove one of them",
                                                   row.is_animated ? "animated" : "given",
                                                   findings.sources().title_of(row.at, place))));
  else
    row.at = place;
  row.is_animated = true;
}

void locate_file(const Element& element, Slot& row, const std::string& owner, std::string& path,
                 SceneFile& file) {
  if (!row.at.is_known() || !row.is_sound) return;
  const std::string written = std::exchange(path, (file.folder_of(row.at.text) / path).string());
  if (const auto below = find_below(path, file.root); !below) {
    row.is_sound = false;
    return file.findings.add_problem(
        row.at, value_problem(element, row.attribute.name, written, below.error().message));
  }
  file.meshes.push_back({owner, path, row.at});
}

void record(const std::string& name, std::span<const Slot> table, SceneFile& file) {
  for (const Slot& row : table) {
    const std::string path = fmt::format("{}.{}", name, row.attribute.name);
    if (row.at.is_known()) file.parts[path] = row.at;
    if (!row.is_sound) file.unsound.insert(path);
  }
}

}  // namespace pliant::xml
