// What each operation does to the text, byte by byte.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/document/document.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/format.hpp"
#include "support/catch.hpp"

namespace pliant::testing {
namespace {

SceneDocument document_of(const std::string& text) {
  auto document = SceneDocument::from_text(text, "shot.xml", "");
  if (!document)
    for (const std::string& line : to_lines(document.error())) UNSCOPED_INFO(line);
  REQUIRE(document);
  return *std::move(document);
}

/// The text with its only `from` replaced.
std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(from, at + 1) == std::string::npos);
  return text.replace(at, from.size(), to);
}

/// The text after operations on it; they must be accepted.
std::string after(const std::string& text, const std::vector<Operation>& operations) {
  SceneDocument document = document_of(text);
  const auto change = document.apply(operations);
  if (!change)
    for (const std::string& line : to_lines(change.error())) UNSCOPED_INFO(line);
  REQUIRE(change);
  return document.text();
}

/// The only line of the refusal of operations.
std::string refusal(const std::string& text, const std::vector<Operation>& operations) {
  SceneDocument document = document_of(text);
  const auto change = document.apply(operations);
  REQUIRE_FALSE(change);
  CHECK(document.text() == text);
  const std::vector<std::string> lines = to_lines(change.error());
  CHECK(lines.size() == 1);
  return lines.front();
}

const std::string shot = R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- the shot -->
<scene version="1" fps="24" start="1" end="48">
  <surface name='sheet'>
    <grid columns="5" rows="5"/>
    <solver dt="0.010"/> <!-- fine enough -->
  </surface>

  <!-- what pushes -->
  <point name="poke" center="-3.0 0 0" targets="sheet"
         magnitude="10" deformationRadius="2.50">
    <!-- keys by hand -->
    <animate attribute="forceRadius">
      <key frame="1" value="1.0"/> <!-- start -->
      <key frame="12" value="2.50" tangent="flat"/>

      <key frame="24" value="1" interpolation="step"/>
      <key frame="36" value="3e0"/>
    </animate>
  </point>

  <radial name="bulge" center="1 2  3"/>
</scene>
)";

TEST_CASE("a value is set at its place", "[document]") {
  CHECK(after(shot, {edit::Set{"poke.magnitude", "-2.50"}}) ==
        with(shot, "magnitude=\"10\"", "magnitude=\"-2.50\""));
  CHECK(after(shot, {edit::Set{"scene.fps", "24000/1001"}}) ==
        with(shot, "fps=\"24\"", "fps=\"24000/1001\""));
  CHECK(after(shot, {edit::Set{".fps", "25"}}) == with(shot, "fps=\"24\"", "fps=\"25\""));
  CHECK(after(shot, {edit::Set{"sheet.dt", "0.02"}}) == with(shot, "0.010", "0.02"));
  CHECK(after(shot, {edit::Set{"sheet.columns", "9"}}) ==
        with(shot, "columns=\"5\"", "columns=\"9\""));
  // One component: the others and the blanks between them stay.
  CHECK(after(shot, {edit::Set{"bulge.center.y", "7.5"}}) == with(shot, "1 2  3", "1 7.5  3"));
  // Blanks around a number stay.
  const std::string blank = with(shot, "magnitude=\"10\"", "magnitude=\" 10  \"");
  CHECK(after(blank, {edit::Set{"poke.magnitude", "7"}}) == with(blank, " 10  ", " 7  "));
  // The same value changes nothing.
  SceneDocument document = document_of(shot);
  CHECK(document.apply({edit::Set{"poke.magnitude", "10"}}).value().edits.empty());
  CHECK_FALSE(document.can_undo());
}

TEST_CASE("an attribute that is absent is added", "[document]") {
  CHECK(after(shot, {edit::Set{"bulge.magnitude", "4"}}) ==
        with(shot, "center=\"1 2  3\"/>", "center=\"1 2  3\" magnitude=\"4\"/>"));
  CHECK(after(shot, {edit::Set{"bulge.deformationRadius", "2"}, edit::Reset{"bulge.center"}}) ==
        with(shot, " center=\"1 2  3\"/>", " deformationRadius=\"2\"/>"));
  // In the order of the format, in the quotes of its neighbours.
  CHECK(after(shot, {edit::Set{"sheet.density", "40"}}) ==
        with(shot, "    <solver", "    <material density=\"40\"/>\n    <solver"));
  CHECK(after(shot, {edit::Set{"sheet.translate", "1 2 3"}, edit::Set{"sheet.d", "2"}}) ==
        with(shot, "    <solver",
             "    <transform translate=\"1 2 3\"/>\n    <material d=\"2\"/>\n    <solver"));
  // One attribute a line stays so.
  const std::string tall =
      "<scene version=\"1\" start=\"1\" end=\"2\">\r\n\t<point\r\n\t\tname='a'\r\n\t\tcenter='0 0 "
      "1'\r\n\t/>\r\n</scene>";
  CHECK(after(tall, {edit::Set{"a.magnitude", "3"}}) ==
        with(tall, "1'\r\n", "1'\r\n\t\tmagnitude='3'\r\n"));
}

TEST_CASE("a constant takes the place of a curve", "[document]") {
  const std::size_t begin = shot.find("\n    <animate");
  const std::size_t end = shot.find("</animate>") + 10;
  std::string without = shot;
  without.erase(begin, end - begin);
  const std::string constant =
      with(without, "deformationRadius=\"2.50\"", "deformationRadius=\"2.50\" forceRadius=\"7\"");
  CHECK(after(shot, {edit::Set{"poke.forceRadius", "7"}}) == constant);
  CHECK(after(shot, {edit::Reset{"poke.forceRadius"}}) == without);
  CHECK(after(shot, {edit::Freeze{{"poke.forceRadius"}, 30}}) ==
        with(constant, "forceRadius=\"7\"", "forceRadius=\"1\""));
  CHECK_THAT(refusal(shot, {edit::Freeze{{"poke.forceRadius"}, -INFINITY}}),
             contains_text("the frame must be finite, not -inf"));
  CHECK(after(constant, {edit::Animate{{"poke.forceRadius"}, 5}}) ==
        with(with(constant, " forceRadius=\"7\"", ""), "2.50\">\n",
             "2.50\">\n    <animate attribute=\"forceRadius\">\n      <key frame=\"5\" "
             "value=\"7\"/>\n    </animate>\n"));
  CHECK(after(shot, {edit::Animate{{"bulge.magnitude"}, 2}}) ==
        with(shot, "3\"/>",
             "3\">\n    <animate attribute=\"magnitude\">\n      <key frame=\"2\" "
             "value=\"0\"/>\n    </animate>\n  </radial>"));
}

