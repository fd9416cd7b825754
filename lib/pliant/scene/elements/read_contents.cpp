#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/format/path_text.hpp"

namespace pliant::xml {
namespace {

/// Reads one element: its attributes, then what stands in it.
class ContentsReader {
 public:
  ContentsReader(const Element& element, Contents& contents, std::string owner, SceneFile& file)
      : element_(element),
        contents_(contents),
        owner_(std::move(owner)),
        file_(file),
        findings_(file.findings) {}

  void read_own_attributes();
  void locate_files();
  void read_rest();
  /// Where its own place is recorded, besides those of its attributes.
  void name_place(std::string path) { path_ = std::move(path); }
  /// The value of the attribute in which it differs from others; null: it is not sound.
  std::optional<std::string> key(std::string_view attribute) const;
  /// Its own path cannot be relied on.
  void doubt(const std::string& path) {
    if (!path.empty()) file_.unsound.insert(path);
  }

 private:
  std::vector<ChildReader> child_readers();
  void read_child(const Element& child, ChildPlace& place);
  void read_unique(const Element& child, ChildPlace& place);
  void read_listed(const Element& child, ChildPlace& place);
  void read_falloff(const Element& child);
  void read_text();
  void refuse_excluded();
  void refuse_parts_of_driven();
  void require_children(bool all_known);
  std::string title() const;  ///< `<surface> "sheet"`
  /// `line 5`, for a message about an element.
  std::string title_of(const TextPlace& place, const Element& from) const {
    return findings_.sources().title_of(place, from.place());
  }
  /// Of an element in it.
  std::string path_of(std::string_view element) const {
    return owner_.empty() ? "" : fmt::format("{}.{}", owner_, element);
  }

