#include "pliant/scene/text/markup.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/files/read_file.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/text/tree.hpp"
#include "pliant/scene/write.hpp"
#include "scene/scene_text.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"
#include "support/tree_check.hpp"

namespace pliant::testing {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

TEST_CASE("each malformed document is told in one line", "[scene][markup]") {
  const std::string root = "<scene start=\"1\" end=\"2\">\n";
  check_each({
      {"", 1, {"the file is empty", "<scene>"}},
      {" \n\n ", 1, {"the file is empty"}},
      {"\xEF\xBB\xBF", 1, {"the file is empty"}},
      {"<?xml version=\"1.0\"?>\n", 2, {"contains no element", "<scene>"}},
      {"<!-- only a comment -->", 1, {"contains no element"}},
      {"just text", 1, {"there is text before the <scene>; a scene file must contain one <scene>"}},
      {"<html>\n<p class=secret>", 2, {"malformed XML, and the root element is not <scene>"}},
      {root + "</scene>\n\nmore", 4, {"the text \"more\" is outside"}},
      {root + "</scene>\n<scene/>", 3, {"<scene> is outside the root element"}},
      {root + "</scene>\n</scene>", 3, {"</scene> has no opening tag"}},
      {root + "<point name=\"a\">\n</scene>",
       3,
       {"</scene>", "comes before <point> of line 2", "is closed"}},
      {root + "<point name=\"a\">\n", 3, {"ends inside <point> of line 2, which is not closed"}},
      {root + "<point name=\"a\"\n", 3, {"ends inside the tag <point> of line 2"}},
      {root + "<point name", 2, {"ends inside the tag <point>"}},
      {root + "<point name=\"a", 2, {"ends inside the value of \"name\" in <point> of line 2"}},
      {root + "<!-- never closed\n", 3, {"ends inside a comment that begins at line 2"}},
      {root + "<![CDATA[ x ", 2, {"ends inside a CDATA section"}},
      {root + "</scene", 2, {"ends inside a closing tag"}},
      {root + "</scene x>", 2, {"a closing tag must be </name>"}},
      {root + "<point name=a/></scene>", 2, {"\"name\" in <point> is not in quotes"}},
      {root + "<point name/></scene>", 2, {"\"name\" of <point> has no value"}},
      {root + "<point name=\"a\"center=\"0 0 0\"/></scene>",
       2,
       {"a space is missing after", "name"}},
      {root + "<point name=\"a center=\"0 0 0\"/></scene>", 2, {"in <point> is not an attribute"}},
      {root + "<point name=\"a/>\n<point name=\"b\"/></scene>",
       2,
       {"\"name\" in <point> has no closing quote"}},
      {root + "<point\n name=\"a\"\n name=\"b\"/></scene>",
       4,
       {"<point> has the attribute \"name\" twice"}},
      {root + "<1/></scene>", 2, {"\"<1\" does not begin a tag"}},
      {root + "< point/></scene>", 2, {"does not begin a tag"}},
      {root + "<point name=\"&foo;\"/></scene>", 2, {"\"&foo;\" is not a known entity"}},
      {root + "<point name=\"a\n&foo;\"/></scene>", 3, {"\"&foo;\" is not a known entity"}},
      {root + "<point name=\"a & b\"/></scene>", 2, {"does not begin an entity", "&amp;"}},
      {root + "<point name=\"&#0;\"/></scene>", 2, {"\"&#0;\" is not a known entity"}},
      {root + "<point name=\"&#xD800;\"/></scene>", 2, {"not a known entity"}},
      {root + "<point name=\"&#x110000;\"/></scene>", 2, {"not a known entity"}},
      {root + "&foo;</scene>", 2, {"\"&foo;\" is not a known entity"}},
      {"<!DOCTYPE scene [<!ENTITY x \"1\">]>\n" + root + "</scene>",
       1,
       {"DOCTYPE", "not supported"}},
      {root + "<!DOCTYPE scene></scene>", 2, {"DOCTYPE is allowed only before the <scene>"}},
      {root + "<!ENTITY x \"1\"></scene>", 2, {"does not begin a tag"}},
      {root + "<?pi?></scene>", 2, {"must come before everything else"}},
      {"<!-- x -->\n<?xml version=\"1.0\"?>" + root + "</scene>",
       2,
       {"must come before everything else"}},
      {"<?xml version=\"1.0\" encoding=\"latin1\"?>" + root + "</scene>",
       1,
       {"\"latin1\"", "UTF-8"}},
      {root + "<point name=\"\xE4\"/></scene>", 2, {"the byte 0xE4 is not UTF-8"}},
      {root + "\n<point name=\"a\0b\"/></scene>"s, 3, {"a NUL byte"}},
      {root + "<point name=\"\x01\"/></scene>", 2, {"the control character 0x01"}},
      {"\xFF\xFE<\0s\0"s, 1, {"UTF-16"}},
      {"<scen/>", 1, {"the root element is <scen>", "did you mean \"scene\"?"}},
      {"<html><body/></html>", 1, {"the root element is not <scene>"}},
      {"<secret/>", 1, {"the root element is not <scene>"}},
      {"<?xml version=\"1.0\" encoding=\"secret\"?><scene/>", 1, {"the encoding is not supported"}},
  });
}

TEST_CASE("UTF-8 of every length is sound", "[scene][markup]") {
  for (const std::string_view text :
       {""sv, "plain\t\r\n"sv, "ä€😀"sv, "\xC2\x80"sv, "\xDF\xBF"sv, "\xE0\xA0\x80"sv,
        "\xED\x9F\xBF"sv, "\xEE\x80\x80"sv, "\xF0\x90\x80\x80"sv, "\xF4\x8F\xBF\xBF"sv}) {
    CAPTURE(text);
    CHECK(problems_of(scene_with("<!--" + std::string(text) + "-->")).empty());
  }
}

TEST_CASE("the first byte that is no UTF-8 or no XML is told", "[scene][markup]") {
  for (const std::string_view bad :
       {"\0"sv, "\x01"sv, "\x1F"sv, "\x80"sv, "\xBF"sv, "\xC0\x80"sv, "\xC1\xBF"sv, "\xC3"sv,
        "\xC3("sv, "\xE0\x9F\xBF"sv, "\xE2\x82"sv, "\xED\xA0\x80"sv, "\xF0\x8F\xBF\xBF"sv,
        "\xF0\x9F\x98"sv, "\xF4\x90\x80\x80"sv, "\xF5\x80\x80\x80"sv, "\xFF"sv}) {
    const auto byte = static_cast<unsigned char>(bad[0]);
    const std::string told = byte == 0     ? "a NUL byte"
                             : byte < 0x20 ? fmt::format("the control character 0x{:02X}", byte)
                                           : fmt::format("the byte 0x{:02X} is not UTF-8", byte);
    check_each({{"<scene>\n<!-- ä" + std::string(bad) + "\n\xFE\x02 -->", 2, {told}},
                {"<scene>\n\n" + std::string(bad), 3, {told}}});
  }
}

TEST_CASE("what XML allows around a scene is read over", "[scene][markup]") {
  const std::string scene = "<scene start=\"1\" end=\"2\"><!-- <x> & -- --></scene>";
  for (const std::string& text :
       {scene, "\xEF\xBB\xBF" + scene, "\n  " + scene + "\n<!-- end -->\n",
        "<?xml version=\"1.0\" encoding=\"utf-8\" standalone=\"yes\"?>\r\n" + scene,
        "<?xml version='1.0'?><?xml-stylesheet href=\"a.css\"?><!DOCTYPE scene SYSTEM \"s.dtd\">" +
            scene,
        "<scene\tstart = '1'\r\n end\n=\n\"2\"\n></scene\n>"s}) {
    CAPTURE(text);
    CHECK(problems_of(text).empty());
  }
}

TEST_CASE("references to characters are read", "[scene][markup]") {
  const Scene scene = scene_of(force_with("").replace(
      force_with("").find("name=\"poke\""), 11, "name=\"&#112;&#x6f;ke\" magnitude='&#49;0'"));
  CHECK(scene.forces.at(0).name == "poke");
  CHECK(scene.forces.at(0).magnitude.at(1)[0] == 10);
}

TEST_CASE("all malformed values of a well-nested document are told in one run", "[scene][markup]") {
  const std::vector<std::string> problems =
      problems_of("<scene start=\"&a;\"\n end=\"&b;\"\n end=\"3\"/>");
  REQUIRE(problems.size() == 3);
  CHECK_THAT(problems[0], contains_text("1: malformed XML: \"&a;\""));
  CHECK_THAT(problems[1], contains_text("2: malformed XML: \"&b;\""));
  CHECK_THAT(problems[2], contains_text("3: malformed XML: <scene> has the attribute"));
}

TEST_CASE("of a file that is no scene nothing is quoted", "[scene][markup]") {
  for (const std::string text :
       {"root:secret:0:0", "\n\nsecret <scene/>", "</secret>", "<secret>", "<html><secret></html>",
        "<html secret=x secret=\"1\">&secret;</html>", "<x>&secret;&secret;"}) {
    const std::vector<std::string> problems = problems_of(text);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].find("ecret") == std::string::npos);
  }
}