TEST_CASE("keys are set, deleted and moved in the text", "[document]") {
  const std::string channel = "poke.forceRadius";
  CHECK(after(shot, {edit::SetKey{channel, 12, "9"}}) == with(shot, "\"2.50\" t", "\"9\" t"));
  // Behind its neighbour and the comment of that.
  CHECK(after(shot, {edit::SetKey{channel, 6.5, "9.0"}}) ==
        with(shot, "start -->\n", "start -->\n      <key frame=\"6.5\" value=\"9.0\"/>\n"));
  // The interpolation of the segment in which it stands.
  CHECK(after(shot, {edit::SetKey{channel, 30, "9"}}) ==
        with(shot, "\"step\"/>\n",
             "\"step\"/>\n      <key frame=\"30\" value=\"9\" interpolation=\"step\"/>\n"));
  CHECK(after(shot, {edit::SetKey{channel, 0, "9"}}) ==
        with(shot, "forceRadius\">\n", "forceRadius\">\n      <key frame=\"0\" value=\"9\"/>\n"));
  CHECK(after(shot, {edit::DeleteKeys{{{channel, {12, 36}}}}}) ==
        with(with(shot, "\n      <key frame=\"12\" value=\"2.50\" tangent=\"flat\"/>", ""),
             "\n      <key frame=\"36\" value=\"3e0\"/>", ""));
  // A comment behind a key stays where it is.
  CHECK(after(shot, {edit::DeleteKeys{{{channel, {1}}}}}) ==
        with(shot, "<key frame=\"1\" value=\"1.0\"/> ", ""));
  CHECK(after(shot, {edit::MoveKeys{{{channel, {12, 24}}}, 2.5}}) ==
        with(with(shot, "frame=\"12\"", "frame=\"14.5\""), "frame=\"24\"", "frame=\"26.5\""));
  CHECK(after(shot, {edit::MoveKeys{{{channel, {36}}}, 0, {0.25}}}) ==
        with(shot, "\"3e0\"", "\"3.25\""));
  CHECK(after(shot, {edit::MoveKeys{{{channel, {12, 36}}}, 0, {0.1234}, {}, 3}}) ==
        with(with(shot, "value=\"2.50\"", "value=\"2.62\""), "\"3e0\"", "\"3.12\""));
  // Past another key: it is written behind that.
  CHECK(after(shot, {edit::MoveKeys{{{channel, {12}}}, 14}}) ==
        with(with(shot, "\n      <key frame=\"12\" value=\"2.50\" tangent=\"flat\"/>", ""),
             "\"step\"/>",
             "\"step\"/>\n      <key frame=\"26\" value=\"2.50\" tangent=\"flat\"/>"));
  CHECK(after(shot, {edit::MoveKeys{{{channel, {24}}}, 12, {}, edit::Collision::Replace}}) ==
        with(with(shot, "frame=\"24\"", "frame=\"36\""),
             "\n      <key frame=\"36\" value=\"3e0\"/>", ""));
  CHECK(
      refusal(shot, {edit::MoveKeys{{{channel, {24}}}, 12}}) ==
      "shot.xml: error: poke.forceRadius: the key of frame 24 would come to frame 36, where there "
      "is one");
  CHECK(refusal(shot, {edit::DeleteKeys{{{channel, {2}}}}}) ==
        "shot.xml: error: poke.forceRadius has no key at frame 2; it has 4, from 1 to 36");
}

TEST_CASE("keys are scaled in the text", "[document]") {
  const std::string channel = "poke.forceRadius";
  CHECK(after(shot, {edit::ScaleKeys{{{channel, {24, 36}}}, 24, 2, {}, {}}}) ==
        with(shot, "frame=\"36\"", "frame=\"48\""));
  CHECK(
      after(shot, {edit::ScaleKeys{{{channel, {12, 24}}}, 12, 1, {0.5}, {2}}}) ==
      with(with(shot, "\"2.50\" tangent", "\"4.5\" tangent"), "value=\"1\" i", "value=\"1.5\" i"));
  // Past another key: it is written behind that.
  CHECK(after(shot, {edit::ScaleKeys{{{channel, {12}}}, 0, 2.25}}) ==
        with(with(shot, "\n      <key frame=\"12\" value=\"2.50\" tangent=\"flat\"/>", ""),
             "\"step\"/>",
             "\"step\"/>\n      <key frame=\"27\" value=\"2.50\" tangent=\"flat\"/>"));
  const auto halved = [&](double step, edit::Collision collision) {
    return edit::ScaleKeys{{{channel, {12, 24, 36}}}, 1, 0.5, {}, {}, step, collision};
  };
  CHECK(after(shot, {halved(1, edit::Collision::Refuse)}) ==
        with(with(with(shot, "frame=\"12\"", "frame=\"7\""), "frame=\"24\"", "frame=\"13\""),
             "frame=\"36\"", "frame=\"19\""));
  // 7, 12.5 and 18.5 to tens.
  CHECK(refusal(shot, {halved(10, edit::Collision::Replace)}) ==
        "shot.xml: error: poke.forceRadius: the key of frame 24 would come to frame 10, where "
        "there is one");
  CHECK(refusal(shot, {edit::ScaleKeys{{{channel, {12}}}, 0, 2}}) ==
        "shot.xml: error: poke.forceRadius: the key of frame 12 would come to frame 24, where "
        "there is one");
  CHECK(after(shot,
              {edit::ScaleKeys{{{channel, {12}}}, 0, 2, {}, {}, 0, edit::Collision::Replace}}) ==
        with(with(shot, "frame=\"12\"", "frame=\"24\""),
             "\n\n      <key frame=\"24\" value=\"1\" interpolation=\"step\"/>", ""));
  // Factors of 1 change no byte.
  CHECK(after(shot, {edit::ScaleKeys{{{channel, {1, 12, 24, 36}}}, 3, 1, {9}, {1}, 5}}) == shot);

  const auto refused = [&](edit::ScaleKeys scale, const std::string& why) {
    scale.keys = {{channel, {12, 24}}};
    CHECK(refusal(shot, {scale}) == "shot.xml: error: " + why);
  };
  refused({{}, NAN}, "the frame must be finite, not nan");
  for (const double factor : {0.0, -1.0, double{INFINITY}})
    refused({{}, 0, factor},
            fmt::format("the time factor must be finite and above 0, not {}", factor));
  refused({{}, 0, 1, {}, {}, -1}, "the step must be finite and not below 0, not -1");
  refused({{}, 0, 2, {}, {}, 1e-320},
          "poke.forceRadius: the key of frame 12 would come to frame inf, which is not finite");
  refused({{}, 0, 1, {}, {1, 2, 3}},
          "poke.forceRadius: the value factor has 3 numbers; one for all components or 1 are "
          "possible");
  refused({{}, 0, 1, {1, 2}},
          "poke.forceRadius: the value has 2 numbers; one for all components "
          "or 1 are possible");

  const std::string states = with(shot, "<!-- keys by hand -->",
                                  "<animate attribute=\"enabled\"><key frame=\"1\" "
                                  "value=\"true\"/><key frame=\"6\" value=\"false\"/></animate>");
  const edit::KeysOf switches{"poke.enabled", {1, 6}};
  CHECK(after(states, {edit::ScaleKeys{{switches}, 1, 3}}) ==
        with(states, "frame=\"6\"", "frame=\"16\""));
  CHECK(refusal(states, {edit::ScaleKeys{{switches}, 1, 1, {}, {2}}}) ==
        "shot.xml: error: poke.enabled: a boolean channel has no multiples");
}

