#include "pliant/scene/sharing/expand.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/sharing/definitions.hpp"
#include "pliant/scene/sharing/expansion_rules.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

namespace fs = std::filesystem;

bool has_definition(std::string_view raw) {
  return raw.find('$') != std::string_view::npos || raw.find("&#") != std::string_view::npos;
}

/// A text while it is expanded.
struct OpenText {
  std::string_view text;
  const Markup& markup;
  int index;  ///< among the sources
  fs::path folder;
  std::string identity = {};  ///< of its file; empty: unknown
  const OpenText* includer = nullptr;
  std::size_t depth = 0;  ///< of elements around those of it that take part

  std::string_view name_of(const ElementPlace& element) const { return element.name.of(text); }
  TextPlace at(const TextRange& range) const { return {index, range}; }
  TextPlace name_place(const ElementPlace& element) const { return at(element.name); }
};

/// The line of a definition of a text; all are found when one is asked for.
std::function<std::optional<int>(std::string_view)> later_definitions(const OpenText& text,
                                                                      const SourceMap& sources) {
  using Places = std::map<std::string_view, TextRange, std::less<>>;
  return
      [&, places = std::optional<Places>()](std::string_view name) mutable -> std::optional<int> {
        if (!places) {
          places.emplace();
          for (std::size_t k = 0; k < text.markup.elements.size(); ++k) {
            const ElementPlace& element = text.markup.elements[k];
            if (text.name_of(element) != define_name) continue;
            if (const auto* const own = text.markup.attribute_of(k, "name", text.text))
              places->emplace(own->value.of(text.text), element.name);
          }
        }
        const auto found = places->find(name);
        if (found == places->end()) return std::nullopt;
        return sources.place_of(text.at(found->second)).line;
      };
}

class Expander {
 public:
  Expander(const Markup& markup, const TextFiles& files, SourceMap& sources, Findings& findings)
      : files_(files),
        sources_(sources),
        findings_(findings),
        expansion_{Tree::spliced(sources.text(0), markup)} {}

  std::optional<Expansion> expand(const Markup& markup, const fs::path& folder);

 private:
  void expand(const OpenText& text, Scope& scope);
  void expand_attribute(const OpenText& text, const ElementPlace& element,
                        const AttributePlace& attribute, Scope& scope);
  void define(const OpenText& text, std::size_t index, const Scope& scope, Definitions& definitions,
              const Definitions* given);
  void include(const OpenText& text, std::size_t index, Scope& scope);
  void expand_file(const OpenText& text, std::uint32_t element, const fs::path& path,
                   const std::string& identity, Scope& inner);
  const IncludedFile* read(const fs::path& path, const std::string& identity, int index);
  bool may_include(const OpenText& inside);
  bool read_attributes(const OpenText& text, std::size_t index,
                       std::span<std::pair<std::string_view, std::optional<std::string>>> table);
  bool check_place(const OpenText& text, const ElementPlace& element);
  void report_unused(const std::string& file, const Definitions& given, const Scope& inner);

  void add(const TextPlace& place, std::string message) {
    findings_.add_problem(place, std::move(message));
  }
  /// About the value of an attribute.
  void add_value(const OpenText& text, const AttributePlace& place, std::string_view element,
                 std::string_view value, std::string_view complaint) {
    add(text.at(place.value), fmt::format("<{}> {}={}: {}", element, place.name.of(text.text),
                                          in_quotes(value), complaint));
  }
  std::string told(const ExpandedValue& refused, const OpenText& text) const {
    return refused.text.error().message + sources_.told(refused.sources, text.at({}));
  }
  /// Adds a problem that concerns a limit, after which nothing is expanded further.
  void stop(const TextPlace& place, std::string message) {
    if (!is_stopped_) add(place, std::move(message));
    is_stopped_ = true;
  }
  /// Counts bytes that are read or defined. Returns whether they are within the limit.
  bool spend(std::size_t bytes, const TextPlace& place) {
    spent_ += bytes;
    if (findings_.is_over(bytes)) is_stopped_ = true;
    if (spent_ <= most_expanded) return true;
    stop(place,
         fmt::format("the scene, with all that it includes and defines, is larger than {} MiB",
                     most_expanded >> 20U));
    return false;
  }