TEST_CASE("sizes that would take gigabytes or hours are refused early", "[scene][markup]") {
  const auto repeated = [](std::string_view text, int count) {
    std::string result;
    for (int k = 0; k < count; ++k) result += text;
    return result;
  };
  CHECK(problems_of("<scene>" + repeated("<a>", rounds(100'000))) ==
        std::vector<std::string>{"1: malformed XML: <a> is nested deeper than 50 elements"});
  std::string many = "<scene";
  for (int k = 0; k < rounds(100'000); ++k) many += " a" + std::to_string(k) + "=\"\"";
  CHECK(problems_of(many + "/>") ==
        std::vector<std::string>{"1: malformed XML: <scene> has more than 100 attributes"});
  CHECK_THAT(problems_of("<" + std::string(1'000'000, 'a') + "/>").at(0),
             contains_text("has more than 100 bytes"));
  CHECK_THAT(problems_of("<scene start=\"" + std::string(1'000'000, '9') + "\" end=\"1\"/>").at(0),
             contains_text("outside the range"));
  CHECK(problems_of(scene_with(repeated("<a/>", rounds(30'000)))).size() < 20'000);
}

TEST_CASE("elements and attributes are counted against one limit", "[scene][markup]") {
  const auto problem_of = [](std::string_view text, std::size_t most) {
    xml::Findings findings("plate.xml", SourceText::of(text));
    const bool is_sound = xml::scan_markup(findings, 0, most).has_value();
    return is_sound ? "" : to_lines(findings.to_error()).at(0);
  };
  const std::string_view elements = "<scene>\n<a/><b>\n</b><c/></scene>";
  CHECK(problem_of(elements, 4) == "");
  CHECK(problem_of(elements, 3) ==
        "plate.xml:3: error: malformed XML: the file has more than 3 elements and attributes");
  const std::string_view attributes = "<scene a=''\n b=''>\n<c/></scene>";
  CHECK(problem_of(attributes, 4) == "");
  CHECK_THAT(problem_of(attributes, 3), contains_text("has more than 3"));
  CHECK_THAT(problem_of(attributes, 2), contains_text("plate.xml:2: "));
}

TEST_CASE("every truncated prefix of a scene is an error with a line", "[scene][markup]") {
  REQUIRE(problems_of(rich_scene).empty());
  const std::size_t whole = rich_scene.find_last_of('>') + 1;  // only a line feed follows
  for (std::size_t length = 0; length < whole; ++length) {
    const Result<Scene> scene = read(rich_scene.substr(0, length));
    if (scene || scene.error().line < 1 || scene.error().message.empty()) {
      CAPTURE(length);
      FAIL("a prefix was read, or told without a line");
    }
  }
}

TEST_CASE("no mutation of a scene crashes the reader", "[scene][markup]") {
  // A fixed seed, so that a crash can be reproduced. Bytes are flipped, removed, doubled, or
  // replaced by characters with a meaning in XML or numbers.
  std::mt19937 random(20'050'613);
  const auto below = [&](std::size_t count) { return random() % count; };
  constexpr std::string_view telling = "<>\"'&;=/!?-.,+eE0123456789 \n\t#xX:ax\xC3\x00\xFF";
  int sound = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string text(rich_scene);
    for (std::size_t count = 1 + below(4); count > 0; --count) {
      const std::size_t at = below(text.size());
      switch (below(5)) {
        case 0:
          text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
          break;
        case 1:
          text.erase(at, 1 + below(20));
          break;
        case 2:
          text.insert(at, text.substr(below(text.size()), 1 + below(40)));
          break;
        case 3:
          text[at] = telling[below(telling.size())];
          break;
        default:
          text.insert(at, 1, telling[below(telling.size())]);
          break;
      }
    }
    const Result<Scene> scene = read(text);
    sound += scene ? 1 : 0;
    if (!scene && scene.error().message.empty()) FAIL(text);
  }
  CHECK(sound > 0);  // some only change a value or a comment
}

/// Everything that is difficult to find one's way in: markup within comments, CDATA and values,
/// both quotes, blanks wherever they may be, line ends of both kinds.
const std::vector<std::string> difficult_texts = {
    "<scene/>",
    "<scene></scene>",
    "<scene a=''/>",
    "<scene a=\"\" b='&#x20AC;'/>",
    "\xEF\xBB\xBF<?xml version=\"1.0\" encoding='utf-8'?>\r\n<?style href=\"a.css\"?>\r\n"
    "<!DOCTYPE scene SYSTEM \"s.dtd\">\r\n<!-- <scene start=\"0\"> -->\r\n"
    "<scene\r\n  start = '1'\r\n\tend\r\n=\r\n\"2\"\r\n\r\n>\r\n</scene\r\n>\r\n<!-- end -->\r\n",
    "<scene>\n<!-- <a b=\"1\"/> & \" ' -- -->\n<![CDATA[</scene> <a b='1'> ]] >\n]]><a><b/></a  >"
    "<c d=\"/>\" e='\"' f=\"'\"\n/>text > \"quoted\" a='1' &lt;a b='1'/&gt;<c\n></c></scene>",
    "<scene a=\"x='1' y='2'\" b='&lt;b c=&quot;&apos;&#34;&#x22;&gt;' "
    "c=\"two\nlines\r\nthree\rfour\"\n"
    " d='--&gt;>]]>'\n><é:ü-1. ñ_=\"ä€😀&#x1F600;&#228;\"/>\n</scene>",
};

/// A random element with attributes, text, comments, CDATA sections and elements in it.
class RandomMarkup {
 public:
  explicit RandomMarkup(unsigned seed) : random_(seed) {}

  std::string text() {
    text_ = pick({"", "\xEF\xBB\xBF"});
    text_ += pick({"", "<?xml version='1.0'?>", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"});
    text_ += pick({"", "\n", "<!DOCTYPE scene>\r\n", "<!-- <a> -->", "\n\n  "});
    add_element("scene", 5);
    return text_ + pick({"", "\n", "<!-- </scene> -->", "\r\n\r\n"});
  }

 private:
  std::size_t below(std::size_t count) { return random_() % count; }
  std::string pick(const std::vector<std::string>& choices) {
    return choices[below(choices.size())];
  }
  std::string blanks() { return pick({"", "", " ", "\n", "\r\n", "\t ", " \n\n"}); }

  void add_attribute(std::size_t number) {
    text_ += pick({" ", "\n", "\r\n\t", "  \n"});
    text_ += pick({"a", "in", "ä", "x:y", "_", "to-1."}) + std::to_string(number);
    text_ += blanks() + "=" + blanks();
    const std::string quote = pick({"\"", "'"});
    text_ += quote;
    for (std::size_t count = below(5); count > 0; --count)
      text_ += pick({"1", "-2.5e3 ", "&amp;", "&lt;", "&#65;", "&#x20AC;", "&apos;&quot;", "ä€😀",
                     "\n", "\r\n", ">", "/>", "=", "--", "a=", quote == "'" ? "\"" : "'"});
    text_ += quote;
  }

  void add_element(const std::string& name, std::size_t deepest) {
    text_ += '<' + name;
    for (std::size_t number = 0, count = below(5); number < count; ++number) add_attribute(number);
    text_ += blanks();
    if (below(3) == 0) {
      text_ += "/>";
      return;
    }
    text_ += '>';
    for (std::size_t count = below(6); count > 0; --count) {
      text_ += pick({"", "", "\n  ", "text", " a='1' ", "&amp;>", "\r\n", "<!-- <a b='c'> & -- -->",
                     "<![CDATA[</a> <b c=\"d\">]]>"});
      if (deepest > 0 && below(2) == 0)
        add_element(pick({"key", "point", "a", "é", "n:s"}), deepest - 1);
    }
    text_ += "</" + name + blanks() + '>';
  }

  std::mt19937 random_;
  std::string text_;
};

TEST_CASE("every element and attribute stands where tinyxml2 finds it", "[scene][markup]") {
  for (const std::string& text : difficult_texts) {
    CAPTURE(text);
    CHECK(PlaceCheck(text).find() == "");
  }
  CHECK(PlaceCheck(std::string(rich_scene)).find() == "");
  int deep = 0;
  for (int seed = 0; seed < rounds(2000); ++seed) {
    const std::string text = RandomMarkup(seed).text();
    CAPTURE(seed, text);
    REQUIRE(PlaceCheck(text).find() == "");
    deep += places_of(text)->elements.size() > 20 ? 1 : 0;
  }
  CHECK(deep > 0);
}

TEST_CASE("scenes of files and written ones stand where tinyxml2 finds them", "[scene][markup]") {
  for (const char* folder : {"examples", "examples/thesis", "tests/reference/scenes"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(testing::source_folder() / folder)) {
      if (entry.path().extension() != ".xml") continue;
      CAPTURE(entry.path().string());
      CHECK(PlaceCheck(read_file(entry.path().string(), 1U << 20U).value()).find() == "");
      const Scene scene = load_scene(entry.path().string()).value();
      CHECK(PlaceCheck(to_xml(scene).value()).find() == "");
    }
  }
  std::mt19937 random(20'050'613);
  for (int round = 0; round < rounds(100); ++round) {
    Scene written = scene({}, {});
    for (std::size_t count = random() % 4; count > 0; --count)
      written.surfaces.push_back(sheet(fmt::format("s{}", count)));
    for (std::size_t count = random() % 4; count > 0; --count) {
      Force force = poke(fmt::format("f{}", count), {0, 0, 0});
      std::vector<std::pair<double, double>> keys;
      for (std::size_t key = 0, last = random() % 9; key <= last; ++key)
        keys.emplace_back(key, 1e-3 * static_cast<double>(random()));
      if (random() % 2 == 0) force.magnitude = curve(keys);
      written.forces.push_back(std::move(force));
    }
    const std::string text = to_xml(written).value();
    CAPTURE(text);
    CHECK(PlaceCheck(text).find() == "");
  }
}

/// What a text says, one entry for each element, attribute and text.
std::vector<std::string> content_of(const std::string& text) {
  tinyxml2::XMLDocument document;
  REQUIRE(document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS);
  std::vector<std::string> content;
  const std::function<void(const tinyxml2::XMLNode&)> add = [&](const tinyxml2::XMLNode& node) {
    content.emplace_back(node.Value() ? node.Value() : "");
    if (const auto* element = node.ToElement())
      for (const auto* given = element->FirstAttribute(); given; given = given->Next())
        content.push_back(fmt::format("{}={}", given->Name(), given->Value()));
    for (const auto* child = node.FirstChild(); child; child = child->NextSibling()) add(*child);
    content.emplace_back("end");
  };
  add(document);
  return content;
}

TEST_CASE("a value replaced at its place changes this attribute alone", "[scene][markup]") {
  std::vector<std::string> texts = difficult_texts;
  texts.emplace_back(rich_scene);
  for (int seed = 0; seed < rounds(50); ++seed) texts.push_back(RandomMarkup(seed).text());
  for (const std::string& text : texts) {
    CAPTURE(text);
    const std::vector<std::string> before = content_of(text);
    const std::optional<xml::Markup> places = places_of(text);
    REQUIRE(places);
    for (const xml::AttributePlace& place : places->attributes) {
      const auto [begin, end] = place.value;
      const std::string changed = std::string(text).replace(begin, end - begin, "a new &#118;alue");
      const std::vector<std::string> after = content_of(changed);
      REQUIRE(after.size() == before.size());
      const auto [was, is] = std::mismatch(before.begin(), before.end(), after.begin());
      REQUIRE(is != after.end());
      CHECK(*is == fmt::format("{}=a new value", place.name.of(text)));
      CHECK(*was == fmt::format("{}={}", place.name.of(text), decoded(place.value.of(text))));
      CHECK(std::equal(was + 1, before.end(), is + 1));
    }
  }
}

TEST_CASE("every truncated prefix of a difficult text is a problem", "[scene][markup]") {
  for (const std::string& text : difficult_texts) {
    const std::size_t whole = places_of(text).value().elements.at(0).end;
    for (std::size_t length = 0; length < whole; ++length) {
      CAPTURE(text, length);
      if (places_of(text.substr(0, length))) FAIL("a prefix is sound");
    }
    CHECK(places_of(text.substr(0, whole)));
  }
}

}  // namespace
}  // namespace pliant::testing