TEST_CASE("a key without a value keeps the curve", "[document]") {
  SceneDocument document = document_of(shot);
  const Channel<1> before = document.scene().forces.at(0).force_radius;
  REQUIRE(document.apply({edit::SetKey{"poke.forceRadius", 7}}));
  const Channel<1>& now = document.scene().forces.at(0).force_radius;
  CHECK(now.curve().keys().keys.size() == 5);
  for (double frame = -2; frame < 50; frame += 0.37) {
    CAPTURE(frame);
    CHECK_THAT(now.at(frame)[0], WithinAbs(before.at(frame)[0], 1e-12));
  }
  // Keys that need no change keep their bytes.
  for (const char* const same : {"<key frame=\"24\" value=\"1\" interpolation=\"step\"/>\n",
                                 "<key frame=\"36\" value=\"3e0\"/>", "<!-- start -->\n"})
    CHECK_THAT(document.text(), contains_text(same));
}

TEST_CASE("tangents, handles and interpolation are attributes of keys", "[document]") {
  const std::string channel = "poke.forceRadius";
  CHECK(after(shot, {edit::SetTangent{{{channel, {24}}}, edit::Side::Both, "0.010"}}) ==
        with(shot, "\"step\"/>", "\"step\" tangent=\"0.010\"/>"));
  // The other side keeps what both had.
  CHECK(after(shot, {edit::SetTangent{{{channel, {12}}}, edit::Side::In, "spline", "2"}}) ==
        with(shot, " tangent=\"flat\"", " out=\"flat\" in=\"spline\" inLength=\"2\""));
  CHECK(after(shot, {edit::SetHandle{channel, 12, edit::Side::Out, "3 1.0"}}) ==
        with(shot, " tangent=\"flat\"", " in=\"flat\" outHandle=\"3 1.0\""));
  CHECK(after(shot, {edit::SetInterpolation{{{channel, {24}}}, "elasticOut", "2"}}) ==
        with(shot, "\"step\"/>", "\"elasticOut\" amplitude=\"2\"/>"));
  CHECK(after(shot, {edit::SetExtrapolation{{channel}, {}, "repeat 2"}}) ==
        with(shot, "\"forceRadius\">", "\"forceRadius\" after=\"repeat 2\">"));
}

TEST_CASE("things are added as their neighbours are laid out", "[document]") {
  CHECK(after(shot, {edit::Add{"point", "push", {{"center", "1 0 0"}}}}) ==
        with(shot, "  3\"/>\n", "  3\"/>\n\n  <point name=\"push\" center=\"1 0 0\"/>\n"));
  CHECK(after(shot,
              {edit::Add{"surface", "skin", {{"columns", "3"}, {"dt", "0.1"}, {"rows", "4"}}}}) ==
        with(shot, "  </surface>\n",
             "  </surface>\n  <surface name='skin'>\n    <grid columns='3' rows='4'/>\n    "
             "<solver dt='0.1'/>\n  </surface>\n"));
  const std::string line =
      "<scene version='1' start='1' end='2'><point name='a'/> <group name='g'/></scene>";
  CHECK(after(line, {edit::Add{"point", "b"}}) ==
        with(line, "<group name='g'/>", "<group name='g'/> <point name='b'/>"));
  CHECK(after(line, {edit::Add{"point", "b", {}, "g"}}) ==
        with(line, "<group name='g'/>", "<group name='g'><point name='b'/></group>"));
  CHECK_THAT(refusal(line, {edit::Add{"pont", "b"}}),
             contains_text("no kind \"pont\"; did you mean \"point\"?"));
}

TEST_CASE("a copy has the bytes of the original", "[document]") {
  const std::size_t begin = shot.find("  <point");
  const std::size_t end = shot.find("</point>") + 8;
  const std::string copy = with(shot.substr(begin, end - begin), "\"poke\"", "\"prod\"");
  CHECK(after(shot, {edit::Duplicate{"poke", "prod"}}) ==
        std::string(shot).insert(end, "\n" + copy));
}

TEST_CASE("references follow a new name", "[document]") {
  const std::string text =
      with(shot, "  <radial name=\"bulge\"",
           "  <surface name=\"skin\" drivenBy=\"sheet\"><grid columns=\"3\" "
           "rows=\"3\"/></surface>\n  <radial targets=\" sheet \" name=\"bulge\"");
  std::string expected = with(text, "name='sheet'", "name='cloth'");
  expected = with(expected, "targets=\"sheet\"", "targets=\"cloth\"");
  expected = with(expected, "targets=\" sheet \"", "targets=\" cloth \"");
  expected = with(expected, "drivenBy=\"sheet\"", "drivenBy=\"cloth\"");
  CHECK(after(text, {edit::Rename{"sheet", "cloth"}}) == expected);
  CHECK_THAT(refusal(shot, {edit::Rename{"bulge", "poke"}}),
             contains_text("the name is already used"));
}

