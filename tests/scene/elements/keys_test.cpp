#include <string>
#include <vector>

#include "pliant/scene/elements/read_elements.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

const std::string two_keys = "<key frame=\"1\" value=\"0\"/>\n<key frame=\"9\" value=\"8\"/>\n";

TEST_CASE("keys stand in increasing order of frames", "[scene][keys]") {
  check_each({
      {animate_with("", ""), 3, {"<animate> has no keys: at least one <key> is required"}},
      {animate_with("", "<loop from=\"1\" to=\"2\"/>"), 3, {"has no keys"}},
      {animate_with("", two_keys + "<key frame=\"9\" value=\"1\"/>"),
       6,
       {"frame 9 repeats the key of line 5"}},
      {animate_with("", two_keys + "<key frame=\"9.0\" value=\"1\"/>"), 6, {"repeats"}},
      {animate_with("", "<key frame=\"0\" value=\"1\"/>\n<key frame=\"-0\" value=\"1\"/>"),
       5,
       {"repeats"}},
      {animate_with("", two_keys + "<key frame=\"5\" value=\"1\"/>"),
       6,
       {"frame 5 is not after frame 9 of line 5", "increasing order"}},
  });
  // A key out of order is reported once, and does not cause problems for the keys after it.
  CHECK(problems_of(animate_with("",
                                 "<key frame=\"1\" value=\"0\"/><key frame=\"120\" value=\"0\"/>"
                                 "<key frame=\"13\" value=\"0\"/><key frame=\"14\" value=\"0\"/>"))
            .size() == 1);
}

TEST_CASE("a single key makes a curve, at any finite frame", "[scene][keys]") {
  for (const std::string frame : {"0", "-1e100", "12.5", "1e100"}) {
    CAPTURE(frame);
    CHECK(problems_of(animate_with("", "<key frame=\"" + frame + "\" value=\"1\"/>")).empty());
  }
}

TEST_CASE("each side of a key is told in one way", "[scene][keys]") {
  const auto key = [](const std::string& attributes) {
    return animate_with("", "<key frame=\"1\" value=\"5\"\n" + attributes + "/>");
  };
  check_each({
      {key("tangent=\"flat\" in=\"1\""), 5, {"<key> has both tangent and in"}},
      {key("tangent=\"flat\" out=\"1\""), 5, {"both tangent and out"}},
      {key("tangent=\"flat\" outHandle=\"1 1\""), 5, {"both tangent and outHandle"}},
      {key("in=\"flat\" inHandle=\"-1 1\""), 5, {"both in and inHandle"}},
      {key("out=\"1\" outHandle=\"1 1\""), 5, {"both out and outHandle"}},
      {key("inLength=\"1\" inHandle=\"-1 1\""), 5, {"both inLength and inHandle"}},
      {key("outLength=\"1\" outHandle=\"1 1\""), 5, {"both outLength and outHandle"}},
  });
  CHECK(problems_of(key("in=\"1\" outHandle=\"1 1\" inLength=\"2\"")).empty());
}

TEST_CASE("parameters of an easing stand only where they apply", "[scene][keys]") {
  const auto key = [](const std::string& attributes, const std::string& animate = "") {
    return animate_with(animate, "<key frame=\"1\" value=\"5\" " + attributes +
                                     "/>\n<key frame=\"2\" value=\"5\" interpolation=\"linear\"/>");
  };
  check_each({
      {key("amplitude=\"1\""),
       4,
       {"<key> amplitude applies only to", "the interpolation elasticIn"}},
      {key("interpolation=\"backIn\" period=\"1\""), 4, {"period applies only to"}},
      {key("interpolation=\"elasticIn\" back=\"1\""), 4, {"back applies only to", "backIn"}},
      {key("interpolation=\"bezier\" control=\"0 0 1 1\""),
       4,
       {"control applies only to", "cubicBezier"}},
      {key("interpolation=\"cubicBezier\""), 4, {"needs control=\"x1 y1 x2 y2\""}},
      {key("", "interpolation=\"cubicBezier\""), 4, {"inherits", "needs control"}},
  });
  CHECK(problems_of(key("amplitude=\"1\"", "interpolation=\"elasticOut\"")).empty());
  // No segment starts at the last key, so it needs no control, unless a loop copies it.
  const std::string last =
      "<key frame=\"1\" value=\"5\" control=\"0 0 1 1\"/>\n<key frame=\"2\" value=\"5\"/>";
  CHECK(problems_of(animate_with("interpolation=\"cubicBezier\"", last)).empty());
  CHECK(problems_of(animate_with("interpolation=\"cubicBezier\"",
                                 last + "<loop from=\"1\" to=\"4\" after=\"2\"/>"))
            .at(0) ==
        "5: <key> inherits interpolation=\"cubicBezier\" and needs control=\"x1 y1 x2 y2\"");
}

