// A scene that is cut at random into files and definitions is the same scene, and its problems are
// told where they are.

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/sharing/expand.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/write.hpp"
#include "scene/scene_text.hpp"
#include "support/sanitized.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

using xml::ElementPlace;

/// A text, and its elements and attributes.
struct Scanned {
  explicit Scanned(const std::string& of) : text(of) {
    xml::Findings findings("a.xml", SourceText::of(text));
    constexpr std::string_view roots[] = {"scene",   "fragment", "surface",   "material", "group",
                                          "point",   "grid",     "transform", "tangents", "solver",
                                          "animate", "mesh",     "radial",    "line"};
    auto scanned = xml::scan_markup(findings, 0, xml::most_markup, roots);
    REQUIRE(scanned);
    markup = *std::move(scanned);
  }
  std::string_view name_of(std::size_t element) const {
    return markup.elements[element].name.of(text);
  }
  std::string_view parent_of(std::size_t element) const {
    const std::uint32_t parent = markup.elements[element].parent;
    return parent == ElementPlace::no_parent ? "" : name_of(parent);
  }

  const std::string& text;
  xml::Markup markup;
};

int line_at(const std::string& text, std::size_t offset) {
  return 1 + static_cast<int>(std::count(text.begin(),
                                         text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

/// Cuts shot.xml at random.
class Cutter {
 public:
  Cutter(std::string text, unsigned seed) : random_(seed) { files_["shot.xml"] = std::move(text); }

  std::size_t upto(std::size_t most) { return random_() % (most + 1); }

  void cut(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      if (upto(1) == 0)
        cut_file();
      else
        cut_value();
    }
  }

  const std::map<std::string, std::string>& files() const { return files_; }

  void write_to(const ScratchFolder& folder) const {
    for (const auto& [name, text] : files_) folder.write(name, text);
  }

 private:
  /// Moves elements that follow each other to a file of their own.
  void cut_file() {
    std::string& text = random_file();
    const Scanned scanned(text);
    std::vector<std::size_t> candidates;
    for (std::size_t k = 0; k < scanned.markup.elements.size(); ++k)
      if (may_include(scanned.parent_of(k))) candidates.push_back(k);
    if (candidates.empty()) return;
    const std::size_t first = candidates[upto(candidates.size() - 1)];
    const auto& elements = scanned.markup.elements;
    std::size_t end = elements[first].end;
    bool is_one = true;
    for (std::size_t k = first + 1; k < elements.size() && upto(2) > 0; ++k) {
      if (elements[k].parent != elements[first].parent || elements[k].name.begin < end) continue;
      end = elements[k].end;
      is_one = false;
    }
    const std::size_t begin = elements[first].whole().begin;
    const std::string_view root = scanned.name_of(first);
    const bool stands_alone = is_one && root != "include" && root != "define" && upto(1) == 0;
    const std::string content = text.substr(begin, end - begin);
    const std::string name = fmt::format("f{}.xml", ++file_count_);
    const std::string blank = upto(1) == 0 ? " " : "\n";
    text.replace(begin, end - begin, fmt::format("<include{}file=\"{}\"/>", blank, name));
    const char* const starts[] = {"", "\xEF\xBB\xBF", "<?xml version=\"1.0\"?>\n",
                                  "<!-- a\n\nb -->"};
    const std::string start = starts[upto(3)];
    const char* const around = upto(3) == 0 ? "scene" : "fragment";
    files_[name] = stands_alone
                       ? start + content + "\n"
                       : fmt::format("{0}<{1}>{2}{3}</{1}>", start, around, blank, content);
  }

  /// Replaces a value, or a part of it, by a definition.
  void cut_value() {
    std::string& text = random_file();
    const Scanned scanned(text);
    std::vector<std::pair<std::size_t, xml::AttributePlace>> candidates;
    for (std::size_t k = 0; k < scanned.markup.elements.size(); ++k) {
      if (scanned.name_of(k) == "include" || scanned.name_of(k) == "define") continue;
      if (k == 0 && scanned.name_of(k) == "scene") continue;  // nothing can be defined before it
      for (const auto& attribute : scanned.markup.attributes_of(k))
        if (attribute.value.of(text).find('$') == std::string_view::npos)
          candidates.emplace_back(k, attribute);
    }
    if (candidates.empty()) return;
    const auto& [element, attribute] = candidates[upto(candidates.size() - 1)];
    // A place before it where a definition may stand: beside an element around it.
    std::vector<std::size_t> places;
    for (std::uint32_t k = static_cast<std::uint32_t>(element); k != ElementPlace::no_parent;
         k = scanned.markup.elements[k].parent)
      if (may_include(scanned.parent_of(k)))
        places.push_back(scanned.markup.elements[k].whole().begin);
    if (places.empty()) return;
    const std::size_t place = places[upto(places.size() - 1)];
    const std::string value(attribute.value.of(text));
    const std::string name = fmt::format("v{}", ++value_count_);
    std::string defined = value, used = upto(1) == 0 ? "$" + name : "${" + name + "}";
    const bool is_number =
        xml::parse_number(value).has_value() && value.find_first_of(xml::blanks) == value.npos;
    const auto computed = [&] {
      const char* const ways[] = {"${0} * 1", "-(-${0})", "(${0})", "${0} / 1",
                                  "1 × ${0}", "${0}−0",   "+${0}"};
      return fmt::format(fmt::runtime(ways[upto(6)]), name);
    };
    const std::string_view of = attribute.name.of(text);
    const bool is_text = of == "object" || of == "file" || of == "name" || of == "targets";
    if (is_number && !is_text && value != "-0" && upto(1) == 0) {
      used = computed();
    } else if (!is_number && !value.empty() && upto(1) == 0) {
      const std::size_t at = cut_of(value);
      defined = value.substr(0, at);
      used = "${" + name + "}" + value.substr(at);
    }
    text.replace(attribute.value.begin, value.size(), used);
    const std::string definition = fmt::format("<define name=\"{}\" value=\"{}\"/>", name, defined);
    text.insert(place, upto(1) == 0 ? definition + "\n" : definition);
  }

  static bool may_include(std::string_view parent) {
    static constexpr std::string_view names[] = {"scene", "surface", "material", "group",
                                                 "point", "radial",  "line",     "fragment"};
    return std::find(std::begin(names), std::end(names), parent) != std::end(names);
  }

  std::string& random_file() {
    auto file = files_.begin();
    std::advance(file, upto(files_.size() - 1));
    return file->second;
  }

  /// Not in an entity, a character or a number, so that each part has a meaning.
  std::size_t cut_of(const std::string& value) {
    std::vector<std::size_t> cuts = {0};
    for (std::size_t at = 1; at < value.size(); ++at) {
      const bool is_in_entity =
          value.rfind('&', at) != value.npos && value.find(';', value.rfind('&', at)) >= at;
      const bool is_blank = value[at] == ' ';
      const bool is_letter = std::isalpha(static_cast<unsigned char>(value[at])) != 0 &&
                             std::isalpha(static_cast<unsigned char>(value[at - 1])) != 0;
      if (!is_in_entity && (is_blank || is_letter)) cuts.push_back(at);
    }
    return cuts[upto(cuts.size() - 1)];
  }

  std::mt19937 random_;
  std::map<std::string, std::string> files_;
  int file_count_ = 0;
  int value_count_ = 0;
};

/// The scene, with some of its blanks between attributes as line ends, of either kind.
std::string spread(std::string_view text, unsigned seed) {
  std::mt19937 random(seed);
  const std::string end = seed % 3 == 0 ? "\r\n" : "\n";
  std::string result;
  bool is_tag = false, is_quoted = false, is_declaration = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '<') is_declaration = text.substr(k, 2) == "<?" || text.substr(k, 2) == "<!";
    if (c == '<' || c == '>') is_tag = c == '<';
    if (c == '"') is_quoted = !is_quoted;
    if (c == ' ' && is_tag && !is_quoted && !is_declaration && random() % 3 == 0)
      result += end;
    else if (c == '\n')
      result += end;
    else
      result += c;
  }
  return result;
}