TEST_CASE("what is deleted is no target any more", "[document]") {
  const std::string two = with(shot, "\n\n  <!-- what",
                               "\n  <surface name=\"b\"><grid columns=\"3\" rows=\"3\"/></surface>"
                               "\n\n  <!-- what");
  const std::string both = with(two, "targets=\"sheet\"", "targets=\"sheet b\"");
  CHECK(after(both, {edit::Delete{{"b"}}}) == shot);
  CHECK_THAT(
      refusal(two, {edit::Delete{{"sheet"}}}),
      contains_text("poke.targets: only sheet is left to delete there; without it poke.targets is "
                    "the default (all surfaces). Delete poke too"));
  const std::string gone = after(two, {edit::Delete{{"sheet", "poke"}}});
  CHECK(gone.find("sheet") == std::string::npos);
  CHECK(gone.find("<!-- what pushes -->") != std::string::npos);
}

TEST_CASE("whatever names a surface follows its new name, and is asked before it goes",
          "[document][contents]") {
  std::size_t count = 0;
  for (const ElementFormat& element : scene_format()) {
    for (const AttributeFormat& attribute : element.attributes) {
      if (!attribute.names_surfaces) continue;
      ++count;
      const auto& objects = scene_format().front().children;
      const bool is_object = std::ranges::any_of(objects, [&](const ChildFormat& one) {
        return std::ranges::find(one.names, element.name) != one.names.end();
      });
      const std::string kind(is_object ? element.name : element.parents.front());
      const std::string name(attribute.name);
      CAPTURE(kind, name);
      edit::Add add{kind, "it", {{name, "sheet"}}};
      if (kind == "surface")
        add.attributes.insert(add.attributes.end(), {{"columns", "3"}, {"rows", "3"}});
      const std::string text =
          after(shot, {edit::Delete{{"poke"}},
                       edit::Add{"surface", "other", {{"columns", "3"}, {"rows", "3"}}}, add});
      // A name of its own, even if another one begins with it.
      SceneDocument document = document_of(text);
      const auto change = document.apply({edit::Rename{"sheet", "sheet2"}});
      REQUIRE(change);
      CHECK(std::ranges::count(change->parts, "it." + name) == 1);
      CHECK_THAT(document.text(), contains_text(" " + name + "="));
      CHECK(document.text().find("sheet\"") == std::string::npos);
      CHECK(document.text().find("sheet'") == std::string::npos);
      CHECK(after(document.text(), {edit::Rename{"sheet2", "sheet"}}) == text);

      CHECK_THAT(refusal(text, {edit::Delete{{"sheet"}}}),
                 contains_text("it." + name + ": only sheet is left to delete there"));
      CHECK(after(text, {edit::Delete{{"sheet", "it"}}}).find("sheet") == std::string::npos);
      if (attribute.type != "names") continue;
      const std::string both = after(text, {edit::Set{"it." + name, "other sheet"}});
      CHECK(after(both, {edit::Delete{{"sheet"}}}) ==
            after(both, {edit::Set{"it." + name, "other"}, edit::Delete{{"sheet"}}}));
    }
  }
  CHECK(count > 10);
}

const std::string hall = R"(<scene version="1" start="1" end="9">
  <surface name="sheet">
    <grid columns="5" rows="5"/>
  </surface>
  <collider name="floor" targets="sheet"><plane/></collider>
</scene>
)";

TEST_CASE("colliders are added with a shape and what it needs", "[document]") {
  CHECK(after(hall, {edit::Add{"collider",
                               "ball",
                               {{"translate", "0 2 0"}, {"radius", "1"}, {"friction", "0.5"}},
                               "",
                               "sphere"}}) ==
        with(hall, "</collider>\n",
             "</collider>\n  <collider name=\"ball\" friction=\"0.5\">\n    <sphere "
             "radius=\"1\"/>\n    <transform translate=\"0 2 0\"/>\n  </collider>\n"));
  // Without a shape it has the first that there is, as a surface has; each shape may be given.
  CHECK(after(hall, {edit::Add{"collider", "ball"}}) ==
        after(hall, {edit::Add{"collider", "ball", {}, "", "sphere"}}));
  for (const Collider& solid : xml::solid_kinds()) {
    const std::string shape(shape_of(solid));
    if (shape == "mesh") continue;  // which needs a file
    CHECK_THAT(after(hall, {edit::Add{"collider", "it", {{"rotate", "0 9 0"}}, "", shape}}),
               contains_text("<" + shape + "/>\n    <transform rotate=\"0 9 0\"/>"));
  }
  CHECK_THAT(refusal(hall, {edit::Add{"collider", "a", {}, "", "grid"}}),
             contains_text("<collider> has no element \"grid\"; it belongs in <surface>; allowed: "
                           "sphere, capsule, box, plane, mesh"));
  CHECK_THAT(refusal(hall, {edit::Add{"point", "a", {}, "", "grid"}}),
             contains_text("a <point> has no shape"));
  CHECK_THAT(refusal(hall, {edit::Add{"collider", "a", {{"radios", "1"}}}}),
             contains_text("radios"));
}

TEST_CASE("colliders are changed as surfaces are", "[document]") {
  const std::string moved = with(hall, "<plane/>", "<plane/><transform translate=\"0 -1 0\"/>");
  CHECK(after(hall, {edit::Set{"floor.translate", "0 -1 0"}}) == moved);
  CHECK(after(hall, {edit::SetPart{"floor", "transform", {{"translate", "0 -1 0"}}}}) == moved);
  CHECK_THAT(refusal(hall, {edit::SetPart{"floor", "material", {}}}),
             contains_text("allowed: transform"));
  // A curve of the transform may stand in the collider itself.
  const std::string curve =
      "<animate attribute=\"translate\"><key frame=\"1\" value=\"0 0 0\"/></animate>";
  const std::string keyed = with(hall, "<plane/>", "<plane/>" + curve);
  CHECK(after(keyed, {edit::Set{"floor.translate", "0 -1 0"}}) == moved);
  CHECK_THAT(after(keyed, {edit::SetKey{"floor.translate", 5, "0 2 0"}}),
             contains_text("<key frame=\"5\" value=\"0 2 0\"/></animate>"));
  CHECK(after(keyed, {edit::Reset{"floor.translate"}}) == hall);

  CHECK(after(hall, {edit::Duplicate{"floor", "wall"}}) ==
        with(hall, "</collider>\n",
             "</collider>\n  <collider name=\"wall\" targets=\"sheet\"><plane/></collider>\n"));
  CHECK(after(hall, {edit::Delete{{"floor"}}}) ==
        with(hall, "  <collider name=\"floor\" targets=\"sheet\"><plane/></collider>\n", ""));
  CHECK(after(hall, {edit::Rename{"floor", "ground"}}) == with(hall, "\"floor\"", "\"ground\""));
  const std::string all = with(hall, " targets=\"sheet\"", "");
  CHECK(after(hall, {edit::Target{{"floor"}, {}}}) == all);
  CHECK(after(all, {edit::Target{{"floor"}, {"sheet"}}}) == hall);
  CHECK_THAT(refusal(hall, {edit::Target{{"sheet"}, {}}}),
             contains_text("\"sheet\" has no targets"));
  CHECK_THAT(refusal(hall, {edit::Target{{"scene"}, {}}}),
             contains_text("the scene has no targets"));
}

