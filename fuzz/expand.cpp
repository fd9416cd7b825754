// A scene with the files that it includes: parts of one input, between lines of %%. The first is
// a.xml, the others are b.xml, c.xml, …

#include "pliant/scene/sharing/expand.hpp"

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "fuzz.hpp"
#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/sharing/arithmetic.hpp"
#include "support/tree_check.hpp"

using namespace pliant;
using namespace pliant::fuzzing;
using namespace pliant::xml;

namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

Files files_of(std::string_view input) {
  Files files;
  char name = 'a';
  for (const std::string_view part : parts_between(input, "\n%%\n")) {
    files[std::string(1, name) + ".xml"] = part;
    if (name++ == 'z') break;
  }
  return files;
}

TextFiles in_memory(const Files& files) {
  const auto find = [&files](const fs::path& path) -> Result<std::string> {
    const std::string name = path.lexically_normal().string();
    if (files.contains(name)) return name;
    return fail(ErrorCode::Unreadable, "no such file", name);
  };
  return {.identify = find,
          .read = [&files, find](const fs::path& path, std::size_t most) -> Result<std::string> {
            const std::string& text = files.at(*find(path));
            require(text.size() <= most);
            return text;
          }};
}

/// Each element and attribute is at a place of its file, where its name stands.
class TreeCheck {
 public:
  TreeCheck(const Expansion& expansion, const SourceMap& sources)
      : expansion_(expansion), sources_(sources) {}

  void check(const Element& element) const {
    require(element.name() != "define");
    require(element.name() != "include" || !expansion_.is_sound);
    check(element.place(), element.name());
    for (const GivenAttribute& given : element.attributes()) {
      require(!given.is_unknown || !expansion_.is_sound);
      check(given.name_place(), given.name);
    }
    std::optional<Element> last;
    for (auto child = element.first_child(); child; child = child->next()) {
      require(child->parent().place() == element.place());
      require(!last || sources_.is_before(last->place(), child->place()));
      check(*child);
      last = child;
    }
  }

 private:
  void check(const TextPlace& place, std::string_view name) const {
    require(place.range.of(sources_.text(place.text)) == name);
    const ScenePlace told = sources_.place_of(place);
    require(told.line >= 1 && told.end_line >= told.line);
    require(told.chain.empty() == (told.file == "a.xml"));
  }

  const Expansion& expansion_;
  const SourceMap& sources_;
};

/// What we make of a text is what tinyxml2 makes of it.
void compare(const std::string& text) {
  Findings findings("a.xml", SourceText::of(text));
  if (scan_markup(findings)) require(pliant::testing::PlaceCheck(text).find().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view input = text_of(bytes, size);
  if (const auto numbers = numbers_of(input); numbers && numbers->has_value())
    for (const double number : **numbers) require(number - number == 0);  // finite

  const Files files = files_of(input);
  for (const auto& [name, text] : files) compare(text);
  const std::string& text = files.at("a.xml");
  const auto sources = std::make_shared<SourceMap>("a.xml", SourceText::of(text));
  Findings findings(sources);
  const auto fails = [&] { check_error(findings.to_error(), std::size_t{20'000}); };
  const auto markup = scan_markup(findings);
  if (!markup) return fails(), 0;
  const auto expansion = expand(*markup, "", in_memory(files), *sources, findings);
  if (!expansion) return fails(), 0;
  require((findings.problem_count() == 0) == expansion->is_sound);
  const Element root = expansion->tree.root();
  if (root.name() != include_name && root.name() != define_name)  // of which there is no content
    TreeCheck(*expansion, *sources).check(root);
  const auto read = parse_scene_of(text, "a.xml", "", "", in_memory(files));
  if (!read) check_error(read.error(), 20'000);
  require(!read || expansion->is_sound);
  return 0;
}
