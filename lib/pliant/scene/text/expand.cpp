#include "pliant/scene/text/expand.hpp"

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
#include "pliant/scene/text/definitions.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/expansion_rules.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

namespace fs = std::filesystem;

bool has_definition(std::string_view raw) {
  return raw.find('$') != std::string_view::npos || raw.find("&#") != std::string_view::npos;
}

/// A file that is included, read once.
struct IncludedFile {
  std::string text;
  std::optional<Markup> markup;  ///< null: it has problems
  std::vector<Error> problems;
  bool is_told = false;  ///< the problems are
};

/// A text while it is expanded.
struct OpenText {
  std::string_view text;
  const Markup& markup;
  int index;  ///< in the map of lines
  fs::path folder;
  std::string identity;  ///< of its file; empty: unknown
  const OpenText* includer = nullptr;
  LineCounter lines{text};

  std::string_view name_of(const ElementPlace& element) const { return element.name.of(text); }
};

/// The lines of all definitions of a text, by name, counted when one is asked for.
std::function<std::optional<int>(std::string_view)> later_definitions(const OpenText& text) {
  return [&text, lines = std::optional<std::map<std::string_view, int, std::less<>>>()](
             std::string_view name) mutable -> std::optional<int> {
    if (!lines) {
      lines.emplace();
      LineCounter counter(text.text);
      for (std::size_t k = 0; k < text.markup.elements.size(); ++k) {
        const ElementPlace& element = text.markup.elements[k];
        if (text.name_of(element) != define_name) continue;
        for (const AttributePlace& attribute : text.markup.attributes_of(k))
          if (attribute.name.of(text.text) == "name")
            lines->emplace(attribute.value.of(text.text), counter.line_of(element.whole().begin));
      }
    }
    const auto found = lines->find(name);
    return found == lines->end() ? std::nullopt : std::optional(found->second);
  };
}

class Expander {
 public:
  Expander(const TextFiles& files, Findings& findings, std::string name)
      : files_(files), findings_(findings), map_(std::move(name)) {}

  std::optional<Expansion> expand(const SourceText& scene);

 private:
  void expand(OpenText& text, std::size_t begin, std::size_t end, Scope& scope);
  void expand_attribute(OpenText& text, const ElementPlace& element,
                        const AttributePlace& attribute, Scope& scope);
  void define(OpenText& text, std::size_t index, const Scope& scope, Definitions& definitions,
              const Definitions* given);
  bool include(OpenText& text, std::size_t index, Scope& scope);
  bool expand_file(OpenText& text, const ElementPlace& element, const fs::path& path,
                   const std::string& identity, Scope& inner);
  const IncludedFile* read(const fs::path& path, const std::string& identity, int index);
  bool read_attributes(OpenText& text, std::size_t index,
                       std::span<std::pair<std::string_view, std::optional<std::string>>> table);
  bool check_place(OpenText& text, const ElementPlace& element);
  void report_unused(OpenText& text, const std::string& file, const Definitions& given,
                     const Scope& inner);

  std::string_view content_of(const OpenText& text, const ElementPlace& element) const;

  void emit(std::string_view part) {
    out_ += part;
    line_ += static_cast<int>(std::count(part.begin(), part.end(), '\n'));
  }
  void begin_run(int text, int line) {
    emit("\n");
    map_.add_run(line_, text, line);
  }

  void add(OpenText& text, std::size_t where, std::string message) {
    findings_.add_problem(map_.place_in(text.index, text.lines.line_of(where)), std::move(message));
  }
  void add_value(OpenText& text, std::size_t where, std::string_view element,
                 std::string_view attribute, std::string_view value, std::string_view complaint) {
    add(text, where,
        fmt::format("<{}> {}={}: {}", element, attribute, in_quotes(value), complaint));
  }
  std::string told(const ValueRefusal& refusal, const OpenText& text) const {
    return refusal.complaint + values_.sources(refusal.sources, text.index, map_);
  }
  /// Adds a problem that concerns a limit, after which nothing is expanded further.
  void stop(OpenText& text, std::size_t where, std::string message) {
    if (!is_stopped_) add(text, where, std::move(message));
    is_stopped_ = true;
  }
  /// Counts bytes that are read or defined. Returns whether they are within the limit.
  bool spend(std::size_t bytes, OpenText& text, std::size_t where) {
    spent_ += bytes;
    if (findings_.is_over(bytes)) is_stopped_ = true;
    if (spent_ <= most_expanded && out_.size() <= most_expanded) return true;
    stop(text, where,
         fmt::format("the scene, with all that it includes and defines, is larger than {} MiB",
                     most_expanded >> 20U));
    return false;
  }