TEST_CASE("no object gets the name by which operations call the scene", "[document]") {
  const std::vector<Operation> all = {edit::Rename{"poke", "scene"},
                                      edit::Duplicate{"poke", "scene"}, edit::Add{"point", "scene"},
                                      edit::Group{{"poke", "bulge"}, "scene"}};
  for (const Operation& one : all)
    CHECK_THAT(refusal(shot, {one}), Catch::Matchers::EndsWith("choose another name"));
}

TEST_CASE("forces are grouped and ungrouped", "[document]") {
  const std::string text =
      "<scene version=\"1\" start=\"1\" end=\"9\">\n"
      "  <point name=\"a\" deformationRadius=\"3.0\" center=\"1 0 0\"/> <!-- first -->\n"
      "  <!-- second -->\n"
      "  <radial name=\"b\">\n"
      "    <animate attribute=\"magnitude\">\n"
      "      <key frame=\"1\" value=\"0\"/>\n"
      "    </animate>\n"
      "  </radial>\n"
      "  <line name=\"c\"/>\n"
      "</scene>\n";
  const std::string grouped =
      "<scene version=\"1\" start=\"1\" end=\"9\">\n"
      "  <group name=\"g\" center=\"1 0 0\" deformationRadius=\"3.0\">\n"
      "    <point name=\"a\" center=\"1 0 0\"/> <!-- first -->\n"
      "    <!-- second -->\n"
      "    <radial name=\"b\">\n"
      "      <animate attribute=\"magnitude\">\n"
      "        <key frame=\"1\" value=\"0\"/>\n"
      "      </animate>\n"
      "    </radial>\n"
      "  </group>\n"
      "  <line name=\"c\"/>\n"
      "</scene>\n";
  CHECK(after(text, {edit::Group{{"b", "a"}, "g"}}) == grouped);
  CHECK(after(grouped, {edit::Group{{"c"}, "g"}}) ==
        with(with(grouped, "\n  <line name=\"c\"/>", ""), "    </radial>\n",
             "    </radial>\n    <line name=\"c\"/>\n"));
  // Both have the radius of the group then.
  CHECK(after(grouped, {edit::Ungroup{{"g"}}}) ==
        with(with(text, " deformationRadius=\"3.0\" center=\"1 0 0\"/>",
                  " center=\"1 0 0\" deformationRadius=\"3.0\"/>"),
             "<radial name=\"b\">", "<radial name=\"b\" deformationRadius=\"3.0\">"));
}

TEST_CASE("a force that leaves its group keeps when it is enabled", "[document]") {
  const auto grouped = [](const std::string& group, const std::string& force,
                          const std::string& curve = "") {
    return "<scene start=\"1\" end=\"9\">\n  <define name=\"g\" value=\"true\"/>\n  <surface "
           "name=\"s\"><grid columns=\"5\" rows=\"5\"/></surface>\n  <group name=\"all\"" +
           group + ">\n    <point name=\"f\"" + force + ">" + curve +
           "</point>\n  </group>\n</scene>\n";
  };
  const std::string steps =
      "<animate attribute=\"enabled\"><key frame=\"1\" value=\"true\"/><key frame=\"5\" "
      "value=\"false\"/></animate>";
  const std::vector<Operation> ungroup = {edit::Ungroup{{"all"}}};
  CHECK_THAT(after(grouped(" enabled=\"$g\"", ""), ungroup),
             contains_text("<point name=\"f\" enabled=\"$g\""));
  CHECK_THAT(after(grouped(" enabled=\"$g\"", " enabled=\"false\""), ungroup),
             contains_text("<point name=\"f\" enabled=\"false\""));
  const std::string off = after(grouped(" enabled=\"false\"", "", steps), ungroup);
  CHECK_THAT(off, contains_text("enabled=\"false\"") && !contains_text("<animate"));
  for (const auto& [force, curve] : {std::pair(" enabled=\"$g\"", std::string()), {"", steps}})
    CHECK_THAT(refusal(grouped(" enabled=\"$g\"", force, curve), ungroup),
               contains_text("f.enabled and all.enabled are both more than true or false"));
}

TEST_CASE("forces of a copied group get names that are free", "[document]") {
  std::string text =
      "<scene start=\"1\" end=\"9\"><surface name=\"s\"><grid columns=\"5\" rows=\"5\"/></surface>"
      "<point name=\"f3\"/><group name=\"g\">";
  for (int k = 4; k < 300; ++k) text += "<point name=\"f" + std::to_string(k) + "\"/>";
  text += "</group></scene>";
  SceneDocument document = document_of(text);
  REQUIRE(document.apply({edit::Duplicate{"g", "h"}}));
  const std::vector<Force>& forces = document.scene().forces;
  REQUIRE(forces.size() == 593);
  CHECK(forces[297].name == "f2");
  CHECK(forces[298].name == "f300");
}

TEST_CASE("a refusal is what validate would say of the file", "[document]") {
  CHECK(refusal(shot, {edit::Set{"poke.magnitude", "1,5"}}) ==
        "shot.xml:11: error: <point> magnitude=\"1,5\": not a number: \",5\" follows 1 (write the "
        "decimal point as \".\")");
  CHECK_THAT(refusal(shot, {edit::Set{"poke.magnitud", "1"}}),
             contains_text("\"poke\" has no attribute \"magnitud\"; did you mean \"magnitude\"?"));
  CHECK_THAT(refusal(shot, {edit::Set{"pok.magnitude", "1"}}),
             contains_text("nothing is named \"pok\"; did you mean \"poke\"?"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke", "1"}}), contains_text("is not a path"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.name", "a"}}), contains_text("changed by a rename"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.center.progress", "1"}}),
             contains_text("poke.center follows no path"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.forceRadius.x", "1"}}),
             contains_text("is a single number"));
  // A channel that breaks its rule at a later frame.
  CHECK_THAT(refusal(shot, {edit::SetKey{"poke.forceRadius", 40, "-9"}}),
             contains_text("poke.forceRadius at frame 38 is -3, but must be at least 0"));
}