  const TextFiles& files_;
  SourceMap& sources_;
  Findings& findings_;
  Expansion expansion_;
  ExpansionRules rules_;
  std::size_t spent_ = 0;
  std::size_t markup_count_ = 0;
  int include_count_ = 0;
  int definition_count_ = 0;
  bool is_stopped_ = false;
};

std::optional<Expansion> Expander::expand(const Markup& markup, const fs::path& folder) {
  const std::size_t problems = findings_.problem_count();
  const Result<std::string> identity = files_.identify(sources_.sources().front().file);
  const OpenText text{.text = sources_.text(0),
                      .markup = markup,
                      .index = 0,
                      .folder = folder,
                      .identity = identity ? *identity : std::string()};
  markup_count_ = markup.elements.size() + markup.attributes.size();
  spent_ = text.text.size();
  Scope scope;
  scope.later = later_definitions(text, sources_);
  expand(text, scope);
  if (is_stopped_) return std::nullopt;
  expansion_.is_sound = findings_.problem_count() == problems;
  return std::move(expansion_);
}

void Expander::expand(const OpenText& text, Scope& scope) {
  const auto& elements = text.markup.elements;
  // A $ may also be written as &#36;.
  const bool has_values = find_from(text.text, "$", 0, findings_) != std::string_view::npos ||
                          find_from(text.text, "&#", 0, findings_) != std::string_view::npos;
  std::vector<std::uint32_t> ends;  // of the elements around
  for (std::size_t k = 0; k < elements.size() && !is_stopped_;) {
    constexpr std::size_t parts_of_element = 256;  // besides those of its bytes
    if (findings_.is_over(parts_of_element)) {
      is_stopped_ = true;
      break;
    }
    const ElementPlace& element = elements[k];
    const std::string_view name = text.name_of(element);
    const bool is_define = name == define_name;
    if (is_define || name == include_name) {
      if (is_define && check_place(text, element)) define(text, k, scope, scope.own, scope.given);
      if (!is_define && check_place(text, element)) include(text, k, scope);
      k = text.markup.after(k);
      continue;
    }
    while (!ends.empty() && ends.back() <= element.name.begin) ends.pop_back();
    if (text.depth + ends.size() >= deepest_element)
      return stop(text.name_place(element), "malformed XML: " + nested_too_deep(name));
    ends.push_back(element.end);
    for (const AttributePlace& attribute : text.markup.attributes_of(k))
      if (has_values && has_definition(attribute.value.of(text.text)))
        expand_attribute(text, element, attribute, scope);
    ++k;
  }
}

void Expander::expand_attribute(const OpenText& text, const ElementPlace& element,
                                const AttributePlace& attribute, Scope& scope) {
  const std::string value = decoded(attribute.value.of(text.text));
  const std::string_view owner = text.name_of(element), name = attribute.name.of(text.text);
  const TextPlace place = text.at(attribute.value);
  findings_.is_over(value.size());
  auto expanded = expand_value(value, scope, rules_.is_text(owner, name) ? Use::Text : Use::Number,
                               findings_.may_compare_names());
  if (!expanded.text) {
    const bool is_scene = element.parent == ElementPlace::no_parent && owner == scene_name;
    if (!expanded.text.error().message.empty())
      add_value(text, attribute, owner, value,
                is_scene ? "the attributes of <scene> come before all definitions; write the value "
                           "itself"
                         : told(expanded, text));
    return expansion_.tree.set_value(text.index, attribute.value.begin, {});
  }
  spend(expanded.text->size(), place);
  if (!expanded.sources.empty()) sources_.add_value(place, std::move(expanded.sources));
  expansion_.tree.set_value(text.index, attribute.value.begin, *std::move(expanded.text));
}