TEST_CASE("a loop begins at a key and stands once", "[scene][keys]") {
  const auto loop = [](const std::string& attributes) {
    return animate_with("", two_keys + "<loop " + attributes + "/>");
  };
  check_each({
      {loop("from=\"2\" to=\"9\""), 6, {"<loop> from=\"2\": there is no key at that frame"}},
      {loop("from=\"1\" to=\"1\""), 6, {"to=\"1\": must be after from=\"1\""}},
      {loop("from=\"9\" to=\"1\""), 6, {"must be after"}},
      {loop("from=\"1\" to=\"9\" before=\"-1\""), 6, {"before=\"-1\": must be at least 0"}},
      {loop("from=\"1\" to=\"9\" after=\"1.5\""), 6, {"after=\"1.5\": not a whole number"}},
      {loop("from=\"1\" to=\"9\" after=\"2000000\""), 6, {"must be at most 1000000"}},
      {loop("from=\"1\" to=\"10\" after=\"600000\""),
       6,
       {"1200000 copied keys", "at most 1000000"}},
      {loop("from=\"1\" to=\"9\" offset=\"1 2 3\""), 6, {"one number is required"}},
      {loop("from=\"1\" to=\"9\"/>\n<loop from=\"1\" to=\"9\""), 7, {"second <loop>", "at line 6"}},
  });
  const Scene scene = scene_of(loop("from=\"1\" to=\"9\" before=\"1\" after=\"2\" offset=\"3\""));
  const CurveKeys<1>& curve = scene.forces.at(0).magnitude.curve().keys();
  REQUIRE(curve.loop);
  CHECK(*curve.loop == Loop<1>{.from = 1, .to = 9, .before = 1, .after = 2, .offset = {3}});
}

TEST_CASE("the loops of all curves of a scene copy a million keys at most", "[scene][keys]") {
  const auto looped = [](int number, int copies) {
    return "<point name=\"f" + std::to_string(number) + "\">\n<animate attribute=\"magnitude\">" +
           two_keys + "<loop from=\"1\" to=\"9\" after=\"" + std::to_string(copies) +
           "\"/></animate></point>\n";
  };
  std::string points;
  int number = 0;
  for (const int copies : {999'900, 0, 95, 5, 0, 2, 7}) points += looped(++number, copies);
  const auto problems =
      problems_of("<scene version=\"1\" start=\"1\" end=\"2\">" + points + "</scene>");
  REQUIRE(problems.size() == 1);
  CHECK_THAT(problems[0], contains_text("<loop> makes 2 copied keys, and those before it 1000000; "
                                        "at most 1000000 are allowed in a scene"));
}

TEST_CASE("what the curve rules refuse or change is told at the line of its key", "[scene][keys]") {
  const std::string steep =
      "<key frame=\"0\" value=\"0\"/>\n<key frame=\"10\" value=\"1\" out=\"0\" "
      "outLength=\"20\"/>\n<key frame=\"20\" value=\"2\"/>";
  check_each({{animate_with("overshoot=\"error\"", steep), 5, {"poke.magnitude: "}}});
  const Scene scene = scene_of(animate_with("", steep));
  REQUIRE_FALSE(scene.notes.empty());
  for (const SceneNote& note : scene.notes) {
    CHECK((note.line == 5 || note.line == 6));
    CHECK_THAT(note.message, Catch::Matchers::StartsWith("poke.magnitude: key "));
  }
}

TEST_CASE("a negative length counts as 0, with a note", "[scene][keys]") {
  const Scene scene =
      scene_of(animate_with("", two_keys + "<key frame=\"12\" value=\"0\" inLength=\"-3\"/>"));
  REQUIRE(scene.notes.size() == 1);
  CHECK(scene.notes[0].line == 6);
  CHECK_THAT(scene.notes[0].message,
             Catch::Matchers::StartsWith("poke.magnitude: key 12: ") && contains_text("-3"));
}

}  // namespace
}  // namespace pliant::testing
