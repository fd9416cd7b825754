#include "pliant/exchange/curve_file.hpp"

#include "exchange/round_trips.hpp"
#include "pliant/exchange/scene_curves.hpp"
#include "pliant/scene/read.hpp"

namespace pliant {
namespace {

using namespace testing;

TEST_CASE("the ending of a file says its format", "[exchange][file]") {
  CHECK(curve_format_of("a/walk.ANIM") == CurveFormat::Maya);
  CHECK(curve_format_of("walk.gltf") == CurveFormat::Gltf);
  CHECK(curve_format_of("walk.glb") == CurveFormat::Gltf);
  CHECK(curve_format_of("walk.json") == CurveFormat::Blender);
  CHECK_FALSE(curve_format_of("walk.fbx").has_value());
  const auto none = read_curves("walk.fbx", {});
  REQUIRE_FALSE(none.has_value());
  CHECK(to_lines(none.error())[0] ==
        "walk.fbx: error: no format of curves has the ending \".fbx\"; allowed: .json, .gltf, "
        ".glb, .anim");
}

const std::string scene_text = R"(<?xml version="1.0" encoding="UTF-8"?>
<scene version="1" fps="24" start="1" end="48">
  <!-- the sheet -->
  <surface name="sheet">
    <grid columns="9" rows="9"/>
    <material density="40"
              damping="2"/>
  </surface>
  <point name="poke" center="-3 0 0" magnitude="12" deformationRadius="2"/>
  <line name="crease" deformationRadius="2">
    <animate attribute="magnitude">
      <key frame="1" value="0"/>
    </animate>
  </line>
  <group name="both" deformationRadius="3"><radial name="bulge"/></group>
</scene>
)";

Scene scene() { return parse_scene(scene_text, "shot.xml", "").value(); }

CurveFile file_of(const std::vector<std::string>& names) {
  CurveFile file;
  for (const std::string& name : names) {
    FileCurve curve{.name = name, .group = name};
    const std::size_t dot = name.rfind('.');
    const char last = name.back();
    if (dot + 2 == name.size() && last >= 'x' && last <= 'z') {
      curve.component = last - 'x';
      curve.group = name.substr(0, dot);
    }
    curve.keys.keys = {key(1, 0), key(24, 1), key(48, 3)};
    file.curves.push_back(curve);
  }
  return file;
}

Result<PlacedCurves> place(const CurveFile& file, const std::vector<std::string>& mappings,
                           double offset = 0) {
  std::vector<CurveMapping> parsed;
  for (const std::string& text : mappings) parsed.push_back(parse_mapping(text).value());
  const Scene own = scene();
  return place_curves(file, parsed, &own, offset, 1e-4);
}

TEST_CASE("a mapping names curve, channel, component and factor", "[exchange][file]") {
  const auto mapping = parse_mapping("Cube[\"a=b\"].x=poke.center.y*-0.5");
  REQUIRE(mapping.has_value());
  CHECK(mapping->source == "Cube[\"a=b\"].x");
  CHECK(mapping->channel == "poke.center");
  CHECK(mapping->component == 1);
  CHECK(mapping->factor == -0.5);
  CHECK(parse_mapping("a=poke.center.progress")->channel == "poke.center.progress");
  CHECK(parse_mapping("a=poke.center.progress")->component == -1);
  for (const char* text : {"poke.magnitude", "=poke.magnitude", "a=", "a=poke", "a=poke.",
                           "a=poke.m*", "a=poke.m*0", "a=poke.m*x"}) {
    CAPTURE(text);
    REQUIRE_FALSE(parse_mapping(text).has_value());
    CHECK_THAT(parse_mapping(text).error().message, contains_text(std::string("--map ") + text));
  }
}

TEST_CASE("curves go to channels", "[exchange][file]") {
  const CurveFile file =
      file_of({"Cube.location.x", "Cube.location.y", "Cube.location.z", "Cube.power"});
  const auto placed = place(file,
                            {"Cube.location=poke.center*2", "Cube.power=poke.magnitude*100",
                             "Cube.location.y=crease.from.z"},
                            10);
  INFO((placed ? "" : placed.error().message));
  REQUIRE(placed.has_value());
  REQUIRE(placed->curves.size() == 3);
  const Curve<3> center = Curve<3>::make(std::get<CurveKeys<3>>(placed->curves[0].keys)).value();
  CHECK(center.value(58)[2] == 6);
  const Curve<1> magnitude = Curve<1>::make(std::get<CurveKeys<1>>(placed->curves[1].keys)).value();
  CHECK(magnitude.value(34)[0] == 100);
  CHECK(magnitude.value(11)[0] == 0);
  const Curve<3> from = Curve<3>::make(std::get<CurveKeys<3>>(placed->curves[2].keys)).value();
  CHECK(from.value(58)[2] == 3);
  CHECK(from.value(58)[0] == 0);
}

TEST_CASE("a component that is not mapped keeps the scene's value", "[exchange][file]") {
  const auto placed = place(file_of({"Cube.power"}), {"Cube.power=poke.center.y"});
  REQUIRE(placed.has_value());
  const Curve<3> center = Curve<3>::make(std::get<CurveKeys<3>>(placed->curves[0].keys)).value();
  CHECK(center.value(48) == Value<3>{-3, 3, 0});
}

TEST_CASE("a component that is not mapped keeps the scene's curve", "[exchange][file]") {
  std::string text(scene_text);
  const std::size_t at = text.find("<material");
  text.insert(at,
              "<animate attribute=\"translate\"><key frame=\"1\" value=\"0 0 7\"/>"
              "<key frame=\"10\" value=\"1 2 7\"/></animate>");
  const Scene own = parse_scene(text, "shot.xml", "").value();
  const auto placed =
      place_curves(file_of({"Cube.power"}), {parse_mapping("Cube.power=sheet.translate.y").value()},
                   &own, 0, 1e-6);
  REQUIRE(placed.has_value());
  const Curve<3> joined = Curve<3>::make(std::get<CurveKeys<3>>(placed->curves[0].keys)).value();
  const Curve<1> mapped = Curve<1>::make(file_of({"Cube.power"}).curves[0].keys).value();
  for (const double frame : {-3.0, 1.0, 4.0, 7.5, 10.0, 24.0, 31.0, 48.0, 60.0}) {
    CAPTURE(frame);
    const Value<3> value = joined.value(frame);
    CHECK_THAT(value[0], WithinAbs(own.surfaces[0].transform.translate.at(frame)[0], 1e-5));
    CHECK_THAT(value[1], WithinAbs(mapped.value(frame)[0], 1e-5));
    CHECK(value[2] == 7);
  }
}

TEST_CASE("problems of a mapping name it", "[exchange][file]") {
  const CurveFile file = file_of({"Cube.location.x", "Cube.location.y", "Cube.power"});
  const auto problem = [&](const std::vector<std::string>& mappings) {
    const auto placed = place(file, mappings);
    return placed ? "" : placed.error().message;
  };
  CHECK_THAT(
      problem({"Cube.powr=poke.magnitude"}),
      contains_text("--map Cube.powr=poke.magnitude: the file has no such curve; did you mean "
                    "\"Cube.power\"?"));
  CHECK_THAT(problem({"Cube.power=pike.magnitude"}), contains_text("nothing is named \"pike\""));
  CHECK_THAT(problem({"Cube.power=poke.center"}), contains_text("name one of its components"));
  CHECK_THAT(problem({"Cube.power=poke.magnitude.x"}), contains_text("a number, not a vector"));
  CHECK_THAT(problem({"Cube.location=poke.center.x"}), contains_text("names several"));
  CHECK_THAT(problem({"Cube.power=poke.magnitude", "Cube.location.x=poke.magnitude"}),
             contains_text("was mapped before"));
  CHECK_THAT(problem({"Cube.power=poke.enabled"}), contains_text("a switch is 0 or 1, but key 48"));
}

TEST_CASE("names that are channels of the scene need no mapping", "[exchange][file]") {
  const Scene own = scene();
  const auto mappings = mappings_by_name(
      file_of({"poke.center.x", "poke.magnitude", "crease.translation.x", "sheet.translation.y",
               "sheet.density.translation.x", "sheet.density.translation.y", "Cube.location.x"}),
      own);
  std::vector<std::string> texts;
  for (const CurveMapping& mapping : mappings)
    texts.push_back(fmt::format("{}={} {}", mapping.source, mapping.channel, mapping.component));
  CHECK(texts == std::vector<std::string>{"poke.center.x=poke.center 0",
                                          "poke.magnitude=poke.magnitude -1",
                                          "sheet.translation.y=sheet.translate 1",
                                          "sheet.density.translation.x=sheet.density -1"});
}

TEST_CASE("curves stand in the text where their channels do", "[exchange][file]") {
  const CurveFile file = file_of({"a", "b"});
  const auto placed = place(file, {"a=poke.magnitude", "b=sheet.damping", "a=crease.magnitude",
                                   "b=sheet.translate.y", "a=bulge.magnitude"});
  REQUIRE(placed.has_value());
  const auto text = with_curves(scene_text, "shot.xml", "", "", *placed);
  INFO((text ? *text : text.error().message));
  REQUIRE(text.has_value());
  const std::string keys = R"(<key frame="1" value="0"/>
      <key frame="24" value="1"/>
      <key frame="48" value="3"/>
    </animate>)";
  CHECK_THAT(*text, contains_text(R"(<point name="poke" center="-3 0 0" deformationRadius="2">
    <animate attribute="magnitude">
      )" + keys + "\n  </point>"));
  CHECK_THAT(*text, contains_text(R"(<line name="crease" deformationRadius="2">
    <animate attribute="magnitude">
      )" + keys + "\n  </line>"));
  CHECK_THAT(*text,
             contains_text("<material density=\"40\">\n      <animate attribute=\"damping\">"));
  CHECK_THAT(*text, contains_text("    <transform>\n      <animate attribute=\"translate\">"));
  CHECK_THAT(*text, contains_text("  <!-- the sheet -->\n"));
  const auto changed = parse_scene(*text, "shot.xml", "");
  REQUIRE(changed.has_value());
  CHECK(changed->forces[0].magnitude.at(48) == Value<1>{3});
  CHECK(changed->forces[2].magnitude.at(24) == Value<1>{1});
  CHECK(changed->surfaces[0].transform.translate.at(48) == Value<3>{0, 3, 0});
  // Again: the same text.
  CHECK(with_curves(*text, "shot.xml", "", "", *placed).value() == *text);
}

TEST_CASE("an empty element gets its curve between its tags", "[exchange][file]") {
  const std::string text =
      "<scene version=\"1\" start=\"1\" end=\"2\"><surface name=\"s\"><grid columns=\"3\" "
      "rows=\"3\"/>"
      "</surface><point name=\"poke\"></point></scene>";
  const Scene own = parse_scene(text, "shot.xml", "").value();
  const auto placed =
      place_curves(file_of({"a"}), {parse_mapping("a=poke.magnitude").value()}, &own, 0, 1e-4);
  const auto changed = with_curves(text, "shot.xml", "", "", *placed);
  INFO((changed ? "" : changed.error().message));
  REQUIRE(changed.has_value());
  CHECK(parse_scene(*changed, "shot.xml", "")->forces[0].magnitude.at(48) == Value<1>{3});
}

TEST_CASE("a curve beyond the range of its channel changes nothing", "[exchange][file]") {
  CurveFile file = file_of({"a"});
  const auto placed = place(file, {"a=poke.deformationRadius*-1"});
  REQUIRE(placed.has_value());
  CHECK_THAT(with_curves(scene_text, "shot.xml", "", "", *placed).error().message,
             contains_text("deformationRadius"));
}

TEST_CASE("line ends and indentation of the file stay", "[exchange][file]") {
  std::string text;
  for (const char c : scene_text) {
    if (c == '\n') text += '\r';
    text += c;
  }
  const auto placed = place(file_of({"a"}), {"a=poke.magnitude"});
  const auto changed = with_curves(text, "shot.xml", "", "", *placed);
  REQUIRE(changed.has_value());
  CHECK(std::count(changed->begin(), changed->end(), '\n') ==
        std::count(changed->begin(), changed->end(), '\r'));
}

TEST_CASE("a curve that breaks a rule of the scene changes nothing", "[exchange][file]") {
  CurveFile file = file_of({"a"});
  file.curves[0].keys.keys[1].value[0] = -7;
  PlacedCurves curves;
  curves.curves.push_back({"poke.nothing", file.curves[0].keys});
  const auto wrong = with_curves(scene_text, "shot.xml", "", "", curves);
  REQUIRE_FALSE(wrong.has_value());
  CHECK_THAT(
      wrong.error().message,
      contains_text("the scene cannot have the curves: \"poke\" has no attribute \"nothing\""));
  curves.curves[0].channel = "pike.magnitude";
  CHECK_THAT(with_curves(scene_text, "shot.xml", "", "", curves).error().message,
             contains_text("nothing is named \"pike\""));
}

TEST_CASE("elements can be had without a scene", "[exchange][file]") {
  const auto placed = place_curves(
      file_of({"a", "b.x"}),
      {parse_mapping("a=new.magnitude").value(), parse_mapping("b.x=new.center.z").value()},
      nullptr, 0, 1e-4);
  REQUIRE(placed.has_value());
  const std::string text = animate_elements(*placed);
  CHECK_THAT(text, contains_text("<!-- new -->\n<animate attribute=\"magnitude\">"));
  CHECK_THAT(text, contains_text("<key frame=\"48\" value=\"0 0 3\"/>"));
}

TEST_CASE("the channels of a scene as curves", "[exchange][file]") {
  const Scene own = scene();
  const auto all = curves_of(own);
  REQUIRE(all.has_value());
  REQUIRE(all->size() == 1);
  CHECK((*all)[0].channel == "crease.magnitude");
  CHECK_THAT(curves_of(own, {"poke.magnitude"}).error().message, contains_text("is constant"));
  CHECK_THAT(curves_of(own, {"poke.magnitud"}).error().message,
             contains_text("has no attribute \"magnitud\""));
  CHECK_THAT(curves_of(own, {"poke.strength"}).error().message,
             contains_text("did you mean \"magnitude\"?"));
}

}  // namespace
}  // namespace pliant