bool Expander::check_place(const OpenText& text, const ElementPlace& element) {
  const std::string_view name = text.name_of(element);
  const std::string_view parent = element.parent == ElementPlace::no_parent
                                      ? ""
                                      : text.name_of(text.markup.elements[element.parent]);
  if (rules_.may_contain(parent) || parent == fragment_name) return true;
  add(text.name_place(element),
      parent.empty()
          ? fmt::format("the root element is <{}>, which belongs in a <scene> or <fragment>", name)
          : fmt::format("<{}> has no element {}; it belongs in {}", parent, in_quotes(name),
                        listed(rules_.containers())));
  return false;
}

/// Reads the attributes of an <include> or <define>, all of which are required. Returns whether
/// they are complete.
bool Expander::read_attributes(
    const OpenText& text, std::size_t index,
    std::span<std::pair<std::string_view, std::optional<std::string>>> table) {
  const ElementPlace& element = text.markup.elements[index];
  const std::string_view owner = text.name_of(element);
  std::vector<std::string_view> names;
  for (const auto& [name, value] : table) names.push_back(name);
  bool is_complete = true;
  for (const AttributePlace& given : text.markup.attributes_of(index)) {
    const std::string_view name = given.name.of(text.text);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) {
      table[static_cast<std::size_t>(found - names.begin())].second =
          decoded(given.value.of(text.text));
      continue;
    }
    is_complete = false;
    add(text.at(given.name),
        fmt::format("<{}> has no attribute {}{}", owner, in_quotes(name), hint(name, names)));
  }
  if (!is_complete) return false;
  for (const auto& [name, value] : table) {
    if (value) continue;
    is_complete = false;
    add(text.name_place(element), fmt::format("<{}> needs the attribute \"{}\"", owner, name));
  }
  return is_complete;
}

/// Reads a <define> into `definitions`. What is given from outside replaces its value.
void Expander::define(const OpenText& text, std::size_t index, const Scope& scope,
                      Definitions& definitions, const Definitions* given) {
  const ElementPlace& element = text.markup.elements[index];
  std::pair<std::string_view, std::optional<std::string>> table[] = {{"name", {}}, {"value", {}}};
  const bool is_complete = read_attributes(text, index, table);
  if (const auto content = bare_text(text.text, element.content_in(text.text)); content)
    add(text.at(*content), fmt::format("<{}> contains {}; nothing is allowed in it", define_name,
                                       in_quotes(content->of(text.text))));
  if (!table[0].second) return;
  const std::string& name = *table[0].second;
  const AttributePlace& own = *text.markup.attribute_of(index, "name", text.text);
  if (!is_definition_name(name))
    return add_value(text, own, define_name, name,
                     "must be a letter or _ followed by letters, digits and _");
  if (const auto first = definitions.find(name); first != definitions.end())
    return add_value(text, own, define_name, name,
                     fmt::format("the name is already defined at {}",
                                 sources_.title_of(first->second.place, text.at(own.value))));
  if (++definition_count_ > most_definitions)
    return stop(text.at(own.value),
                fmt::format("the scene has more than {} definitions", most_definitions));
  Definition definition;
  const TextPlace place = text.name_place(element);
  definition.sources = {sources_.add_definition(name, place)};
  const auto instead = given ? given->find(name) : Definitions::const_iterator();
  if (is_complete && given && instead != given->end()) {
    instead->second.is_used = true;
    definition = instead->second;
  } else if (is_complete) {
    // Its own name is not defined yet: there it has the value from outside, if there is one.
    scope.defined_now = name;
    const auto value =
        expand_value(*table[1].second, scope, Use::Definition, findings_.may_compare_names());
    scope.defined_now = {};
    if (value.text) {
      definition.sources.insert(definition.sources.end(), value.sources.begin(),
                                value.sources.end());
      definition.set(*value.text);
    } else if (!value.text.error().message.empty()) {
      add_value(text, *text.markup.attribute_of(index, "value", text.text), define_name,
                *table[1].second, told(value, text));
    }
  }
  definition.place = place;
  spend(definition.text.size(), place);
  definitions.emplace(name, std::move(definition));
}

