#include "pliant/document/format_scene.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <tinyxml2.h>

#include "pliant/files/read_file.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/random_scene.hpp"
#include "support/sanitized.hpp"
#include "support/scene_values.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a line of very many comments is laid out", "[document][format]") {
  std::string comments;
  for (int k = 0; k < 300'000; ++k) comments += "<!---->";
  const std::string text = "<scene version=\"1\" start=\"1\" end=\"2\">" + comments + "</scene>";
  const auto result = format_scene(text, "shot.xml");
  REQUIRE(result);
  CHECK(std::count(result->begin(), result->end(), '!') == 300'000);
}

std::string formatted(const std::string& text) {
  const auto result = format_scene(text, "shot.xml");
  REQUIRE(result);
  return *result;
}

/// The comments of a text without their blanks, and the names and values of its attributes: all
/// that a layout must keep, in its order.
std::vector<std::string> kept(const std::string& text) {
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS);
  std::vector<std::string> all;
  const std::function<void(const tinyxml2::XMLNode&)> add = [&](const tinyxml2::XMLNode& node) {
    std::string value = node.Value() ? node.Value() : "";
    std::erase_if(value, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
    all.push_back(value);
    if (const auto* element = node.ToElement())
      for (const auto* given = element->FirstAttribute(); given; given = given->Next())
        all.push_back(std::string(given->Name()) + '=' + given->Value());
    for (const auto* child = node.FirstChild(); child; child = child->NextSibling()) add(*child);
    all.emplace_back("end");
  };
  add(document);
  return all;
}

/// What is wrong with the layout of a text; empty: nothing.
std::string fault_of(const std::string& text, const std::string& folder = "") {
  const std::string once = formatted(text);
  if (formatted(once) != once) return "it is not idempotent";
  if (kept(once) != kept(text)) return "something is lost";
  const auto before = parse_scene(text, "shot.xml", folder);
  const auto after = parse_scene(once, "shot.xml", folder);
  if (!before || !after) return "it cannot be read";
  if (SceneValues(*before) != SceneValues(*after)) return "the scene is another";
  std::istringstream lines(once);
  bool was_blank = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_blank = line.find_first_not_of("\r") == std::string::npos;
    if (is_blank && was_blank) return "two blank lines";
    was_blank = is_blank;
  }
  return "";
}

TEST_CASE("a canonical layout", "[document][format]") {
  const std::string text =
      "<?xml version='1.0'?><!-- a shot -->\n\n\n"
      "<scene end='4' version = \"1\"   start='1'><surface name=\"s\"><grid columns='5' rows='4' "
      "></grid>"
      "<mesh file='a \"b\" &amp; c.obj'/></surface>\n\n\n\n"
      "\t\t<!-- two\n\t\t   lines -->\n"
      "\t<point name='a'\n\t\tmagnitude='1.50'>   <!-- behind -->\n\n"
      "<animate attribute='magnitude'><key frame='1' value='0'/> <!-- one --> <key frame='2' "
      "value='1'/></animate></point><radial name='a_rather_long_name' center='1.000 2.000 3.000' "
      "deformationRadius='2.50' forceRadius='1.0' magnitude='20' targets='s'/></scene>";
  CHECK(formatted(text) ==
        "<?xml version='1.0'?> <!-- a shot -->\n"
        "\n"
        "<scene end=\"4\" version=\"1\" start=\"1\">\n"
        "  <surface name=\"s\">\n"
        "    <grid columns=\"5\" rows=\"4\"/>\n"
        "    <mesh file=\"a &quot;b&quot; &amp; c.obj\"/>\n"
        "  </surface>\n"
        "\n"
        "  <!-- two\n"
        "     lines -->\n"
        "  <point name=\"a\" magnitude=\"1.50\"> <!-- behind -->\n"
        "    <animate attribute=\"magnitude\">\n"
        "      <key frame=\"1\" value=\"0\"/> <!-- one -->\n"
        "      <key frame=\"2\" value=\"1\"/>\n"
        "    </animate>\n"
        "  </point>\n"
        "  <radial name=\"a_rather_long_name\" center=\"1.000 2.000 3.000\" "
        "deformationRadius=\"2.50\"\n"
        "      forceRadius=\"1.0\" magnitude=\"20\" targets=\"s\"/>\n"
        "</scene>\n");
  CHECK(formatted("\xEF\xBB\xBF<scene version='1' start='1'\r\n end='2'/>\n\n") ==
        "\xEF\xBB\xBF<scene version=\"1\" start=\"1\" end=\"2\"/>\r\n");
  CHECK_FALSE(format_scene("<scene>", "shot.xml"));
}

// `<?>` begins a declaration that goes on to the next `?>`, as `<!-->` begins a comment.
TEST_CASE("a layout takes marks whose beginnings look like ends", "[document][format]") {
  const std::string scene = "<scene version=\"1\" start=\"1\" end=\"1\"/>\n";
  for (const std::string mark : {"<?><![CDATA[<scene ?>", "<?><!-- ?>", "<!--><?-->", "<?>?>"}) {
    CAPTURE(mark);
    REQUIRE(parse_scene(mark + scene, "shot.xml", "."));
    const std::string laid_out = formatted(mark + scene);
    CHECK(laid_out == mark + "\n" + scene);
    CHECK(formatted(laid_out) == laid_out);
  }
}

TEST_CASE("a layout keeps the scene and is kept", "[document][format]") {
  for (int seed = 0; seed < rounds(1500); ++seed) {
    const std::string text = RandomScene(seed).text();
    CAPTURE(seed, text, formatted(text));
    if (const std::string fault = fault_of(text); !fault.empty()) FAIL(fault);
  }
}

TEST_CASE("the examples are laid out so that they stay the same", "[document][format]") {
  for (const char* const folder : {"examples", "examples/thesis", "tests/reference/scenes"}) {
    int count = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(testing::source_folder() / folder)) {
      if (entry.path().extension() != ".xml") continue;
      CAPTURE(entry.path().string());
      const std::string text = read_file(entry.path()).value();
      CHECK(fault_of(text, entry.path().parent_path().string()) == "");
      ++count;
    }
    CHECK(count > 3);
  }
}

TEST_CASE("a layout that could not be read again is refused", "[document][format]") {
  // Each line of the comment gets the indentation of its element, on the deepest level.
  std::string text = "<scene>\n";
  for (int depth = 0; depth < 45; ++depth) text += "<a>";
  text += "\n <!--";
  while (text.size() < std::size_t{10} << 20U) text += "\n -";
  text += " -->";
  for (int depth = 0; depth < 45; ++depth) text += "</a>";
  text += "</scene>";
  const auto formatted = format_scene(text, "a.xml");
  REQUIRE_FALSE(formatted);
  CHECK(formatted.error().code == ErrorCode::InvalidInput);
  CHECK(formatted.error().message == "the scene would be larger than 256 MiB");
  CHECK(formatted.error().file == "a.xml");
}

}  // namespace
}  // namespace pliant::testing