  const TextFiles& files_;
  Findings& findings_;
  LineMap map_;
  DefinedValues values_;
  std::vector<std::size_t> unknown_;
  ExpansionRules rules_;
  std::map<std::string, std::unique_ptr<IncludedFile>> read_;  // by identity
  std::string out_;
  int line_ = 1;  // of the end of out_
  std::size_t spent_ = 0;
  std::size_t markup_count_ = 0;
  int include_count_ = 0;
  int definition_count_ = 0;
  bool is_stopped_ = false;
};

std::string_view Expander::content_of(const OpenText& text, const ElementPlace& element) const {
  if (element.closes_itself()) return {};
  const std::size_t closing = text.text.rfind('<', element.end - 1);
  return text.text.substr(element.tag_end, closing - element.tag_end);
}

std::optional<Expansion> Expander::expand(const SourceText& scene) {
  const std::size_t problems = findings_.problem_count();
  const Result<std::string> identity = files_.identify(scene.name);
  OpenText text{.text = scene.text,
                .markup = scene.markup,
                .index = 0,
                .folder = scene.folder,
                .identity = identity ? *identity : std::string()};
  markup_count_ = scene.markup.elements.size() + scene.markup.attributes.size();
  out_.reserve(scene.text.size());
  Scope scope;
  scope.later = later_definitions(text);
  expand(text, 0, scene.text.size(), scope);
  if (!is_stopped_) spend(0, text, 0);
  if (is_stopped_) return std::nullopt;
  return Expansion{.text = std::move(out_),
                   .files = std::move(map_),
                   .values = std::move(values_),
                   .is_sound = findings_.problem_count() == problems,
                   .unknown = std::move(unknown_)};
}

/// Expands the bytes from `begin` to `end`, which contain whole elements.
void Expander::expand(OpenText& text, std::size_t begin, std::size_t end, Scope& scope) {
  const auto& elements = text.markup.elements;
  const auto first = std::lower_bound(
      elements.begin(), elements.end(), begin,
      [](const ElementPlace& element, std::size_t at) { return element.name.begin < at; });
  std::size_t written = begin;
  const auto write_to = [&](std::size_t to) {
    emit(text.text.substr(written, to - written));
    written = to;
  };
  for (auto k = static_cast<std::size_t>(first - elements.begin());
       k < elements.size() && elements[k].name.begin < end && !is_stopped_;) {
    constexpr std::size_t parts_of_element = 256;  // besides those of its bytes
    if (findings_.is_over(parts_of_element)) {
      is_stopped_ = true;
      break;
    }
    const ElementPlace& element = elements[k];
    const std::string_view name = text.name_of(element);
    if (name == define_name) {
      write_to(element.whole().begin);
      if (check_place(text, element)) define(text, k, scope, scope.own, scope.given);
      // Its lines stay, so that those after it keep theirs.
      const std::string_view whole = element.whole().of(text.text);
      emit(std::string(static_cast<std::size_t>(std::count(whole.begin(), whole.end(), '\n')),
                       '\n'));
      written = element.end;
      k = text.markup.after(k);
    } else if (name == include_name) {
      write_to(element.whole().begin);
      if (!check_place(text, element) || !include(text, k, scope))
        emit(fmt::format("<{}/>", include_name));
      begin_run(text.index, text.lines.line_of(element.end));
      written = element.end;
      k = text.markup.after(k);
    } else {
      for (const AttributePlace& attribute : text.markup.attributes_of(k)) {
        if (!has_definition(attribute.value.of(text.text))) continue;
        write_to(attribute.value.begin);
        expand_attribute(text, element, attribute, scope);
        written = attribute.whole().end;
      }
      ++k;
    }
  }
  write_to(end);
}

/// Writes a value with its closing quote; for one that cannot be made, see `Expansion`.
void Expander::expand_attribute(OpenText& text, const ElementPlace& element,
                                const AttributePlace& attribute, Scope& scope) {
  const std::string_view raw = attribute.value.of(text.text);
  const std::string value = decoded(raw);
  const std::string_view owner = text.name_of(element), name = attribute.name.of(text.text);
  findings_.is_over(value.size());
  const auto expanded =
      expand_value(value, scope, rules_.is_text(owner, name) ? Use::Text : Use::Number,
                   findings_.may_compare_names());
  if (!expanded) {
    const bool is_scene = element.parent == ElementPlace::no_parent && owner == scene_name;
    if (!expanded.error().complaint.empty())
      add_value(text, attribute.name.begin, owner, name, value,
                is_scene ? "the attributes of <scene> come before all definitions; write the value "
                           "itself"
                         : told(expanded.error(), text));
    unknown_.push_back(out_.size());
  } else if (!expanded->sources.empty()) {
    values_.add(line_, name, expanded->text, expanded->sources);
  }
  const char quote = text.text[attribute.value.end];
  emit(expanded ? encoded(expanded->text, quote) : "?");
  emit({&quote, 1});
  spend(0, text, attribute.name.begin);
  // The value is on one line now. Its other lines follow it.
  emit(std::string(static_cast<std::size_t>(std::count(raw.begin(), raw.end(), '\n')), '\n'));
}