void Expander::include(const OpenText& text, std::size_t index, Scope& scope) {
  const ElementPlace& element = text.markup.elements[index];
  std::pair<std::string_view, std::optional<std::string>> table[] = {{"file", {}}};
  const bool is_complete = read_attributes(text, index, table);
  Definitions given;
  TextRange content = element.content_in(text.text);
  const auto check_text = [&](std::uint32_t to) {
    if (const auto bare = bare_text(text.text, {content.begin, to}); bare)
      add(text.at(*bare), fmt::format("<{}> contains {}; only <{}> is allowed in it", include_name,
                                      in_quotes(bare->of(text.text)), define_name));
  };
  const std::size_t after = text.markup.after(index);
  for (std::size_t k = index + 1; k < after; k = text.markup.after(k)) {
    const ElementPlace& child = text.markup.elements[k];
    check_text(child.whole().begin);
    content.begin = child.end;
    const std::string_view name = text.name_of(child);
    constexpr std::string_view allowed[] = {define_name};
    if (name == define_name)
      define(text, k, scope, given, nullptr);
    else
      add(text.name_place(child), fmt::format("<{}> has no element {}{}", include_name,
                                              in_quotes(name), hint(name, allowed)));
  }
  check_text(content.end);
  if (!is_complete) return;

  const std::string& written = *table[0].second;
  const AttributePlace& named = *text.markup.attribute_of(index, "file", text.text);
  const auto refuse = [&](std::string_view complaint) {
    add_value(text, named, include_name, written, complaint);
  };
  const auto expanded = expand_value(written, scope, Use::Text, findings_.may_compare_names());
  if (!expanded.text) {
    if (!expanded.text.error().message.empty()) refuse(told(expanded, text));
    return;
  }
  const std::string& file = *expanded.text;
  if (trimmed(file).empty()) return refuse("is empty; the name of a file is required");
  if (file.find('\0') != std::string::npos) return refuse("is not the name of a file");
  const fs::path path = text.folder / file;
  if (++include_count_ > most_includes)
    return stop(text.at(named.value),
                fmt::format("the scene includes more than {} files", most_includes));
  int depth = 1;
  for (const OpenText* one = &text; one->includer; one = one->includer) ++depth;
  if (depth > deepest_include)
    return refuse(fmt::format("files include each other deeper than {}", deepest_include));
  const Result<std::string> identity = files_.identify(path);
  if (!identity)
    return refuse(fmt::format("{}: {}", printable(path.string()), identity.error().message));
  for (const OpenText* one = &text; one; one = one->includer)
    if (one->identity == *identity)
      return refuse(fmt::format("{} includes itself", printable(path.string())));

  const std::size_t problems = findings_.problem_count();
  Scope inner;
  inner.outer = &scope;
  inner.given = &given;
  expand_file(text, static_cast<std::uint32_t>(index), path, *identity, inner);
  if (findings_.problem_count() == problems) report_unused(file, given, inner);
  scope.take(std::move(inner));
}

/// A definition that is given to a file which neither has nor uses it is probably misspelt.
void Expander::report_unused(const std::string& file, const Definitions& given,
                             const Scope& inner) {
  constexpr std::size_t most_compared = 1000;
  std::vector<std::string_view> names;
  for (const auto& [own, value] : inner.own)
    if (names.size() < most_compared) names.push_back(own);
  for (const auto& [name, definition] : given) {
    if (definition.is_used) continue;
    if (findings_.is_over()) return;
    const auto near = findings_.may_compare_names() ? nearest_word(name, names)
                                                    : std::optional<std::string_view>();
    findings_.add_problem(
        definition.place,
        fmt::format("<{}> name={}: {} neither defines nor uses it{}", define_name, in_quotes(name),
                    in_quotes(file),
                    near ? fmt::format("; did you mean {}?", in_quotes(*near)) : ""));
  }
}

/// The file, from the disk or as it was read before; null: it has problems.
const IncludedFile* Expander::read(const fs::path& path, const std::string& identity, int index) {
  std::unique_ptr<IncludedFile>& file = expansion_.files[identity];
  if (!file) {
    file = std::make_unique<IncludedFile>();
    Result<std::string> bytes = files_.read(path, most_expanded - std::min(spent_, most_expanded));
    if (!bytes) {
      add({index}, bytes.error().message);
      return nullptr;
    }
    file->text = std::make_shared<SourceText>(*std::move(bytes));
    sources_.set_text(index, file->text);
    file->markup = scan_markup(findings_, index, most_markup - std::min(markup_count_, most_markup),
                               rules_.roots());
  } else if (file->markup) {
    sources_.set_text(index, file->text);
  } else {  // alike, they would be told once
    findings_.add_consequence();
  }
  return file->markup ? file.get() : nullptr;
}