const auto seeds = static_cast<unsigned>(rounds(150));

TEST_CASE("a scene that is cut at random is the same scene", "[scene][sharing]") {
  const std::string uncut = to_xml(scene_of(rich_scene), "shots").value();
  int files = 0, definitions = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    CAPTURE(seed);
    Cutter cutter(spread(rich_scene, seed), seed);
    cutter.cut(1 + cutter.upto(25));
    const ScratchFolder folder;
    cutter.write_to(folder);
    const auto scene = load_scene(folder.file("shot.xml"));
    if (!scene) {
      for (const std::string& line : to_lines(scene.error())) UNSCOPED_INFO(line);
      for (const auto& [name, text] : cutter.files()) UNSCOPED_INFO(name + ":\n" + text);
    }
    REQUIRE(scene);
    CHECK(to_xml(*scene, folder.path()).value() == uncut);
    // Each part of the scene is found in its file.
    for (const ScenePart& part : scene->origin.parts) {
      const ScenePlace place = scene->origin.place_of(part.place);
      const auto file = cutter.files().find(std::filesystem::path(place.file).filename());
      REQUIRE(file != cutter.files().end());
      CHECK(place.line <= line_at(file->second, file->second.size()));
      CHECK(place.chain.empty() == (file->first == "shot.xml"));
    }
    files += static_cast<int>(cutter.files().size()) - 1;
    for (const auto& [name, text] : cutter.files())
      for (std::size_t at = 0; (at = text.find("<define", at)) != text.npos; ++at) ++definitions;
  }
  CHECK(files > rounds(500));
  CHECK(definitions > rounds(500));
}