bool Expander::check_place(OpenText& text, const ElementPlace& element) {
  const std::string_view name = text.name_of(element);
  const std::string_view parent = element.parent == ElementPlace::no_parent
                                      ? ""
                                      : text.name_of(text.markup.elements[element.parent]);
  if (rules_.may_contain(parent) || parent == fragment_name) return true;
  add(text, element.whole().begin,
      parent.empty()
          ? fmt::format("the root element is <{}>, which belongs in a <scene> or <fragment>", name)
          : fmt::format("<{}> has no element {}; it belongs in {}", parent, in_quotes(name),
                        listed(rules_.containers())));
  return false;
}

/// Reads the attributes of an <include> or <define>, all of which are required. Returns whether
/// they are complete.
bool Expander::read_attributes(
    OpenText& text, std::size_t index,
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
    add(text, given.name.begin,
        fmt::format("<{}> has no attribute {}{}", owner, in_quotes(name), hint(name, names)));
  }
  if (!is_complete) return false;
  for (const auto& [name, value] : table) {
    if (value) continue;
    is_complete = false;
    add(text, element.whole().begin, fmt::format("<{}> needs the attribute \"{}\"", owner, name));
  }
  return is_complete;
}

/// Reads a <define> into `definitions`. What is given from outside replaces its value.
void Expander::define(OpenText& text, std::size_t index, const Scope& scope,
                      Definitions& definitions, const Definitions* given) {
  const ElementPlace& element = text.markup.elements[index];
  std::pair<std::string_view, std::optional<std::string>> table[] = {{"name", {}}, {"value", {}}};
  const bool is_complete = read_attributes(text, index, table);
  if (const std::string_view content = bare_text(content_of(text, element)); !content.empty())
    add(text, element.tag_end,
        fmt::format("<{}> contains {}; nothing is allowed in it", define_name, in_quotes(content)));
  if (!table[0].second) return;
  const std::string& name = *table[0].second;
  const std::size_t where = text.markup.attributes_of(index).front().name.begin;
  if (!is_definition_name(name))
    return add_value(text, where, define_name, "name", name,
                     "must be a letter or _ followed by letters, digits and _");
  if (const auto first = definitions.find(name); first != definitions.end())
    return add_value(text, where, define_name, "name", name,
                     fmt::format("the name is already defined at line {}", first->second.line));
  if (++definition_count_ > most_definitions)
    return stop(text, where,
                fmt::format("the scene has more than {} definitions", most_definitions));
  Definition definition;
  const int line = text.lines.line_of(element.whole().begin);
  definition.sources = {values_.add_definition(name, text.index, line)};
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
    if (value) {
      definition.sources.insert(definition.sources.end(), value->sources.begin(),
                                value->sources.end());
      definition.set(value->text);
    } else if (!value.error().complaint.empty()) {
      add_value(text, where, define_name, "value", *table[1].second, told(value.error(), text));
    }
  }
  definition.line = line;
  spend(definition.text.size(), text, where);
  definitions.emplace(name, std::move(definition));
}

/// Returns whether the file's content was written.
bool Expander::include(OpenText& text, std::size_t index, Scope& scope) {
  const ElementPlace& element = text.markup.elements[index];
  std::pair<std::string_view, std::optional<std::string>> table[] = {{"file", {}}};
  const bool is_complete = read_attributes(text, index, table);
  Definitions given;
  std::size_t content = element.tag_end;
  const auto check_text = [&](std::size_t to) {
    const std::string_view bare = bare_text(text.text.substr(content, to - content));
    if (!bare.empty())
      add(text, content,
          fmt::format("<{}> contains {}; only <{}> is allowed in it", include_name, in_quotes(bare),
                      define_name));
  };
  const std::size_t after = text.markup.after(index);
  for (std::size_t k = index + 1; k < after; k = text.markup.after(k)) {
    const ElementPlace& child = text.markup.elements[k];
    check_text(child.whole().begin);
    content = child.end;
    const std::string_view name = text.name_of(child);
    constexpr std::string_view allowed[] = {define_name};
    if (name == define_name)
      define(text, k, scope, given, nullptr);
    else
      add(text, child.whole().begin,
          fmt::format("<{}> has no element {}{}", include_name, in_quotes(name),
                      hint(name, allowed)));
  }
  if (!element.closes_itself()) check_text(text.text.rfind('<', element.end - 1));
  if (!is_complete) return false;

  const std::string& written = *table[0].second;
  const std::size_t where = text.markup.attributes_of(index).front().name.begin;
  const auto refuse = [&](std::string_view complaint) {
    add_value(text, where, include_name, "file", written, complaint);
    return false;
  };
  const auto expanded = expand_value(written, scope, Use::Text, findings_.may_compare_names());
  if (!expanded)
    return expanded.error().complaint.empty() ? false : refuse(told(expanded.error(), text));
  const std::string& file = expanded->text;
  if (trimmed(file).empty()) return refuse("is empty; the name of a file is required");
  if (file.find('\0') != std::string::npos) return refuse("is not the name of a file");
  const fs::path path = text.folder / file;
  if (++include_count_ > most_includes) {
    stop(text, where, fmt::format("the scene includes more than {} files", most_includes));
    return false;
  }
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
  const bool is_written = expand_file(text, element, path, *identity, inner);
  if (findings_.problem_count() == problems) report_unused(text, file, given, inner);
  scope.take(std::move(inner));
  return is_written;
}

