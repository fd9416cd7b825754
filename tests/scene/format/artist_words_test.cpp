#include "pliant/scene/format/artist_words.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/text/text.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

/// The format of an element; null: there is none.
const ElementFormat* element_named(const std::vector<ElementFormat>& formats,
                                   std::string_view name) {
  const auto found = std::find_if(formats.begin(), formats.end(),
                                  [&](const ElementFormat& format) { return format.name == name; });
  return found != formats.end() ? &*found : nullptr;
}

bool has_attribute(const ElementFormat& element, std::string_view name) {
  return std::any_of(element.attributes.begin(), element.attributes.end(),
                     [&](const auto& attribute) {
                       return attribute.name == name && attribute.need != Need::Later;
                     });
}

TEST_CASE("artists' words lead to attributes that the format has", "[scene][artist_words]") {
  const std::vector<ElementFormat> formats = scene_format();
  for (const xml::ArtistWords& row : xml::artist_words()) {
    CAPTURE(row.elements, row.words, row.meant);
    CHECK(std::none_of(row.words.begin(), row.words.end(), [](unsigned char c) {
      return std::isupper(c) != 0 || c == '_' || c == '-';
    }));
    for (const std::string_view name : xml::words_of(row.elements)) {
      const ElementFormat* const element = element_named(formats, name);
      REQUIRE(element);
      for (const std::string_view meant : xml::words_of(row.meant)) {
        CAPTURE(name, meant);
        const std::size_t at = meant.find('@');
        if (at == std::string_view::npos) {
          CHECK(has_attribute(*element, meant));
          continue;
        }
        const ElementFormat* const other = element_named(formats, meant.substr(at + 1));
        REQUIRE(other);
        CHECK(has_attribute(*other, meant.substr(0, at)));
        // In the element, or beside it.
        const auto& parents = other->parents;
        CHECK(std::any_of(parents.begin(), parents.end(), [&](std::string_view parent) {
          return parent == name || std::find(element->parents.begin(), element->parents.end(),
                                             parent) != element->parents.end();
        }));
      }
      for (const std::string_view word : xml::words_of(row.words)) {
        CAPTURE(name, word);
        CHECK_FALSE(has_attribute(*element, word));  // it would not be asked for
        const bool is_first =
            &*std::find_if(
                xml::artist_words().begin(), xml::artist_words().end(), [&](const auto& other) {
                  const auto elements = xml::words_of(other.elements),
                             words = xml::words_of(other.words);
                  return std::find(elements.begin(), elements.end(), name) != elements.end() &&
                         std::find(words.begin(), words.end(), word) != words.end();
                }) == &row;
        CHECK(is_first);
      }
    }
  }
}

TEST_CASE("artists' words for elements lead to elements that the format has",
          "[scene][artist_words]") {
  const std::vector<ElementFormat> formats = scene_format();
  for (const xml::ElementWords& row : xml::element_words()) {
    CAPTURE(row.words, row.meant);
    for (std::size_t at = row.meant.find('<'); at != std::string_view::npos;
         at = row.meant.find('<', at + 1)) {
      const std::string_view name = row.meant.substr(at + 1);
      CHECK(element_named(formats, name.substr(0, name.find_first_of(" >"))));
    }
    for (const std::string_view word : xml::words_of(row.words)) {
      CAPTURE(word);
      CHECK_FALSE(element_named(formats, word));  // it would not be asked for
      CHECK(xml::meant_by_element(word) == row.meant);
      CHECK_THAT(
          problems_of(scene_with(fmt::format("<{}/>", word))).at(0),
          contains_text(fmt::format("has no element \"{}\"; use {}; allowed: ", word, row.meant)));
    }
  }
  CHECK(xml::meant_by_element("Force_Group") == xml::meant_by_element("forcegroup"));
  CHECK(xml::meant_by_element("sheets").empty());
}

TEST_CASE("a message knows what an artist means", "[scene][artist_words]") {
  struct Row {
    std::string text, hint;
  };
  const Row rows[] = {
      {surface_with("<material stiffness=\"2\"/>"), "did you mean \"b\", \"c\" and \"d\"?"},
      {surface_with("<material mass=\"2\"/>"), "did you mean \"density\"?"},
      {surface_with("<material Drag=\"2\"/>"), "did you mean \"damping\"?"},
      {surface_with("<material friction=\"2\"/>"), "did you mean \"damping\"?"},
      {surface_with("<material bend_stiffness=\"2\"/>"), "did you mean \"b\", \"c\" and \"d\"?"},
      {surface_with("<transform position=\"0 0 0\"/>"), "did you mean \"translate\"?"},
      {surface_with("<transform rotation=\"0 0 0\"/>"), "did you mean \"rotate\"?"},
      {surface_with("<solver type=\"exact\"/>"), "did you mean \"integrator\"?"},
      {scene_with("<surface name=\"s\" mass=\"2\"><grid columns=\"3\" rows=\"3\"/></surface>"),
       "did you mean \"density\" of <material>?"},
      {scene_with("<point name=\"p\" strength=\"2\"/>"), "did you mean \"magnitude\"?"},
      {scene_with("<radial name=\"p\" force=\"2\"/>"), "did you mean \"magnitude\"?"},
      {scene_with("<noise name=\"p\" intensity=\"2\"/>"), "did you mean \"magnitude\"?"},
      {scene_with("<point name=\"p\" radius=\"2\"/>"),
       "did you mean \"deformationRadius\" and \"forceRadius\"?"},
      {scene_with("<point name=\"p\" falloffRadius=\"2\"/>"),
       "did you mean \"deformationRadius\" and \"forceRadius\"?"},
      {scene_with("<group name=\"g\" size=\"2\"/>"), "did you mean \"deformationRadius\"?"},
      {scene_with("<point name=\"p\" location=\"0 0 0\"/>"), "did you mean \"center\"?"},
      {scene_with("<line name=\"p\" position=\"0 0 0\"/>"), "did you mean \"from\" and \"to\"?"},
      {scene_with("<vortex name=\"p\" rotation=\"0 0 0\"/>"), "did you mean \"axis\"?"},
      {"<scene start=\"1\" end=\"2\" frameRate=\"25\"/>", "did you mean \"fps\"?"},
      {"<scene start=\"1\" end=\"2\" framesPerSecond=\"25\"/>", "did you mean \"fps\"?"},
      {animate_with("", "<key time=\"1\" value=\"0\"/>"), "did you mean \"frame\"?"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    const std::vector<std::string> problems = problems_of(row.text);
    CAPTURE(problems);
    REQUIRE(problems.size() == 1);  // a required attribute that is meant is not missed too
    CHECK_THAT(problems[0], contains_text("; " + row.hint + " allowed: "));
  }
  // A word that is only misspelt is still guessed, and others are not.
  CHECK_THAT(problems_of(scene_with("<point name=\"p\" magnitde=\"2\"/>")).at(0),
             contains_text("; did you mean \"magnitude\"? allowed: "));
  CHECK_THAT(problems_of(scene_with("<point name=\"p\" sparkle=\"2\"/>")).at(0),
             contains_text("\"sparkle\"; allowed: "));
}

}  // namespace
}  // namespace pliant::testing