/// The names of the files, and the lines of their includes, from a file out to the scene.
std::string chain_of(std::string name, const Cutter& cutter, const std::string& folder) {
  std::string chain;
  while (name != "shot.xml") {
    for (const auto& [other, text] : cutter.files()) {
      const std::size_t at = text.find(fmt::format("file=\"{}\"", name));
      if (at == text.npos) continue;
      chain += fmt::format("{}by {}/{}:{}", chain.empty() ? "; included " : ", ", folder, other,
                           line_at(text, text.rfind("<include", at)));
      name = other;
      break;
    }
  }
  return chain;
}

TEST_CASE("a problem is told where it is after any cut", "[scene][sharing]") {
  int included = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    CAPTURE(seed);
    std::string text = spread(rich_scene, seed);
    std::mt19937 random(seed);
    {
      const Scanned scanned(text);
      const auto& element = scanned.markup.elements[random() % scanned.markup.elements.size()];
      text.insert(element.name.end, random() % 2 == 0 ? " bogus=\"1\"" : "\nbogus=\"1\"");
    }
    Cutter cutter(text, seed);
    cutter.cut(20);
    const ScratchFolder folder;
    cutter.write_to(folder);
    const auto scene = load_scene(folder.file("shot.xml"));
    REQUIRE_FALSE(scene);
    std::vector<Error> errors = scene.error().others;
    errors.push_back(scene.error());
    std::erase_if(errors, [](const Error& error) {
      return error.message.find("has no attribute \"bogus\"") == std::string::npos;
    });
    REQUIRE(errors.size() == 1);
    const auto file =
        std::find_if(cutter.files().begin(), cutter.files().end(),
                     [](const auto& one) { return one.second.find("bogus") != std::string::npos; });
    REQUIRE(file != cutter.files().end());
    CHECK(errors[0].file == folder.file(file->first));
    CHECK(errors[0].line == line_at(file->second, file->second.find("bogus")));
    const std::string chain = chain_of(file->first, cutter, folder.path());
    CHECK_THAT(errors[0].message, Catch::Matchers::EndsWith(chain));
    CHECK((errors[0].message.find("included by") == std::string::npos) == chain.empty());
    if (!chain.empty()) ++included;
  }
  CHECK(included > rounds(60));
}

}  // namespace
}  // namespace pliant::testing
