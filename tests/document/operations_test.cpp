// What each operation does to the text, byte by byte.

#include <string>
#include <vector>

#include "pliant/document/document.hpp"
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
  CHECK_THAT(refusal(two, {edit::Delete{{"sheet"}}}),
             contains_text("poke would act on all surfaces without it"));
  const std::string gone = after(two, {edit::Delete{{"sheet", "poke"}}});
  CHECK(gone.find("sheet") == std::string::npos);
  CHECK(gone.find("<!-- what pushes -->") != std::string::npos);
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

TEST_CASE("a refusal is what validate would say of the file", "[document]") {
  CHECK(refusal(shot, {edit::Set{"poke.magnitude", "1,5"}}) ==
        "shot.xml:11: error: <point> magnitude=\"1,5\": not a number: \",5\" follows 1 (write the "
        "decimal point as \".\")");
  CHECK_THAT(refusal(shot, {edit::Set{"poke.magnitud", "1"}}),
             contains_text("poke has no attribute \"magnitud\"; did you mean \"magnitude\"?"));
  CHECK_THAT(refusal(shot, {edit::Set{"pok.magnitude", "1"}}),
             contains_text("no surface, force or group is named \"pok\"; did you mean \"poke\"?"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke", "1"}}), contains_text("is not a path"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.name", "a"}}), contains_text("changed by a rename"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.center.progress", "1"}}),
             contains_text("poke.center follows no path"));
  CHECK_THAT(refusal(shot, {edit::Set{"poke.forceRadius.x", "1"}}), contains_text("no attribute"));
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

}  // namespace
}  // namespace pliant::testing
