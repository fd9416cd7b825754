// Reading and writing a scene ask often enough whether to stop, and do nothing more once they are
// to.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/document/document.hpp"
#include "pliant/document/format_scene.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/stopping.hpp"

namespace pliant::testing {
namespace {

/// The content of a scene, of about so many bytes.
struct Content {
  const char* name;
  std::string (*content)(std::size_t bytes);
};

std::string repeated(std::size_t bytes, std::string_view part) {
  std::string text;
  while (text.size() < bytes) text += part;
  return text;
}

/// `part`, with the number of each in the place of `{0}`.
std::string numbered(std::size_t bytes, std::string_view part) {
  std::string text;
  for (std::size_t k = 0; text.size() < bytes; ++k)
    text += fmt::format(fmt::runtime(part), k, k % 7);
  return text;
}

const Content contents[] = {
    {"blanks", [](std::size_t bytes) { return std::string(bytes, ' '); }},
    {"a comment", [](std::size_t bytes) { return "<!--" + std::string(bytes, '-') + "-->"; }},
    {"comments", [](std::size_t bytes) { return repeated(bytes, "<!-- a -->"); }},
    {"references",
     [](std::size_t bytes) {
       return "<point name=\"f\" targets=\"" + repeated(bytes, "&#115;") + "\"/>";
     }},
    {"forces", [](std::size_t bytes) { return numbered(bytes, "<point name=\"f{0}\"/>\n"); }},
    {"unknown attributes",
     [](std::size_t bytes) { return numbered(bytes, "<point name=\"f{0}\" size=\"{1}\"/>\n"); }},
    {"undefined names",
     [](std::size_t bytes) {
       return numbered(bytes, "<point name=\"f{0}\" magnitude=\"$strength{0}\"/>\n");
     }},
    {"definitions",
     [](std::size_t bytes) {
       return numbered(bytes, "<define name=\"a{0}\" value=\"{1} + 1\"/>\n");
     }},
    {"arithmetic",
     [](std::size_t bytes) {
       return "<define name=\"a\" value=\"1\"/>" +
              numbered(bytes, "<point name=\"f{0}\" magnitude=\"$a*{1} + $a*(2 - $a)\"/>\n");
     }},
    {"keys",
     [](std::size_t bytes) {
       return "<point name=\"f\"><animate attribute=\"magnitude\">" +
              numbered(bytes, "<key frame=\"{0}\" value=\"{1}\"/>\n") + "</animate></point>";
     }},
    {"waypoints",
     [](std::size_t bytes) {
       return "<point name=\"f\"><path attribute=\"center\">" +
              numbered(bytes, "<waypoint at=\"{0} {1} 0\"/>\n") + "</path></point>";
     }},
    {"points",
     [](std::size_t bytes) {
       return "<surface name=\"net\"><nurbs columns=\"4\" rows=\"4\"><points>" +
              numbered(bytes, "{0} {1} 0\n") + "</points></nurbs></surface>";
     }},
};

std::string text_of_content(const Content& kind, std::size_t bytes) {
  return "<scene version=\"1\" start=\"1\" end=\"2\">"
         "<surface name=\"s\"><grid columns=\"4\" rows=\"4\"/></surface>" +
         kind.content(bytes) + "</scene>";
}

/// Some of the contents are no scene: that they were read to their end is what counts.
Result<void> without_problems(const auto& result) {
  if (!result && result.error().code == ErrorCode::Interrupted) return fail(result.error());
  return {};
}

/// Under sanitizers most of the time would be what comes before the stop.
constexpr std::size_t bytes_of_text = std::size_t{1} << (is_sanitized ? 17U : 20U);

/// What writes text ends with a part of it, and its caller asks again.
template <class Work>
void check_texts(const Work& work) {
  check_stops(
      work, 1, [] {}, Stop::Always);
}

TEST_CASE("reading a scene asks whether to stop, the more often the larger it is",
          "[scene][stop]") {
  constexpr std::size_t bytes = std::size_t{2} << 20U;
  for (const Content& kind : contents) {
    CAPTURE(kind.name);
    const auto read = [&](std::size_t size) {
      return [text = text_of_content(kind, size)](const StopRequest& should_stop) {
        return without_problems(parse_scene(text, "a.xml", "", "", should_stop));
      };
    };
    check_stops(read(bytes), static_cast<int>(bytes / StopPoll::parts_between));
    if (!is_sanitized) CHECK(asks_of(read(bytes)) > asks_of(read(bytes / 4)));
  }
}

TEST_CASE("laying a scene out and editing it can be stopped", "[document][stop]") {
  for (const Content& kind : contents) {
    CAPTURE(kind.name);
    const std::string text = text_of_content(kind, bytes_of_text);
    check_texts([&](const StopRequest& should_stop) {
      return without_problems(format_scene(text, "a.xml", should_stop));
    });
    if (!parse_scene(text, "a.xml", "")) continue;
    StopRequest present;
    auto document = SceneDocument::from_text(text, "a.xml", "",
                                             {.should_stop = [&] { return present && present(); }});
    REQUIRE(document);
    check_texts([&](const StopRequest& should_stop) {
      present = should_stop;
      auto changed = document->apply({edit::Set{"scene.fps", "25"}});
      present = {};
      if (changed) REQUIRE(document->undo());
      CHECK(document->text() == text);
      return without_problems(changed);
    });
  }
}

TEST_CASE("writing a scene can be stopped", "[scene][stop]") {
  for (const Content& kind : contents) {
    CAPTURE(kind.name);
    const auto scene = parse_scene(text_of_content(kind, bytes_of_text), "a.xml", "");
    if (!scene) continue;
    check_texts([&](const StopRequest& should_stop) {
      return without_problems(to_xml(*scene, "", should_stop));
    });
  }
}

}  // namespace
}  // namespace pliant::testing
