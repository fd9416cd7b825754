// A scene with the files that it includes: parts of one input, between lines of %%. The first is
// a.xml, the others are b.xml, c.xml, …

#include "pliant/scene/text/expand.hpp"

#include <map>
#include <vector>

#include "fuzz.hpp"
#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/text/arithmetic.hpp"

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

/// Each element and attribute is on the line of the file that the map says.
void check_lines(const Expansion& expansion, const Markup& markup, const Files& files) {
  std::map<std::string, std::vector<std::string_view>> lines;
  for (const auto& [name, text] : files) lines[name] = parts_between(text, "\n");
  LineCounter counter(expansion.text);
  const auto check = [&](std::uint32_t offset, std::string_view name) {
    const ScenePlace place = expansion.files.place_of(counter.line_of(offset));
    const auto& own = lines.at(fs::path(place.file).lexically_normal().string());
    require(place.line >= 1 && static_cast<std::size_t>(place.line) <= own.size());
    require(own[static_cast<std::size_t>(place.line) - 1].find(name) != std::string_view::npos);
    require(place.chain.empty() == (place.file == "a.xml"));
  };
  for (std::size_t k = 0; k < markup.elements.size(); ++k) {
    const std::string_view name = markup.elements[k].name.of(expansion.text);
    require(name != "define" && (name != "include" || !expansion.is_sound));
    check(markup.elements[k].name.begin, name);
    for (const AttributePlace& attribute : markup.attributes_of(k))
      check(attribute.name.begin, attribute.name.of(expansion.text));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view input = text_of(bytes, size);
  if (const auto numbers = numbers_of(input); numbers && numbers->has_value())
    for (const double number : **numbers) require(number - number == 0);  // finite

  const Files files = files_of(input);
  const std::string& text = files.at("a.xml");
  Findings findings("a.xml");
  const auto fails = [&] { check_error(findings.to_error(), std::size_t{20'000}); };
  const auto markup = scan_markup(text, findings);
  if (!markup) return fails(), 0;
  const SourceText scene{text, *markup, "a.xml", ""};
  const bool is_needed = needs_expansion(scene, findings);
  const auto expansion = expand(scene, in_memory(files), findings);
  if (!expansion) return fails(), 0;
  require((findings.problem_count() == 0) == expansion->is_sound);
  for (const std::size_t at : expansion->unknown) require(expansion->text[at] == '?');
  if (!is_needed) require(expansion->text == text);
  findings.use(expansion->files);
  const auto expanded = scan_markup(expansion->text, findings);
  if (!expanded) return fails(), 0;
  check_lines(*expansion, *expanded, files);
  const auto read = parse_scene_of(text, "a.xml", "", "", in_memory(files));
  if (!read) check_error(read.error(), 20'000);
  require(!read || expansion->is_sound);
  return 0;
}
