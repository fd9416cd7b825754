#include "pliant/scene/text/source_map.hpp"

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace pliant::testing {
namespace {

TextRange range_in(std::string_view text, std::string_view part) {
  const auto begin = static_cast<std::uint32_t>(text.find(part));
  return {begin, begin + static_cast<std::uint32_t>(part.size())};
}

TEST_CASE("a span counts lines, and UTF-16 units in them", "[scene][sources]") {
  const std::string text =
      "\xEF\xBB\xBF<a>\r\n<b x='\xC3\xA4' y='\xF0\x9F\x98\x80'/>\n<!-- 1\n2 -->\n";
  const SourceText source(text);
  const auto span = [&](std::string_view part) { return source.span_of(range_in(text, part)); };
  CHECK(span("<a>") == TextSpan{1, 1, 1, 4});
  CHECK(span("<b") == TextSpan{2, 1, 2, 3});
  CHECK(span("x=") == TextSpan{2, 4, 2, 6});
  CHECK(span("y=") == TextSpan{2, 10, 2, 12});
  CHECK(span("/>") == TextSpan{2, 16, 2, 18});
  CHECK(span("1\n2") == TextSpan{3, 6, 4, 2});
  const auto size = static_cast<std::uint32_t>(text.size());
  CHECK(source.span_of({size, size}) == TextSpan{5, 1, 5, 1});
}

TEST_CASE("spans are those of counting from the begin", "[scene][sources]") {
  std::mt19937 random(7);
  constexpr std::string_view letters[] = {"a", "\n", "\xC3\xA4", "\xE2\x82\xAC",
                                          "\xF0\x9F\x98\x80"};
  std::string text;
  std::vector<std::uint32_t> begins;
  std::vector<std::pair<int, int>> positions;
  int line = 1, column = 1;
  while (text.size() < 20'000) {
    begins.push_back(static_cast<std::uint32_t>(text.size()));
    positions.emplace_back(line, column);
    const std::string_view letter = letters[random() % 40 == 0 ? 1 : random() % 5];
    text += letter;
    column += letter.size() == 4 ? 2 : 1;
    if (letter == "\n") ++line, column = 1;
  }
  const SourceText source(text);
  for (std::size_t k = 1; k < begins.size(); ++k) {
    const TextSpan span = source.span_of({begins[k - 1], begins[k]});
    const auto [from, from_column] = positions[k - 1];
    const auto [to, to_column] = positions[k];
    REQUIRE(span == TextSpan{from, from_column, to, to_column});
  }
}

/// shot.xml includes rig.xml at line 2, and that hand.xml at line 3; then shot.xml goes on.
struct Included {
  Included() {
    place_of_rig = {0, range_in(shot, "<rig/>")};
    rig_at = map.add("rig.xml", place_of_rig);
    map.set_text(rig_at, std::make_shared<SourceText>(rig));
    hand_at = map.add("hand.xml", {rig_at, range_in(rig, "<hand/>")});
    map.set_text(hand_at, std::make_shared<SourceText>(hand));
  }

  const std::string shot = "<shot>\n<rig/>\n<end/>", rig = "<r>\n\n<hand/></r>", hand = "<h/>";
  SourceMap map{"shot.xml", std::make_shared<SourceText>(shot)};
  TextPlace place_of_rig;
  int rig_at = 0, hand_at = 0;
};

TEST_CASE("a place is told in its file, with the chain of includes", "[scene][sources]") {
  Included shot;
  const TextPlace end{0, range_in(shot.shot, "<end/>")};
  const TextPlace inner{shot.hand_at, {0, 4}};
  const ScenePlace own = shot.map.place_of(end);
  CHECK((own.file == "shot.xml" && own.line == 3 && own.chain.empty()));
  const ScenePlace place = shot.map.place_of(inner);
  CHECK((place.file == "hand.xml" && place.line == 1 && place.end_column == 5));
  CHECK(place.chain == "included by rig.xml:3, by shot.xml:2");
  CHECK(place.told("it is wrong") == "it is wrong; included by rig.xml:3, by shot.xml:2");
  CHECK(shot.map.title_of(inner, inner) == "line 1");
  CHECK(shot.map.title_of(inner, end) ==
        "line 1 of hand.xml, included by rig.xml:3, by shot.xml:2");
  CHECK(shot.map.title_of(end, inner) == "line 3 of shot.xml");
  // What an include leads to stands in its place.
  CHECK((shot.map.is_before(shot.place_of_rig, inner) && shot.map.is_before(inner, end)));
  CHECK_FALSE((shot.map.is_before(end, inner) || shot.map.is_before(end, end)));
  // A file that cannot be read has no lines.
  const int none = shot.map.add("none.xml", end);
  CHECK(shot.map.place_of({none}).line == 0);
  CHECK(shot.map.place_of({}).file == "shot.xml");
  shot.map.rename("other.xml");
  CHECK(shot.map.place_of(place.file.empty() ? end : inner).chain ==
        "included by rig.xml:3, by other.xml:2");
}

TEST_CASE("file names are printable in chains and titles", "[scene][sources]") {
  SourceMap map("a\nb.xml", std::make_shared<SourceText>("<a/>"));
  const int inner = map.add("c\td.xml", {0, {0, 4}});
  map.set_text(inner, std::make_shared<SourceText>("<c/>"));
  CHECK(map.place_of({inner}).chain == "included by a\\x0ab.xml:1");
  CHECK(map.title_of({inner}, {0}) == "line 1 of c\\x09d.xml, included by a\\x0ab.xml:1");
}

TEST_CASE("an error at a value tells the definitions that it was made of", "[scene][sources]") {
  Included shot;
  const TextPlace value{0, range_in(shot.shot, "end")};
  const auto w = shot.map.add_definition("w", {0, range_in(shot.shot, "<shot>")});
  const auto h = shot.map.add_definition("h", {shot.hand_at, {0, 4}});
  shot.map.add_value(value, {w, h});
  const Error error = shot.map.located({.message = "is wrong"}, value);
  CHECK(error.message ==
        "is wrong; $w is defined at line 1; $h is defined at line 1 of hand.xml, included by "
        "rig.xml:3, by shot.xml:2");
  CHECK((error.file == "shot.xml" && error.line == 3 && error.column == 2));
  // Also one at the whole attribute, but none beside it.
  CHECK(shot.map.located({.message = "m"}, {0, range_in(shot.shot, "<end/>")}).message != "m");
  CHECK(shot.map.located({.message = "m"}, shot.place_of_rig).message == "m");
  CHECK(shot.map.located({.message = "m"}, {}).message == "m");
}

TEST_CASE("definitions and values beyond a number are not told", "[scene][sources]") {
  SourceMap map("a.xml", std::make_shared<SourceText>("<a/>"));
  std::uint32_t last = 0;
  for (std::size_t k = 0; k <= SourceMap::most_kept; ++k) last = map.add_definition("w", {0});
  CHECK(map.told(std::vector{last}, {0}).empty());
  CHECK(map.told(std::vector{last - 1}, {0}) == "; $w is defined at line 1");
  CHECK(map.told(std::vector{0U, 1U, 2U, 3U}, {0}).size() ==
        3 * std::string("; $w is defined at line 1").size());
}

}  // namespace
}  // namespace pliant::testing
