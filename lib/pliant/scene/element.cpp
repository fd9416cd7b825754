#include "pliant/scene/element.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/open_file.hpp"
#include "pliant/scene/artist_words.hpp"
#include "pliant/scene/expand.hpp"
#include "pliant/scene/nearest.hpp"

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
  for (const ElementFormat& format : scene_format()) {
    if (format.name != name) continue;
    for (const std::string_view parent : format.parents)
      places += fmt::format("{}<{}>", places.empty() ? "" : " or ", parent);
  }
  return places.empty() ? "" : "; it belongs in " + places;
}

std::string unknown_child(const tinyxml2::XMLElement& parent, const tinyxml2::XMLElement& child,
                          std::span<const Child> children) {
  std::vector<std::string_view> names;
  for (const Child& known : children) names.push_back(known.name);
  // Those are gone from the text that is read, unless one is misspelt.
  constexpr std::string_view expanded[] = {Description<IncludeText>::element,
                                           Description<DefineText>::element};
  const std::vector<std::string_view> parents = including_elements();
  if (nearest_word(child.Name(), expanded) &&
      std::find(parents.begin(), parents.end(), parent.Name()) != parents.end())
    names.insert(names.end(), std::begin(expanded), std::end(expanded));
  std::string place = where_it_belongs(child.Name());
  if (const std::string_view meant = meant_by_element(child.Name());
      place.empty() && !meant.empty())
    place = fmt::format("; use {}", meant);
  return fmt::format("{} has no element {}{}", tag(parent), in_quotes(child.Name()),
                     place.empty()
                         ? hint(child.Name(), names)
                         : place + "; allowed: " + (names.empty() ? "none" : listed(names)));
}

/// An <include> is still there if it could not be replaced, which is reported.
bool is_include(const tinyxml2::XMLElement& element) {
  return element.Name() == Description<IncludeText>::element;
}

void read_value(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute& given, Slot& row,
                Findings& findings) {
  if (row.line != 0)
    return findings.add_problem(
        given.GetLineNum(),
        value_problem(element, given.Name(), given.Value(),
                      fmt::format("{} is already animated ({}); remove one of them", given.Name(),
                                  findings.title_of(row.line, given.GetLineNum()))));
  row.line = given.GetLineNum();
  if (is_unknown(given)) {
    row.is_sound = false;
    return findings.add_consequence();
  }
  if (row.attribute.need == Need::Later) {
    row.is_sound = false;
    return findings.add_problem(
        row.line, fmt::format("the attribute {} of {} {}", in_quotes(given.Name()), tag(element),
                              not_supported(row.attribute.instead)));
  }
  if (const Reading<void> read = row.read(given.Value()); !read) {
    row.is_sound = false;
    findings.add_problem(row.line,
                         value_problem(element, given.Name(), given.Value(), read.error()));
  }
}

/// Whether an attribute of the root only tells editors and validators where the schema is.
bool names_schema(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute& given) {
  if (element.Parent() != element.GetDocument()) return false;
  const std::string_view name = given.Name();
  return name == "xsi:noNamespaceSchemaLocation" ||
         (name == "xmlns:xsi" &&
          given.Value() == std::string_view("http://www.w3.org/2001/XMLSchema-instance"));
}

}  // namespace

void read_attributes(const tinyxml2::XMLElement& element, Table& table, Findings& findings) {
  const std::vector<std::string_view> names = supported_names(table);
  std::vector<std::string_view> meant;  // attributes that a misspelt one probably stands for
  for (const auto* given = element.FirstAttribute(); given && !findings.is_full();
       given = given->Next()) {
    if (names_schema(element, *given)) continue;
    if (Slot* row = find(table, given->Name())) {
      read_value(element, *given, *row, findings);
      continue;
    }
    findings.add_problem(
        given->GetLineNum(),
        fmt::format("{} has no attribute {}{}", tag(element), in_quotes(given->Name()),
                    attribute_hint(element.Name(), given->Name(), names, meant)));
  }
  for (Slot& row : table) {
    if (std::find(meant.begin(), meant.end(), row.attribute.name) != meant.end())
      row.is_sound = false;
    if (row.attribute.need != Need::Required || row.line != 0 || !row.is_sound) continue;
    row.is_sound = false;
    findings.add_problem(element.GetLineNum(), fmt::format("{} needs the attribute \"{}\"",
                                                           tag(element), row.attribute.name));
  }
}