  const Element& element_;
  Contents& contents_;
  std::string owner_;
  SceneFile& file_;
  Findings& findings_;
  std::string path_;
  std::string name_;
  TextPlace falloff_;
  std::map<std::pair<std::string_view, std::string>, TextPlace> unique_;  // by their key
  std::map<std::string_view, int> listed_;  // how many elements without a name were read
};

std::string ContentsReader::title() const {
  return name_.empty() ? tag(element_) : fmt::format("{} {}", tag(element_), in_quotes(name_));
}

void ContentsReader::read_own_attributes() {
  read_attributes(element_, contents_.attributes, findings_);
  for (const Slot& slot : contents_.attributes) {
    if (slot.attribute.syntax != Syntax::Name) continue;
    name_ = *std::get<std::string*>(slot.place);
    owner_ = path_ = name_;
  }
}

std::optional<std::string> ContentsReader::key(std::string_view attribute) const {
  if (!std::ranges::all_of(contents_.attributes, &Slot::is_sound)) return std::nullopt;
  const std::optional<GivenAttribute> given = element_.attribute(attribute);
  return given ? std::optional(std::string(trimmed(given->value))) : std::nullopt;
}

void ContentsReader::read_rest() {
  if (contents_.take_numbers) {
    read_text();
  } else {
    require_children(read_children(element_, child_readers(), findings_));
  }
  refuse_excluded();
  refuse_parts_of_driven();
  if (owner_.empty() && !element_.is_root()) return;
  if (!path_.empty() || element_.is_root()) file_.parts[path_] = element_.place();
  record(owner_, contents_.attributes, file_);
  // An <animate> in it may have given attributes of its parts.
  for (const ChildPlace& place : contents_.children)
    if (place.part) record(owner_, place.part->attributes, file_);
}

std::vector<ChildReader> ContentsReader::child_readers() {
  std::vector<ChildReader> readers;
  const auto add = [&](bool are_lists) {
    for (ChildPlace& place : contents_.children) {
      if ((place.row.most > 1) != are_lists) continue;
      for (const std::string_view name : place.kinds.names)
        readers.push_back({name, [&](const Element& child) { read_child(child, place); }});
    }
  };
  add(false);
  if (contents_.has_channels())
    readers.push_back({Description<AnimateText<1>>::element, [&](const Element& child) {
                         read_animate(child, contents_.channels(), owner_, findings_);
                       }});
  if (contents_.has_positions())
    readers.push_back({Description<PathText>::element, [&](const Element& child) {
                         read_path(child, contents_.attributes, owner_, file_);
                       }});
  if (contents_.falloff)
    readers.push_back(
        {Description<FalloffText>::element, [&](const Element& child) { read_falloff(child); }});
  add(true);
  return readers;
}

void ContentsReader::read_child(const Element& child, ChildPlace& place) {
  if (place.row.most == 1 && place.first.is_known()) {
    const std::string what =
        place.row.noun.empty() ? "a second " + tag(child) : fmt::format("two {}s", place.row.noun);
    return findings_.add_problem(
        child.place(),
        fmt::format("{} has {}; the first is at {}", title(), what, title_of(place.first, child)));
  }
  if (!place.first.is_known()) place.first = child.place();
  if (!place.row.unique_by.empty()) return read_unique(child, place);
  if (place.part) return read_contents(child, *place.part, owner_, file_);
  if (place.row.most > 1) return read_listed(child, place);
  Contents contents = place.kinds.add(child.name());
  read_contents(child, contents, owner_, file_);
}

/// Reads one of a list. What has no name is told apart by its number.
void ContentsReader::read_listed(const Element& child, ChildPlace& place) {
  Contents contents = place.kinds.add(child.name());
  const bool is_named = std::ranges::any_of(
      contents.attributes, [](const Slot& slot) { return slot.attribute.syntax == Syntax::Name; });
  if (is_named || owner_.empty()) return read_contents(child, contents, owner_, file_);
  ContentsReader reader(
      child, contents, fmt::format("{}.{}", path_of(child.name()), listed_[child.name()]++), file_);
  reader.name_place(reader.owner_);
  reader.read_own_attributes();
  if (std::ranges::all_of(contents.attributes, &Slot::is_sound)) reader.locate_files();
  reader.read_rest();
}

/// Reads an element of which there may be one for each value of an attribute.
void ContentsReader::read_unique(const Element& child, ChildPlace& place) {
  const std::string path = path_of(child.name());
  Contents contents = place.kinds.add(child.name());
  ContentsReader reader(child, contents, path, file_);
  reader.read_own_attributes();
  const std::optional<std::string> key = reader.key(place.row.unique_by);
  if (!key) {
    reader.read_rest();
    place.kinds.drop();
    if (path.empty()) return;
    for (const std::string_view word :
         find(contents.attributes, place.row.unique_by)->attribute.words)
      doubt(fmt::format("{}.{}", path, word));
    return;
  }
  const auto [first, is_new] = unique_.emplace(std::pair{child.name(), *key}, child.place());
  if (!is_new) {
    place.kinds.drop();
    return findings_.add_problem(
        child.place(), fmt::format("{} has a second {} of {}; the first is at {}", title(),
                                   tag(child), *key, title_of(first->second, child)));
  }
  if (!path.empty()) {
    reader.owner_ = fmt::format("{}.{}", path, *key);
    reader.name_place(reader.owner_);
  }
  reader.locate_files();
  reader.read_rest();
}

/// A <falloff> stands in place of the attribute of that name.
void ContentsReader::read_falloff(const Element& child) {
  const TextPlace place = child.place();
  const Slot& attribute = *find(contents_.attributes, child.name());
  if (falloff_.is_known())
    findings_.add_problem(place, fmt::format("{} has a second {}; the first is at {}",
                                             tag(element_), tag(child), title_of(falloff_, child)));
  else if (attribute.at.is_known())
    findings_.add_problem(
        place, fmt::format("{} has both a {} and the attribute {} ({}); remove one of them",
                           tag(element_), tag(child), child.name(), title_of(attribute.at, child)));
  if (!falloff_.is_known()) falloff_ = place;
  *contents_.falloff = read_curve<1>(child, KeyAxis::Falloff, ValueKind::Number,
                                     fmt::format("{}.{}", owner_, child.name()), findings_);
}

void ContentsReader::read_text() {
  if (path_.empty()) name_place(path_of(element_.name()));
  std::vector<double> numbers;
  if (!read_numbers(element_, numbers, findings_)) return doubt(path_);
  const Checked<void> taken =
      numbers.empty() ? refused("has no numbers") : contents_.take_numbers(std::move(numbers));
  if (taken) return;
  doubt(path_);
  findings_.add_problem(element_.place(),
                        fmt::format("{} {}", tag(element_), taken.error().message));
}

void ContentsReader::locate_files() {
  for (Slot& slot : contents_.attributes) {
    auto* const* const file = std::get_if<std::string*>(&slot.place);
    if (slot.attribute.syntax != Syntax::Path || !file) continue;
    locate_file(element_, slot, owner_.substr(0, owner_.find('.')), **file, file_);
  }
}

void ContentsReader::refuse_excluded() {
  for (Slot& slot : contents_.attributes) {
    if (slot.excluded.empty() || !slot.at.is_known()) continue;
    slot.is_sound = false;
    findings_.add_problem(
        slot.at, fmt::format("{} {}: {}", tag(element_), slot.attribute.name, slot.excluded));
  }
}

/// What drives a surface also moves it: only some of its parts are its own.
void ContentsReader::refuse_parts_of_driven() {
  if (!contents_.driver || contents_.driver->empty()) return;
  const std::string driver = in_quotes(*contents_.driver);
  for (const ChildPlace& place : contents_.children) {
    if (!place.first.is_known() || place.row.is_of_driven) continue;
    findings_.add_problem(
        place.first, fmt::format("{} is driven by {} and has no <{}>; that of {} counts", title(),
                                 driver, place.kinds.names.front(), driver));
  }
}

/// `all_known`: no unknown element may be one that is misspelt.
void ContentsReader::require_children(bool all_known) {
  for (const ChildPlace& place : contents_.children) {
    if (place.row.least == 0 || place.row.most > 1 || place.first.is_known()) continue;
    doubt(path_of(place.kinds.names.front()));
    if (!all_known) continue;
    if (place.row.noun.empty()) {
      findings_.add_problem(
          element_.place(),
          fmt::format("{} needs the element <{}>", tag(element_), place.kinds.names.front()));
      continue;
    }
    std::string kinds;
    for (const std::string_view name : place.kinds.names) {
      if (!kinds.empty()) kinds += name == place.kinds.names.back() ? " or " : ", ";
      kinds += fmt::format("<{}>", name);
    }
    findings_.add_problem(element_.place(), fmt::format("{} has no {}: one {} is required", title(),
                                                        place.row.noun, kinds));
  }
}

}  // namespace

void read_contents(const Element& element, Contents& contents, const std::string& owner,
                   SceneFile& file) {
  ContentsReader reader(element, contents, owner, file);
  reader.read_own_attributes();
  reader.locate_files();
  reader.read_rest();
}

}  // namespace pliant::xml