TEST_CASE("every byte of a value comes back", "[document]") {
  const std::string mesh = with(shot, "<grid columns=\"5\" rows=\"5\"/>", "<mesh file='a.obj'/>");
  for (const std::string value : {"a & \"b\" <c> 'd'.obj", "ä€😀.obj", "a\tb\nc\r\nd.obj", " x "}) {
    CAPTURE(value);
    SceneDocument document = document_of(mesh);
    REQUIRE(document.apply({edit::Set{"sheet.object", value}}));
    CHECK(std::get<MeshFile>(document.scene().surfaces[0].shape).object == value);
  }
}

/// A curve with a number of every sort, each in its own attribute.
const std::string every_number =
    "<scene start=\"1\" end=\"9\"><surface name=\"s\"><grid columns=\"5\" rows=\"5\"/></surface>"
    "<point name=\"f\"><animate attribute=\"magnitude\" tangent=\"3\" before=\"slope 2\" "
    "after=\" slope  -4 \"><key frame=\"1\" value=\"10\" out=\"5\"/><key frame=\"3\" "
    "value=\"20\" left=\"15\" in=\"6\" outHandle=\"0.5  7\"/><key frame=\"5\" value=\"30\" "
    "tangent=\"8\"/><key frame=\"7\" value=\"40\" interpolation=\"elasticIn\" amplitude=\"50\" "
    "period=\"1\"/><key frame=\"8\" value=\"60\"/><key frame=\"20\" value=\"0.00\" "
    "tangent=\"flat\"/>"
    "<loop from=\"3\" to=\"8\" after=\"1\" offset=\"9\"/></animate></point></scene>";

TEST_CASE("a loop that begins at a key moves with it, and not with those after it", "[document]") {
  const auto moved = [](const std::vector<double>& frames) {
    SceneDocument document = document_of(every_number);
    REQUIRE(document.apply({edit::MoveKeys{{{"f.magnitude", frames}}, 2}}));
    return document.scene().forces[0].magnitude.curve().keys().loop->from;
  };
  CHECK(moved({3, 5, 7, 8}) == 5);
  CHECK(moved({20}) == 3);
}

TEST_CASE("a curve is scaled in every number, and nowhere else", "[document]") {
  std::string wanted = every_number;
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"tangent=\"3\"", "tangent=\"9\""},
                                                        {"\"slope 2\"", "\"slope 6\""},
                                                        {"\" slope  -4 \"", "\" slope  -12 \""},
                                                        {"value=\"10\"", "value=\"30!\""},
                                                        {"out=\"5\"", "out=\"15\""},
                                                        {"value=\"20\"", "value=\"60!\""},
                                                        {"left=\"15\"", "left=\"45\""},
                                                        {"in=\"6\"", "in=\"18\""},
                                                        {"0.5  7", "0.5  21"},
                                                        {"value=\"30\"", "value=\"90!\""},
                                                        {"tangent=\"8\"", "tangent=\"24\""},
                                                        {"value=\"40\"", "value=\"120!\""},
                                                        {"amplitude=\"50\"", "amplitude=\"150\""},
                                                        {"value=\"60\"", "value=\"180!\""},
                                                        {"offset=\"9\"", "offset=\"27\""}}) {
    wanted = with(wanted, from, to);
  }
  std::erase(wanted, '!');
  SceneDocument document = document_of(every_number);
  const Curve<1> before = document.scene().forces[0].magnitude.curve();
  REQUIRE(document.apply({edit::Scale{{"f.magnitude"}, 3}}));
  CHECK(document.text() == wanted);
  const Curve<1>& scaled = document.scene().forces[0].magnitude.curve();
  for (double frame = -5; frame < 30; frame += 0.125)
    CHECK_THAT(scaled.value(frame)[0], WithinAbs(3 * before.value(frame)[0], 1e-9));
  REQUIRE(document.undo());
  CHECK(document.text() == every_number);
  // What does not change is no edit.
  REQUIRE(document.apply({edit::Scale{{"f.magnitude"}, 1}}));
  CHECK_FALSE(document.can_undo());
}

TEST_CASE("constants are scaled, and numbers rounded to digits", "[document]") {
  CHECK(after(shot, {edit::Scale{{"poke.magnitude", "bulge.center"}, 2}}) ==
        with(with(shot, "magnitude=\"10\"", "magnitude=\"20\""), "1 2  3", "2 4  6"));
  CHECK(after(shot, {edit::Scale{{"bulge.center.y"}, -0.5}}) == with(shot, "1 2  3", "1 -1  3"));
  CHECK(after(shot, {edit::Scale{{"poke.magnitude"}, 1.0 / 3, 3}}) ==
        with(shot, "magnitude=\"10\"", "magnitude=\"3.33\""));
  const std::string keys = after(shot, {edit::Scale{{"poke.forceRadius"}, 1.0 / 3, 2}});
  CHECK_THAT(keys, contains_text("frame=\"12\" value=\"0.83\" tangent"));
  CHECK_THAT(keys, contains_text("frame=\"36\" value=\"1\""));
  CHECK_THAT(refusal(shot, {edit::Scale{{"sheet.columns"}, 2}}), contains_text("no multiples"));
  CHECK_THAT(refusal(shot, {edit::Scale{{"poke.enabled"}, 2}}), contains_text("no multiples"));
  CHECK_THAT(refusal(shot, {edit::Scale{{"poke.magnitude"}, std::nan("")}}),
             contains_text("the factor must be finite"));
}

template <int D>
CurveKeys<D> curve_of(const std::vector<std::pair<double, double>>& points) {
  CurveKeys<D> curve;
  for (const auto& [frame, value] : points) {
    Key<D> key;
    key.frame = frame;
    key.value.fill(value);
    curve.keys.push_back(key);
  }
  return curve;
}