bool read_children(const tinyxml2::XMLElement& element, std::span<const Child> children,
                   Findings& findings) {
  bool all_known = true;
  for (const auto* node = element.FirstChild(); node && !findings.is_full();
       node = node->NextSibling()) {
    if (node->ToText())
      findings.add_problem(node->GetLineNum(),
                           fmt::format("{} contains the text {}; no text is allowed here",
                                       tag(element), in_quotes(trimmed(node->Value()))));
    const auto* child = node->ToElement();
    if (!child) continue;
    const auto known = std::find_if(children.begin(), children.end(), [&](const Child& candidate) {
      return candidate.name == child->Name();
    });
    if (known != children.end()) {
      known->read(*child);
      continue;
    }
    all_known = false;
    if (is_include(*child))
      findings.add_consequence();
    else
      findings.add_problem(child->GetLineNum(), unknown_child(element, *child, children));
  }
  return all_known;
}

bool read_numbers(const tinyxml2::XMLElement& element, std::vector<double>& numbers,
                  Findings& findings) {
  bool is_sound = true;
  const auto complain = [&](int line, std::string message) {
    is_sound = false;
    findings.add_problem(line, std::move(message));
  };
  for (const auto* node = element.FirstChild(); node && !findings.is_full();
       node = node->NextSibling()) {
    const auto* child = node->ToElement();
    if (child && is_include(*child))
      is_sound = false;
    else if (child)
      complain(child->GetLineNum(), unknown_child(element, *child, {}));
    if (!node->ToText()) continue;
    // The line of a text is that of its first word.
    std::string_view text = node->Value();
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    for (int line = node->GetLineNum(); !text.empty() && !findings.is_full();) {
      const std::string_view word = text.substr(0, text.find_first_of(blanks));
      const Reading<double> number = parse_number(word);
      if (number)
        numbers.push_back(*number);
      else
        complain(line, fmt::format("{} number {}, {}: {}", tag(element), numbers.size() + 1,
                                   in_quotes(word), number.error()));
      if (!number) return false;
      text.remove_prefix(word.size());
      const std::size_t gap = std::min(text.find_first_not_of(blanks), text.size());
      line += static_cast<int>(std::count(text.begin(), text.begin() + gap, '\n'));
      text.remove_prefix(gap);
    }
  }
  return is_sound;
}

Slot* find(std::span<Slot> table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Slot& row) { return row.attribute.name == name; });
  return found != table.end() ? &*found : nullptr;
}

std::string tag(const tinyxml2::XMLElement& element) {
  const std::string name = in_quotes(element.Name());
  return '<' + name.substr(1, name.size() - 2) + '>';
}

bool is_unknown(const tinyxml2::XMLAttribute& given) { return given.Value()[0] == unknown_value; }

std::string value_problem(const tinyxml2::XMLElement& element, std::string_view attribute,
                          std::string_view text, std::string_view complaint) {
  return fmt::format("{} {}={}: {}", tag(element), attribute, in_quotes(text), complaint);
}

void locate_file(const tinyxml2::XMLElement& element, Slot& row, const std::string& surface,
                 const std::string& named_by, std::string& path, SceneFile& file) {
  if (row.line == 0 || !row.is_sound) return;
  const std::string written = std::exchange(path, (file.folder_at(row.line) / path).string());
  if (const auto below = find_below(path, file.root); !below) {
    row.is_sound = false;
    return file.findings.add_problem(
        row.line, value_problem(element, row.attribute.name, written, below.error().message));
  }
  file.meshes.push_back({surface, path, row.line, named_by});
}

void record(const std::string& name, std::span<const Slot> table, SceneFile& file) {
  for (const Slot& row : table) {
    const std::string path = fmt::format("{}.{}", name, row.attribute.name);
    if (row.line != 0) file.lines[path] = row.line;
    if (!row.is_sound) file.unsound.insert(path);
  }
}

void record_element(const tinyxml2::XMLElement& element, const std::string& name,
                    std::span<const Slot> table, SceneFile& file) {
  if (name.empty()) return;
  file.lines[name] = element.GetLineNum();
  record(name, table, file);
}

}  // namespace pliant::xml