/// Whether the root of a file may be included.
bool Expander::may_include(const OpenText& inside) {
  const ElementPlace& root = inside.markup.elements.front();
  const std::string_view name = inside.name_of(root);
  if (std::find(rules_.roots().begin(), rules_.roots().end(), name) == rules_.roots().end()) {
    add(inside.name_place(root),
        fmt::format("the root element cannot be included; a file that is included must contain one "
                    "of: {}",
                    listed(rules_.roots())));
    return false;
  }
  if (name != fragment_name) return true;
  for (const AttributePlace& attribute : inside.markup.attributes_of(0))
    add(inside.at(attribute.name), fmt::format("<{}> has no attribute {}; allowed: none", name,
                                               in_quotes(attribute.name.of(inside.text))));
  return true;
}

/// Puts the content of a file, if it has any that may be included, in the place of an element.
void Expander::expand_file(const OpenText& text, std::uint32_t element, const fs::path& path,
                           const std::string& identity, Scope& inner) {
  const ElementPlace& place = text.markup.elements[element];
  const int index = sources_.add(path.string(), text.name_place(place));
  const IncludedFile* file = read(path, identity, index);
  if (file && !spend(file->text->text().size(), text.name_place(place))) file = nullptr;
  if (file) markup_count_ += file->markup->elements.size() + file->markup->attributes.size();
  if (markup_count_ > most_markup) {
    stop(text.name_place(place),
         fmt::format("the scene, with all that it includes, has more than {} elements and "
                     "attributes",
                     most_markup));
  }
  if (!file || is_stopped_) return expansion_.tree.include(text.index, element, {}, nullptr, false);
  const std::string_view root = file->markup->elements.front().name.of(file->text->text());
  const bool is_content = root == fragment_name || root == scene_name;
  std::size_t depth = text.depth;
  for (std::uint32_t at = place.parent; at != ElementPlace::no_parent;
       at = text.markup.elements[at].parent)
    ++depth;
  const OpenText inside{.text = file->text->text(),
                        .markup = *file->markup,
                        .index = index,
                        .folder = path.parent_path(),
                        .identity = identity,
                        .includer = &text,
                        .depth = depth - (is_content ? 1 : 0)};
  const bool is_included = may_include(inside);
  expansion_.tree.include(text.index, element, inside.text, is_included ? &*file->markup : nullptr,
                          is_content);
  if (!is_included) return;
  inner.later = later_definitions(inside, sources_);
  expand(inside, inner);
  inner.later = {};
}

}  // namespace

TextFiles files_on_disk(const fs::path& root, const StopRequest& should_stop) {
  const auto last = std::make_shared<std::optional<OpenFile>>();
  const auto open = [root, last](const fs::path& path) -> Result<void> {
    if (*last && (*last)->name() == path.string()) return {};
    last->reset();
    auto opened = OpenFile::open(path, root);
    if (!opened) return fail(opened.error());
    last->emplace(*std::move(opened));
    return {};
  };
  const auto identify = [last, open](const fs::path& path) -> Result<std::string> {
    last->reset();
    if (auto opened = open(path); !opened) return fail(opened.error());
    return (*last)->identity();
  };
  const auto read = [last, open, should_stop](const fs::path& path,
                                              std::size_t most_bytes) -> Result<std::string> {
    if (auto opened = open(path); !opened) return fail(opened.error());
    return read_file(**last, most_bytes, should_stop);
  };
  return {.identify = identify, .read = read};
}

std::optional<Expansion> expand(const Markup& markup, const fs::path& folder,
                                const TextFiles& files, SourceMap& sources, Findings& findings) {
  return Expander(markup, files, sources, findings).expand(markup, folder);
}

}  // namespace pliant::xml