TEST_CASE("a whole curve is given", "[document]") {
  // Keys at old frames keep their bytes and comments.
  CurveKeys<1> curve = curve_of<1>({{1, 1}, {12, 4}, {30, 2}});
  curve.keys[1].in = curve.keys[1].out = {.kind = Tangent<1>::Kind::Flat};
  const std::string text = after(shot, {edit::SetCurve{"poke.forceRadius", curve}});
  const std::string keys =
      shot.substr(shot.find("\n\n      <key frame=\"24\""),
                  shot.find("\n    </animate>") - shot.find("\n\n      <key frame=\"24\""));
  CHECK(text == with(with(shot, keys, "\n      <key frame=\"30\" value=\"2\"/>"),
                     "frame=\"12\" value=\"2.50\"", "frame=\"12\" value=\"4\""));
  CHECK(document_of(text).scene().forces[0].force_radius.curve().keys() == curve);
  // A constant becomes a curve.
  CHECK(after(shot, {edit::SetCurve{"bulge.center", curve_of<3>({{1, 2}})}}) ==
        with(shot, "<radial name=\"bulge\" center=\"1 2  3\"/>",
             "<radial name=\"bulge\">\n    <animate attribute=\"center\">\n      <key frame=\"1\" "
             "value=\"2 2 2\"/>\n    </animate>\n  </radial>"));
  // Loops come, change and go.
  CurveKeys<1> looping = document_of(every_number).scene().forces[0].magnitude.curve().keys();
  looping.loop->after = 3;
  const std::string more = after(every_number, {edit::SetCurve{"f.magnitude", looping}});
  CHECK(more == with(every_number, "after=\"1\"", "after=\"3\""));
  looping.loop.reset();
  const std::string none = after(more, {edit::SetCurve{"f.magnitude", looping}});
  CHECK(none == with(more, "<loop from=\"3\" to=\"8\" after=\"3\" offset=\"9\"/>", ""));
  looping.loop = Loop<1>{1, 8, 0, 2, {0.5}};
  SceneDocument document = document_of(none);
  REQUIRE(document.apply({edit::SetCurve{"f.magnitude", looping}}));
  CHECK(document.scene().forces[0].magnitude.curve().keys() == looping);
  // What the channel cannot have.
  CHECK_THAT(refusal(shot, {edit::SetCurve{"poke.magnitude", curve_of<3>({{1, 2}})}}),
             contains_text("single numbers"));
  CHECK_THAT(refusal(shot, {edit::SetCurve{"poke.center", curve_of<1>({{1, 2}})}}),
             contains_text("vectors of three numbers"));
  CHECK_THAT(refusal(shot, {edit::SetCurve{"poke.magnitude", CurveKeys<1>{}}}),
             contains_text("poke.magnitude"));
  CHECK_THAT(refusal(shot, {edit::SetCurve{"sheet.columns", curve_of<1>({{1, 2}})}}),
             contains_text("cannot be animated"));
}

TEST_CASE("a piece takes the place of keys", "[document]") {
  // Keys outside keep their bytes and comments; one at an old frame is written in its place.
  const edit::Splice recorded{"poke.forceRadius", 10, 25, curve_of<1>({{11, 3}, {24, 2}})};
  CHECK(after(shot, {recorded}) ==
        with(with(shot, "      <key frame=\"12\" value=\"2.50\" tangent=\"flat\"/>",
                  "      <key frame=\"11\" value=\"3\"/>"),
             "value=\"1\" interpolation=\"step\"", "value=\"2\""));
  // An automatic tangent that would change becomes a number.
  const std::string automatic = with(with(shot, " interpolation=\"step\"", ""), "value=\"3e0\"/>",
                                     "value=\"3e0\"/>\n      <key frame=\"40\" value=\"3.5\"/>");
  const std::string text =
      after(automatic, {edit::Splice{"poke.forceRadius", 10, 25, curve_of<1>({{20, 3}})}});
  CHECK_THAT(text, contains_text("<key frame=\"36\" value=\"3e0\" out=\"0.1"));
  CHECK_THAT(text, contains_text("<key frame=\"1\" value=\"1.0\"/> <!-- start -->"));
  // A constant becomes the piece alone.
  const auto piece = curve_of<3>({{1, 2}, {4, 3}});
  CHECK(after(shot, {edit::Splice{"bulge.center", 1, 4, piece}}) ==
        after(shot, {edit::SetCurve{"bulge.center", piece}}));
  // A whole curve, with the sides that it had.
  const std::string repeating =
      with(shot, "attribute=\"forceRadius\"", "attribute=\"forceRadius\" after=\"repeat\"");
  const auto keys =
      document_of(after(repeating,
                        {edit::Splice{"poke.forceRadius", 0, 50, curve_of<1>({{2, 2}, {4, 3}})}}))
          .scene()
          .forces[0]
          .force_radius.curve()
          .keys();
  CHECK(keys.keys == curve_of<1>({{2, 2}, {4, 3}}).keys);
  CHECK(keys.after.kind == Extrapolation<1>::Kind::Repeat);

  // What the channel cannot have.
  const auto refused = [](const std::string& of, const std::string& channel, double first,
                          double last, const std::variant<CurveKeys<1>, CurveKeys<3>>& keys) {
    return refusal(of, {edit::Splice{channel, first, last, keys}});
  };
  CHECK(refused(shot, "poke.forceRadius", 10, 25, curve_of<1>({{26, 3}})) ==
        "shot.xml: error: poke.forceRadius: the piece has a key at frame 26; it must be from frame "
        "10 to 25");
  CHECK_THAT(refused(shot, "poke.magnitude", 10, 25, curve_of<1>({{9, 3}})),
             contains_text("it must be from frame 10 to 25"));
  CHECK_THAT(refused(shot, "poke.magnitude", 9, 1, curve_of<1>({{9, 3}})),
             contains_text("must not come before first"));
  CHECK_THAT(refused(shot, "poke.magnitude", 1, 2, curve_of<3>({{1, 2}})),
             contains_text("single numbers"));
  CHECK_THAT(refused(shot, "poke.forceRadius", 1, 2, CurveKeys<1>{}),
             contains_text("poke.forceRadius"));
  CHECK_THAT(refused(shot, "poke.center.x", 1, 2, curve_of<1>({{1, 2}})),
             contains_text("cannot be animated"));
  CHECK_THAT(refused(shot, "nobody.center", 1, 2, curve_of<1>({{1, 2}})),
             contains_text("nothing is named"));
  const std::string other =
      "<scene start=\"1\" end=\"9\"><surface name=\"s\"><grid columns=\"5\" rows=\"5\"/>"
      "<tangents su0=\"1\"><animate attribute=\"sv0\"><key frame=\"1\" value=\"1\"/></animate>"
      "</tangents></surface><point name=\"f\"><falloff><key at=\"0\" value=\"1\"/></falloff>"
      "<path attribute=\"center\"><waypoint at=\"0 0 0\"/><waypoint at=\"1 0 0\"/>"
      "<waypoint at=\"1 1 0\"/></path></point></scene>";
  CHECK_THAT(refused(other, "f.center", 1, 2, curve_of<3>({{1, 2}})),
             contains_text("f.center follows a path; its keys are those of f.center.progress"));
  CHECK_THAT(refused(other, "f.falloff", 0, 1, curve_of<1>({{1, 2}})),
             contains_text("cannot be animated"));
  CHECK_THAT(refused(other, "s.sv0", 1, 2, curve_of<3>({{1, 2}})),
             contains_text("s.sv0: its keys have single numbers, those of the piece vectors"));
  CHECK_THAT(after(other, {edit::Splice{"f.center.progress", 1, 4, curve_of<1>({{1, 0}, {4, 1}})}}),
             contains_text("<animate attribute=\"progress\">"));
}