/// A definition that is given to a file which neither has nor uses it is probably misspelt.
void Expander::report_unused(OpenText& text, const std::string& file, const Definitions& given,
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
        map_.place_in(text.index, definition.line),
        fmt::format("<{}> name={}: {} neither defines nor uses it{}", define_name, in_quotes(name),
                    in_quotes(file),
                    near ? fmt::format("; did you mean {}?", in_quotes(*near)) : ""));
  }
}

/// The file, from the disk or as it was read before; null: it has problems.
const IncludedFile* Expander::read(const fs::path& path, const std::string& identity, int index) {
  std::unique_ptr<IncludedFile>& file = read_[identity];
  if (!file) {
    file = std::make_unique<IncludedFile>();
    Findings own(path.string(), findings_.should_stop());
    Result<std::string> bytes = files_.read(path, most_expanded - std::min(spent_, most_expanded));
    if (bytes) {
      file->text = *std::move(bytes);
      file->markup = scan_markup(
          file->text, own, most_markup - std::min(markup_count_, most_markup), rules_.roots());
    } else {
      own.add_problem(0, bytes.error().message);
    }
    file->problems = own.problems();
    if (own.is_stopped()) findings_.is_over(StopPoll::parts_between);
  }
  if (file->markup) return file.get();
  if (std::exchange(file->is_told, true)) {  // alike, they would be told once
    findings_.add_consequence();
    return nullptr;
  }
  for (const Error& error : file->problems)
    findings_.add_problem(map_.place_in(index, error.line), error.message);
  return nullptr;
}

/// Writes the content of a file. Returns whether it has any that may be included.
bool Expander::expand_file(OpenText& text, const ElementPlace& element, const fs::path& path,
                           const std::string& identity, Scope& inner) {
  const std::size_t where = element.whole().begin;
  const int index = map_.add_text(path.string(), text.index, text.lines.line_of(where));
  const IncludedFile* const file = read(path, identity, index);
  if (!file || !spend(file->text.size(), text, where)) return false;
  const auto& elements = file->markup->elements;
  markup_count_ += elements.size() + file->markup->attributes.size();
  if (markup_count_ > most_markup) {
    stop(text, where,
         fmt::format("the scene, with all that it includes, has more than {} elements and "
                     "attributes",
                     most_markup));
    return false;
  }
  OpenText inside{.text = file->text,
                  .markup = *file->markup,
                  .index = index,
                  .folder = path.parent_path(),
                  .identity = identity,
                  .includer = &text};
  const ElementPlace& root = elements.front();
  const std::string_view name = inside.name_of(root);
  if (std::find(rules_.roots().begin(), rules_.roots().end(), name) == rules_.roots().end()) {
    add(inside, root.whole().begin,
        fmt::format("the root element cannot be included; a file that is included must contain one "
                    "of: {}",
                    listed(rules_.roots())));
    return false;
  }
  if (name == fragment_name)
    for (const AttributePlace& attribute : file->markup->attributes_of(0))
      add(inside, attribute.name.begin,
          fmt::format("<{}> has no attribute {}; allowed: none", name,
                      in_quotes(attribute.name.of(inside.text))));
  std::size_t begin = root.whole().begin, end = root.end;
  if (name == fragment_name || name == scene_name) {
    begin = root.tag_end;
    end = begin + content_of(inside, root).size();
  }
  begin_run(index, inside.lines.line_of(begin));
  inner.later = later_definitions(inside);
  expand(inside, begin, end, inner);
  inner.later = {};
  return true;
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

std::optional<Expansion> expand(const SourceText& scene, const TextFiles& files,
                                Findings& findings) {
  return Expander(files, findings, scene.name).expand(scene);
}

}  // namespace pliant::xml