TEST_CASE("a part of a surface is set as a whole, with its comment", "[document]") {
  const edit::SetPart soft{"sheet", "material", {{"density", "4"}, {"b", "2"}}, "Soft:\nsags."};
  const std::string once = after(shot, {soft});
  CHECK(once == with(shot, "    <solver",
                     "    <!-- Soft:\n         sags. -->\n    <material density=\"4\" b=\"2\"/>\n"
                     "    <solver"));
  const edit::SetPart hard{"sheet", "material", {{"damping", "9"}}, "Hard."};
  CHECK(after(once, {hard}) == with(with(once, "Soft:\n         sags.", "Hard."),
                                    "density=\"4\" b=\"2\"", "damping=\"9\""));
  // A comment at the end of another element's line is that element's.
  const std::string trailing =
      with(once, "<!-- Soft:\n         sags. -->\n    <material", "<material");
  const std::string beside = with(trailing, "<grid columns=\"5\" rows=\"5\"/>",
                                  "<grid columns=\"5\" rows=\"5\"/> <!-- g -->");
  CHECK_THAT(after(beside, {hard}),
             contains_text("<!-- g -->\n    <!-- Hard. -->\n    <material damping"));
  CHECK_THAT(refusal(shot, {edit::SetPart{"poke", "material", {}}}),
             contains_text("is not a surface"));
  CHECK_THAT(refusal(shot, {edit::SetPart{"sheet", "grid", {}}}),
             contains_text("allowed: transform, material, tangents, solver"));
  CHECK_THAT(refusal(shot, {edit::SetPart{"sheet", "material", {}, "a -- b"}}),
             contains_text("must not contain --"));
}

TEST_CASE("keys with a $ stay, unless they would have to change", "[document]") {
  const std::string text =
      "<scene start=\"1\" end=\"9\">\n  <define name=\"far\" value=\"2\"/>\n"
      "  <surface name=\"s\"><grid columns=\"5\" rows=\"5\"/></surface>\n"
      "  <point name=\"f\" center=\"$far 0 0\">\n    <animate attribute=\"magnitude\">\n"
      "      <key frame=\"1\" value=\"1\"/>\n      <key frame=\"5\" value=\"$far * 2\"/>\n"
      "      <key frame=\"$far * 4\" value=\"7\"/>\n    </animate>\n"
      "    <animate attribute=\"forceRadius\" tangent=\"$far\">\n"
      "      <key frame=\"1\" value=\"1\"/>\n    </animate>\n  </point>\n</scene>\n";
  const auto keys = [](std::vector<double> frames) {
    return std::vector{edit::KeysOf{"f.magnitude", std::move(frames)}};
  };
  CHECK(after(text, {edit::MoveKeys{keys({1}), 1, {3}}}) ==
        with(text, "<key frame=\"1\" value=\"1\"/>\n      <key",
             "<key frame=\"2\" value=\"4\"/>\n      <key"));
  CHECK(after(text, {edit::MoveKeys{keys({5}), 1}}) == with(text, "frame=\"5\"", "frame=\"6\""));
  CHECK(after(text, {edit::MoveKeys{keys({8}), 0, {1}}}) ==
        with(text, "value=\"7\"", "value=\"8\""));
  CHECK(after(text, {edit::DeleteKeys{keys({5})}}) ==
        with(text, "      <key frame=\"5\" value=\"$far * 2\"/>\n", ""));
  CHECK(after(text, {edit::SetKey{"f.magnitude", 5, "6"}}) == with(text, "$far * 2", "6"));
  CHECK(after(text, {edit::ScaleKeys{keys({1, 5}), 1, 1.25}}) ==
        with(text, "frame=\"5\"", "frame=\"6\""));
  CHECK(refusal(text, {edit::ScaleKeys{keys({5}), 0, 1, {}, {2}}}) ==
        refusal(text, {edit::MoveKeys{keys({5}), 0, {1}}}));
  CHECK(refusal(text, {edit::MoveKeys{keys({5}), 0, {1}}}) ==
        "shot.xml: error: f.magnitude: the value with $ in line 7: <key> value=\"$far * 2\" would "
        "have to change; change what it stands for, or set a number in its place first");
  for (const Operation& operation :
       {Operation(edit::MoveKeys{keys({8}), 1}), Operation(edit::Scale{{"f.magnitude"}, 2})})
    CHECK_THAT(refusal(text, {operation}), contains_text("the value with $ in line"));
  CHECK_THAT(refusal(text, {edit::Scale{{"f.center"}, 2}}), contains_text("no multiples"));
  CHECK_THAT(refusal(text, {edit::Scale{{"f.forceRadius"}, 2}}),
             contains_text("its <animate> has a value with $"));
  // A piece has numbers; what it does not replace stays.
  CHECK(after(text, {edit::Splice{"f.magnitude", 1, 6, curve_of<1>({{5, 9}})}}) ==
        with(with(text, "      <key frame=\"1\" value=\"1\"/>\n      <key frame=\"5\"",
                  "      <key frame=\"5\""),
             "$far * 2", "9"));
  // A curve that is given as a whole has numbers.
  CHECK(after(text, {edit::SetCurve{"f.magnitude", curve_of<1>({{1, 1}, {5, 9}, {8, 7}})}}) ==
        with(text, "$far * 2", "9"));
  CHECK_THAT(after(text, {edit::SetCurve{"f.forceRadius", curve_of<1>({{1, 3}})}}),
             contains_text("<animate attribute=\"forceRadius\">\n      <key "
                           "frame=\"1\" value=\"3\"/>"));
}

}  // namespace
}  // namespace pliant::testing
