#include "pliant/scene/sharing/expand.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/scene/write.hpp"
#include "scene/scene_text.hpp"
#include "support/sanitized.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

/// A scene shot.xml and the files beside it.
class Shot {
 public:
  explicit Shot(std::string_view body) { write("shot.xml", scene_with(body)); }
  Shot& write(const std::string& name, std::string_view text) {
    std::filesystem::create_directories(folder_.file(name).parent_path());
    folder_.write(name, text);
    return *this;
  }
  /// A file with these elements.
  Shot& fragment(const std::string& name, std::string_view content) {
    return write(name, fmt::format("<fragment>\n{}\n</fragment>\n", content));
  }

  std::string path(std::string_view name = "shot.xml") const { return folder_.file(name).string(); }
  const ScratchFolder& folder() const { return folder_; }

  Result<Scene> load(const std::string& root = {}) const { return load_scene(path(), root); }

  Scene scene() const {
    const Result<Scene> scene = load();
    if (!scene)
      for (const std::string& line : to_lines(scene.error())) UNSCOPED_INFO(line);
    REQUIRE(scene);
    return *scene;
  }

  /// `FILE:LINE: MESSAGE` of each problem, with names as from the folder.
  std::vector<std::string> problems(const std::string& root = {}) const {
    const Result<Scene> scene = load(root);
    if (scene) return {};
    std::vector<std::string> lines;
    for (std::string line : to_lines(scene.error())) {
      for (const auto& prefix : {folder_.path().string() + "/", std::string("error: ")})
        for (std::size_t at; (at = line.find(prefix)) != std::string::npos;)
          line.erase(at, prefix.size());
      lines.push_back(line);
    }
    return lines;
  }

 private:
  ScratchFolder folder_;
};

using Lines = std::vector<std::string>;

constexpr std::string_view sheet_xml =
    "<surface name=\"sheet\"><grid columns=\"5\" rows=\"4\"/></surface>";

double width_of(const Scene& scene) { return std::get<GridSheet>(scene.surfaces[0].shape).width; }

/// A sheet whose grid has this width, after these definitions.
std::string sheet_of(std::string_view width, std::string_view definitions = {}) {
  return fmt::format(
      "{}<surface name=\"sheet\"><grid columns=\"5\" rows=\"4\" width=\"{}\"/></surface>",
      definitions, width);
}

std::string define(std::string_view name, std::string_view value) {
  return fmt::format("<define name=\"{}\" value=\"{}\"/>", name, value);
}

TEST_CASE("an include is replaced by what the file contains", "[scene][expand]") {
  const std::string uncut =
      to_xml(scene_of(scene_with(
                 "<surface name=\"sheet\"><grid columns=\"5\" rows=\"4\"/>"
                 "<material density=\"3\"><map channel=\"b\" file=\"b.png\"/></material></surface>"
                 "<group name=\"g\"><point name=\"p\"><animate attribute=\"magnitude\"><key "
                 "frame=\"1\" "
                 "value=\"2\"/></animate></point></group>")),
             "shots")
          .value();
  Shot shot("<include file=\"surface.xml\"/><include file=\"group.xml\"/>");
  shot.write(
      "surface.xml",
      "<?xml version=\"1.0\"?><!-- alone --><surface name=\"sheet\"><include file=\"parts.xml\"/>"
      "</surface>");
  shot.fragment(
      "parts.xml",
      "<grid columns=\"5\" rows=\"4\"/><material density=\"3\"><include file=\"map.xml\"/>"
      "</material>");
  shot.write("map.xml", "\xEF\xBB\xBF<map channel=\"b\" file=\"b.png\"/>");
  shot.write("group.xml",
             "<scene version=\"9\" nonsense=\"yes\"><group name=\"g\"><include "
             "file=\"force.xml\"/></group>"
             "</scene>");
  shot.write("force.xml", "<point name=\"p\"><include file=\"keys.xml\"/></point >");
  shot.write(
      "keys.xml",
      "<animate attribute=\"magnitude\"><key frame=\"1\" value=\"2\"/></animate\n>\n<!-- end -->");
  CHECK(to_xml(shot.scene(), shot.folder().path()).value() == uncut);
  shot.write("keys.xml", "<fragment></fragment>").write("map.xml", "<fragment/>");
  CHECK(shot.scene().surfaces[0].maps.empty());
}

TEST_CASE("a definition stands for its value", "[scene][expand]") {
  CHECK(width_of(Shot(sheet_of("$w", define("w", "7"))).scene()) == 7);
  CHECK(width_of(Shot(sheet_of("${w}", define("w", "7"))).scene()) == 7);
  CHECK(width_of(Shot(sheet_of("${w}1", define("w", "7"))).scene()) == 71);
  CHECK(width_of(Shot(sheet_of("($w + 1) * 2", define("w", "7"))).scene()) == 16);
  CHECK(width_of(Shot(sheet_of("$w", define("w", "1 / 8"))).scene()) == 0.125);
  CHECK(width_of(Shot(sheet_of("$w ÷ $h", define("h", "4") + define("w", "$h × $h"))).scene()) ==
        4);
  CHECK(width_of(Shot(sheet_of("&#36;w&#x2a;2", define("w", "7"))).scene()) == 14);
  CHECK(width_of(Shot(sheet_of("\n 1 +\n $w\n", define("w", "\n7\n"))).scene()) == 8);

  const Scene whole =
      Shot(
          "<define name=\"at\" value=\"1 2 3\"/><define name=\"who\" value=\"sheet\"/>"
          "<define name=\"a\" value=\"$at * 2\"/><define name=\"n\" value=\"5\"/>" +
          std::string(sheet_xml) +
          "<point name=\"${who}_poke\" targets=\"$who\" center=\"$a\"/>"
          "<line name=\"l\" from=\"$at - $a\" to=\"1 -$n $n-1\"/>")
          .scene();
  CHECK(whole.forces[0].name == "sheet_poke");
  CHECK(whole.forces[0].targets == std::vector<std::string>{"sheet"});
  CHECK(std::get<PointChannels>(whole.forces[0].kind).center.channel()->at(1) == Value<3>{2, 4, 6});
  const auto& line = std::get<LineChannels>(whole.forces[1].kind);
  CHECK(line.from.channel()->at(1) == Value<3>{-1, -2, -3});
  CHECK(line.to.channel()->at(1) == Value<3>{1, -5, 4});
}

TEST_CASE("a text is not computed", "[scene][expand]") {
  const Scene scene =
      Shot(define("date", "2024-10-05") + define("take", "03") +
           "<surface name=\"s\"><mesh file=\"$date/$take\" object=\"a$$b$take\"/></surface>")
          .scene();
  const auto& mesh = std::get<MeshFile>(scene.surfaces[0].shape);
  CHECK(std::filesystem::path(mesh.path).parent_path().filename() == "2024-10-05");
  CHECK(std::filesystem::path(mesh.path).filename() == "03");
  CHECK(mesh.object == "a$b03");
  const std::string written = to_xml(scene).value();
  CHECK_THAT(written, contains_text("object=\"a$$b03\""));
  const Scene again = parse_scene(written, "again.xml", "").value();
  CHECK(std::get<MeshFile>(again.surfaces[0].shape).object == "a$b03");
  // Whole numbers are not rounded to a double.
  const auto seed = parse_scene(
      "<scene start=\"1\" end=\"2\" seed=\"18446744073709551615\"><define "
      "name=\"n\" value=\"18446744073709551615\"/><noise name=\"n\" "
      "seed=\"$n\"/></scene>",
      "a.xml", "");
  CHECK(std::get<NoiseChannels>(seed.value().forces[0].kind).seed == seed->seed);
}

TEST_CASE("definitions hold from their place on, and in what is included", "[scene][expand]") {
  Shot shot(define("w", "2") + "<include file=\"rig.xml\"/>");
  shot.fragment("rig.xml", sheet_of("$w"));
  CHECK(width_of(shot.scene()) == 2);  // from outside
  shot.fragment("rig.xml", sheet_of("$w", define("w", "3")));
  CHECK(width_of(shot.scene()) == 3);  // its own

  Shot given("<include file=\"rig.xml\"><!-- one --><define name=\"w\" value=\"4\"/></include>");
  given.fragment("rig.xml", sheet_of("$w", define("w", "3")));
  CHECK(width_of(given.scene()) == 4);  // given in the include
  given.fragment("rig.xml", sheet_of("$w"));
  CHECK(width_of(given.scene()) == 4);  // without one of its own
  given.fragment("rig.xml", sheet_of("$h", define("w", "3") + define("h", "$w * 2")));
  CHECK(width_of(given.scene()) == 8);  // in later ones
  given.fragment("rig.xml", "<include file=\"inner.xml\"/>");
  given.fragment("inner.xml", sheet_of("$w"));
  CHECK(width_of(given.scene()) == 4);  // in files that the file includes
  given.fragment("inner.xml", sheet_of("$w", define("w", "5")));
  CHECK(given.problems() ==
        Lines{"shot.xml:2: <define> name=\"w\": \"rig.xml\" neither defines nor uses it"});
  CHECK(given.fragment("inner.xml", sheet_of("3")).problems().size() == 1);

  // After an include what the file defined holds, unless the name is there.
  Shot after("<include file=\"sizes.xml\"/>" + sheet_of("$w"));
  after.fragment("sizes.xml", "<include file=\"more.xml\"/>")
      .fragment("more.xml", define("w", "6"));
  CHECK(width_of(after.scene()) == 6);
  Shot kept(define("w", "1") + "<include file=\"sizes.xml\"/>" + sheet_of("$w"));
  kept.fragment("sizes.xml", define("w", "6"));
  CHECK(width_of(kept.scene()) == 1);
  Shot first("<include file=\"a.xml\"/><include file=\"b.xml\"/>" + sheet_of("$w"));
  first.fragment("a.xml", define("w", "1")).fragment("b.xml", define("w", "2"));
  CHECK(width_of(first.scene()) == 1);
  Shot own("<include file=\"a.xml\"/>" + define("w", "3") + sheet_of("$w"));
  own.fragment("a.xml", define("w", "1"));
  CHECK(width_of(own.scene()) == 3);
  // One rig, two sizes: the value given holds after it too, and what stands elsewhere does not.
  Shot twice(
      "<include file=\"a.xml\"><define name=\"w\" value=\"8\"/><define name=\"n\" value=\"sheet\"/>"
      "</include><include file=\"a.xml\"><define name=\"w\" value=\"9\"/><define name=\"n\" "
      "value=\"other\"/></include>");
  twice.fragment(
      "a.xml", define("w", "1") + define("n", "x") +
                   "<surface name=\"$n\"><grid columns=\"3\" rows=\"3\" width=\"$w\"/></surface>");
  const Scene sizes = twice.scene();
  CHECK(width_of(sizes) == 8);
  CHECK(std::get<GridSheet>(sizes.surfaces[1].shape).width == 9);
}

TEST_CASE("paths are relative to the file that they stand in", "[scene][expand]") {
  Shot shot("<define name=\"set\" value=\"rigs\"/><include file=\"$set/head.xml\"/>");
  shot.write("rigs/head.xml",
             "<surface name=\"head\"><mesh file=\"../meshes/head.obj\" cache=\"a.pc2\"/>\n"
             "<include file=\"../looks/skin.xml\"/></surface>");
  shot.write("looks/skin.xml", "<material><map channel=\"b\" file=\"skin.png\"/></material>");
  const Surface surface = shot.scene().surfaces[0];
  const auto& mesh = std::get<MeshFile>(surface.shape);
  CHECK(mesh.path == shot.path("rigs/../meshes/head.obj"));
  CHECK(mesh.root == shot.path("rigs"));
  CHECK(surface.cache.path == shot.path("rigs/a.pc2"));
  CHECK(surface.maps[0].file == shot.path("rigs/../looks/skin.png"));
}

TEST_CASE("a problem is told in its file, with the chain of includes", "[scene][expand]") {
  Shot shot("<include file=\"rig.xml\"/>\n<point name=\"poke\" magnitde=\"1\"/>");
  shot.fragment("rig.xml", std::string(sheet_xml) +
                               "\n<include file=\"force.xml\"/>\n<radial name=\"sheet\"/>");
  shot.write("force.xml", "<!-- two\nlines --><point name=\"a\"\n  center=\"1 2\"/>");
  CHECK(
      shot.problems() ==
      Lines{
          "shot.xml:3: <point> has no attribute \"magnitde\"; did you mean \"magnitude\"? allowed: "
          "name, enabled, targets, magnitude, deformationRadius, forceRadius, falloff, follow, "
          "along, center, direction",
          "force.xml:3: <point> center=\"1 2\": three numbers are required, not 2 (separated by "
          "spaces); included by rig.xml:3, by shot.xml:2",
          "rig.xml:4: <radial> name=\"sheet\": the name is already used at line 2; surfaces, "
          "forces, "
          "groups and colliders must have different names; included by shot.xml:2"});
}

TEST_CASE("a message about two places names both files", "[scene][expand]") {
  Shot names(std::string(sheet_xml) + "\n<include file=\"rig.xml\"/>");
  names.write("rig.xml", "<radial name=\"sheet\"/>");
  CHECK(names.problems() ==
        Lines{"rig.xml:1: <radial> name=\"sheet\": the name is already used at line 2 of shot.xml; "
              "surfaces, forces, groups and colliders must have different names; included by "
              "shot.xml:3"});

  Shot twice("<include file=\"rig.xml\"/>\n<include file=\"rig.xml\"/>");
  twice.fragment("rig.xml", sheet_xml);
  CHECK(twice.problems() ==
        Lines{"rig.xml:2: <surface> name=\"sheet\": the name is already used at line 2 of rig.xml, "
              "included by shot.xml:2; surfaces, forces, groups and colliders must have different "
              "names; included "
              "by shot.xml:3"});

  Shot material(
      "<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/><include file=\"m.xml\"/>\n"
      "<material/><animate attribute=\"b\"><key frame=\"1\" value=\"1\"/></animate></surface>");
  material.write("m.xml", "<material b=\"2\"/>");
  CHECK(
      material.problems() ==
      Lines{"shot.xml:3: <surface> \"s\" has a second <material>; the first is at line 1 of m.xml, "
            "included by shot.xml:2",
            "shot.xml:3: <animate> attribute=\"b\": is already given (line 1 of m.xml, included by "
            "shot.xml:2); remove one of them"});
}

TEST_CASE("what cannot be included or made hides no other problem", "[scene][expand]") {
  // Nothing follows from what is missing: no shape, no keys, no name, no target.
  Shot shot(
      "<surface name=\"a\"><include file=\"none.xml\"/></surface>\n"
      "<surface name=\"$b\"><grid columns=\"5\" rows=\"$rows\" width=\"1,5\"/>\n"
      "<material density=\"$rho\"/><animate attribute=\"$what\"><key frame=\"1\" value=\"2\"/>\n"
      "</animate><animate attribute=\"damping\"><include file=\"keys.xml\"/></animate></surface>\n"
      "<point name=\"p\" targets=\"shet\" magnitde=\"3\"><path attribute=\"$at\">\n"
      "<waypoint at=\"0 0 0\"/><waypoint at=\"$to\"/><waypoint at=\"0 0 1\"/></path>\n"
      "<animate attribute=\"magnitude\"><key frame=\"$one\" value=\"$big\"/>\n"
      "<key frame=\"0\" value=\"2\" tangent=\"$t\"/></animate></point>");
  std::vector<std::string> told;
  for (const std::string& problem : shot.problems())
    told.push_back(problem.substr(0, problem.find("; ")));
  const auto undefined = [](int line, std::string_view what, std::string_view name) {
    return fmt::format("shot.xml:{}: {}=\"${}\": no definition of \"{}\" comes before it", line,
                       what, name, name);
  };
  std::ranges::sort(told);
  Lines expected{
      "shot.xml:2: <include> file=\"none.xml\": none.xml: cannot read the file: No such file or "
      "directory",
      "shot.xml:5: <animate> has no element \"include\"",
      undefined(3, "<surface> name", "b"),
      undefined(3, "<grid> rows", "rows"),
      "shot.xml:3: <grid> width=\"1,5\": not a number: \",5\" follows 1 (write the decimal point "
      "as \".\")",
      undefined(4, "<material> density", "rho"),
      undefined(4, "<animate> attribute", "what"),
      "shot.xml:6: <point> has no attribute \"magnitde\"",
      undefined(6, "<path> attribute", "at"),
      undefined(7, "<waypoint> at", "to"),
      undefined(8, "<key> frame", "one"),
      undefined(8, "<key> value", "big"),
      undefined(9, "<key> tangent", "t"),
  };
  std::ranges::sort(expected);
  CHECK(told == expected);

  // What an included file has wrong is told too.
  Shot rig(define("w", "1 / 0") + sheet_of("$w") + "<include file=\"rig.xml\"/>");
  rig.fragment("rig.xml",
               "<point name=\"p\" magnitude=\"$w\" targets=\"none\"/>\n<radial nme=\"r\"/>");
  const Lines problems = rig.problems();
  REQUIRE(problems.size() == 3);
  CHECK(problems[0] ==
        "shot.xml:2: <grid> width=\"$w\": it is divided by 0; $w is defined at line 2");
  CHECK(problems[1] ==
        "rig.xml:2: <point> magnitude=\"$w\": it is divided by 0; $w is defined at line 2 of "
        "shot.xml; included by shot.xml:2");
  CHECK(problems[2].starts_with("rig.xml:3: <radial> has no attribute \"nme\"; did you mean"));
}

TEST_CASE("a message about a value that definitions made tells where they are", "[scene][expand]") {
  const auto only = [](const Shot& shot) {
    const Lines problems = shot.problems();
    INFO(fmt::format("{}", fmt::join(problems, "\n")));
    REQUIRE(problems.size() == 1);
    return problems.front();
  };
  CHECK(only(Shot(sheet_of("$w", define("w", "-3") + "\n"))) ==
        "shot.xml:3: <grid> width=\"-3\": must be greater than 0; $w is defined at line 2");
  CHECK(only(Shot(sheet_of("$a - $b", define("a", "1") + "\n" + define("b", "4") + "\n"))) ==
        "shot.xml:4: <grid> width=\"-3\": must be greater than 0; $a is defined at line 2; $b is "
        "defined at line 3");
  // The file that the value comes from: of what is given, that of the <include>.
  Shot shot("<include file=\"sizes.xml\"/>" + sheet_of("$w"));
  shot.fragment("sizes.xml", define("w", "wide"));
  CHECK(only(shot) ==
        "shot.xml:2: <grid> width=\"wide\": not a number; $w is defined at line 2 of sizes.xml, "
        "included by shot.xml:2");
  Shot given("\n<include file=\"rig.xml\">\n" + define("w", "wide") + "</include>");
  given.fragment("rig.xml", sheet_of("$w", define("w", "2")));
  CHECK(only(given) ==
        "rig.xml:2: <grid> width=\"wide\": not a number; $w is defined at line 4 of shot.xml; "
        "included by shot.xml:3");
  // Those that a definition was made of come after it.
  CHECK(only(Shot(sheet_of("$w", define("a", "-2") + "\n" + define("w", "$a * 2") + "\n"))) ==
        "shot.xml:4: <grid> width=\"-4\": must be greater than 0; $w is defined at line 3; $a is "
        "defined at line 2");
  // Of several values on a line only the one that the message is about.
  CHECK(only(Shot(define("x", "x") + define("one", "1") +
                  "\n<point name=\"p\"><animate attribute=\"magnitude\"><key frame=\"$one\" "
                  "value=\"$one\"/><key frame=\"2\" value=\"$x\"/></animate></point>")) ==
        "shot.xml:3: <key> value=\"x\": not a number; $x is defined at line 2");
  // A rule between values has no value in quotes.
  CHECK(only(Shot(define("rho", "-1") + "\n<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/>"
                                        "<material density=\"$rho\"/></surface>"))
            .ends_with("; $rho is defined at line 2"));
}

TEST_CASE("a definition of its own name has the value from outside", "[scene][expand]") {
  for (const char* value : {"$w", "$w * 2", "${w}", "x$w"}) {
    const Lines problems = Shot(sheet_of("$w", define("w", value) + "\n")).problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("no definition of \"w\" comes before it") &&
                                !contains_text("there is one"));
  }
  Shot shot(define("w", "5") + "<include file=\"rig.xml\"/>");
  shot.fragment("rig.xml", sheet_of("$w", define("w", "$w * 2")));
  CHECK(width_of(shot.scene()) == 10);
  Shot given("<include file=\"rig.xml\">" + define("w", "$w") + "</include>");
  given.fragment("rig.xml", sheet_of("$w", define("w", "2")));
  REQUIRE(given.problems().size() == 1);
  CHECK_THAT(given.problems()[0], !contains_text("there is one"));
}

TEST_CASE("notes and origins name the file", "[scene][expand]") {
  Shot shot("<include file=\"rig.xml\"/>\n<point name=\"own\" magnitude=\"2\"/>");
  shot.fragment(
      "rig.xml",
      std::string(sheet_xml) +
          "\n<point name=\"poke\"><animate attribute=\"magnitude\"><key frame=\"1\" value=\"0\"/>\n"
          "<key frame=\"9\" value=\"1\" inLength=\"-1\"/></animate></point>");
  const Scene scene = shot.scene();
  REQUIRE(scene.notes.size() == 1);
  CHECK(scene.notes[0].file == shot.path("rig.xml"));
  CHECK(scene.notes[0].line == 4);
  CHECK_THAT(scene.notes[0].message,
             Catch::Matchers::EndsWith("; included by " + shot.path() + ":2"));
  CHECK(scene.origin.file == shot.path());
  const ScenePlace place = scene.origin.place_of("poke", "magnitude");
  CHECK(place.file == shot.path("rig.xml"));
  CHECK(place.line == 3);
  CHECK_FALSE(scene.origin.is_own("poke", "magnitude"));
  CHECK_FALSE(scene.origin.is_own("sheet"));
  CHECK(scene.origin.is_own("own", "magnitude"));
  CHECK(scene.origin.place_of("own", "magnitude").line == 3);
  CHECK(scene.origin.is_own(""));
  // Without an include nothing is different.
  const Scene plain = Shot(sheet_of("$w", define("w", "2"))).scene();
  CHECK(plain.origin.place_of("sheet").line == 2);
}

TEST_CASE("lines are kept by what is replaced", "[scene][expand]") {
  // Each force misspells an attribute in the line that it names.
  for (const std::string end : {"\n", "\r\n"}) {
    std::string body =
        "<define\n name=\"w\"\n value=\"1\n2\"\n/><point name=\"a\" x6=\"\"/>\n"
        "<point name=\"b\" center=\"$w\n 3\" x8=\"\"\n  x9=\"\"/>\n"
        "<include\n file=\"empty.xml\"\n/><point name=\"c\" x12=\"\"/><include file=\"empty.xml\"/>"
        "<point name=\"d\" x12b=\"\"/>\n<point name=\"e\" x13=\"\"/>";
    for (std::size_t at = 0; end.size() > 1 && (at = body.find('\n', at)) != std::string::npos;
         at += 2)
      body.replace(at, 1, end);
    Shot shot(body);
    shot.write("empty.xml", "<fragment>" + end + end + "</fragment>");
    const auto error = shot.load();
    REQUIRE_FALSE(error);
    const Lines lines = to_lines(error.error());
    CHECK(lines.size() == 6);
    for (const std::string& line : lines) {
      CAPTURE(line);
      const std::size_t at = line.find("\"x");
      REQUIRE(at != std::string::npos);
      CHECK_THAT(line,
                 contains_text(fmt::format("shot.xml:{}: ", std::atoi(line.c_str() + at + 2))));
    }
  }
}

TEST_CASE("what is wrong with including and defining", "[scene][expand]") {
  struct Row {
    std::string body;
    Lines problems;
  };
  const std::string in_shot = "; included by shot.xml:2";
  const std::vector<Row> rows = {
      {"<include/>", {"shot.xml:2: <include> needs the attribute \"file\""}},
      {"<include fil=\"a\"/>",
       {"shot.xml:2: <include> has no attribute \"fil\"; did you mean \"file\"? allowed: file"}},
      {"<include file=\" \"/>",
       {"shot.xml:2: <include> file=\" \": is empty; the name of a file is required"}},
      {"<include file=\"none.xml\"/>",
       {"shot.xml:2: <include> file=\"none.xml\": none.xml: cannot read the file: No such file or "
        "directory"}},
      {"<include file=\".\"/>",
       {"shot.xml:2: <include> file=\".\": .: cannot read the file: it is a folder"}},
      {"<include file=\"/dev/zero\"/>",
       {"shot.xml:2: <include> file=\"/dev/zero\": /dev/zero: cannot read the file: it is not a "
        "regular "
        "file"}},
      {"<include file=\"good.xml\">text</include>",
       {"shot.xml:2: <include> contains \"text\"; only <define> is allowed in it"}},
      {"<include file=\"good.xml\"><grid/></include>",
       {"shot.xml:2: <include> has no element \"grid\"; allowed: define"}},
      {"<include file=\"good.xml\"><define name=\"sise\" value=\"1\"/></include>",
       {"shot.xml:2: <define> name=\"sise\": \"good.xml\" neither defines nor uses it; did you "
        "mean "
        "\"size\"?"}},
      {"<define name=\"a\"/>", {"shot.xml:2: <define> needs the attribute \"value\""}},
      {"<define value=\"a\"/>", {"shot.xml:2: <define> needs the attribute \"name\""}},
      {"<define name=\"a-b\" value=\"\"/>",
       {"shot.xml:2: <define> name=\"a-b\": must be a letter or _ followed by letters, digits and "
        "_"}},
      {"<define name=\"$a\" value=\"\"/>",
       {"shot.xml:2: <define> name=\"$a\": must be a letter or _ followed by letters, digits and "
        "_"}},
      {"<define name=\"a\" value=\"1\"/>\n<define name=\"a\" value=\"2\"/>",
       {"shot.xml:3: <define> name=\"a\": the name is already defined at line 2"}},
      {"<define name=\"a\" value=\"1\">x</define>",
       {"shot.xml:2: <define> contains \"x\"; nothing is allowed in it"}},
      {"<define name=\"a\" value=\"1\"><b/></define>",
       {"shot.xml:2: <define> contains \"<b/>\"; nothing is allowed in it"}},
      {sheet_of("$w"), {"shot.xml:2: <grid> width=\"$w\": no definition of \"w\" comes before it"}},
      {sheet_of("$widht", define("width", "1")),
       {"shot.xml:2: <grid> width=\"$widht\": no definition of \"widht\" comes before it; did you "
        "mean "
        "\"width\"?"}},
      {sheet_of("$w") + "\n" + define("w", "1"),
       {"shot.xml:2: <grid> width=\"$w\": no definition of \"w\" comes before it; there is one at "
        "line "
        "3"}},
      {sheet_of("$"),
       {"shot.xml:2: <grid> width=\"$\": \"$\" must be followed by a name; write $$ for a "
        "$"}},
      {sheet_of("$ 1"),
       {"shot.xml:2: <grid> width=\"$ 1\": \"$\" must be followed by a name; write $$ "
        "for a $"}},
      {sheet_of("${w"),
       {"shot.xml:2: <grid> width=\"${w\": \"${\" must be followed by a name and "
        "\"}\"; write $$ for a $"}},
      {sheet_of("${}"),
       {"shot.xml:2: <grid> width=\"${}\": \"${\" must be followed by a name and "
        "\"}\"; write $$ for a $"}},
      {sheet_of("$w / 0", define("w", "1")),
       {"shot.xml:2: <grid> width=\"$w / 0\": it is divided by 0; $w is defined at line 2"}},
      {sheet_of("($w", define("w", "1")),
       {"shot.xml:2: <grid> width=\"($w\": a \")\" is missing; $w is defined at line 2"}},
      // A definition with a problem causes no others.
      {sheet_of("$w", define("w", "$x")),
       {"shot.xml:2: <define> value=\"$x\": no definition of \"x\" comes before it"}},
      {"<surface name=\"s\"><grid columns=\"3\" rows=\"3\"><include "
       "file=\"good.xml\"/></grid></surface>",
       {"shot.xml:2: <grid> has no element \"include\"; it belongs in scene, surface, material, "
        "point, radial, line, uniform, vortex, noise, inertia, pressure, group, collider"}},
      {"<include file=\"text.xml\"/>",
       {"text.xml:1: malformed XML: there is text before the root element; a file that is included "
        "must "
        "contain one element" +
        in_shot}},
      {"<include file=\"empty.xml\"/>",
       {"empty.xml:1: the file is empty; a file that is included must contain one element" +
        in_shot}},
      {"<include file=\"broken.xml\"/>",
       {"broken.xml:2: malformed XML: </fragment> comes before <grid> of line 1 is closed" +
        in_shot}},
      {"<include file=\"page.xml\"/>",
       {"page.xml:2: malformed XML, and the root element is not one of a scene" + in_shot}},
      {"<include file=\"latin.xml\"/>",
       {"latin.xml:1: the byte 0xE4 is not UTF-8; save the file as UTF-8" + in_shot}},
      {"<include file=\"key.xml\"/>",
       {"key.xml:1: the root element cannot be included; a file that is included must contain one "
        "of: "
        "fragment, "
        "scene, surface, grid, mesh, nurbs, subdivision, transform, material, map, tangents, hold, "
        "solver, "
        "point, radial, line, uniform, vortex, noise, inertia, pressure, group, collider, sphere, "
        "capsule, box, plane, path, falloff, "
        "animate" +
        in_shot}},
      {"<include file=\"named.xml\"/>",
       {"named.xml:1: <fragment> has no attribute \"name\"; allowed: none" + in_shot}},
      {"<inclde file=\"a\"/>",
       {"shot.xml:2: <scene> has no element \"inclde\"; did you mean \"include\"? allowed: "
        "surface, "
        "point, radial, line, uniform, vortex, noise, inertia, pressure, group, collider, include, "
        "define"}},
  };
  for (const Row& row : rows) {
    CAPTURE(row.body);
    Shot shot(row.body);
    shot.fragment("good.xml", define("size", "1"));
    shot.write("text.xml", "secret").write("empty.xml", "").write("key.xml", "<key frame=\"1\"/>");
    shot.write("broken.xml", "<fragment><grid>\n</fragment>")
        .write("page.xml", "<html>\n<p></html>");
    shot.write("latin.xml", "<fragment><!-- \xE4 --></fragment>");
    shot.write("named.xml", "<fragment name=\"x\"/>");
    CHECK(shot.problems() == row.problems);
  }
  // The attributes of a scene come before all definitions; $$ is a $ there too.
  Shot early("");
  early.write("shot.xml", "<scene start=\"1\" end=\"2\"\n fps=\"$rate\">" + define("rate", "25") +
                              std::string(sheet_xml) + "</scene>");
  CHECK(early.problems() == Lines{"shot.xml:2: <scene> fps=\"$rate\": the attributes of <scene> "
                                  "come before all definitions; write the value itself"});
  // Those of a scene that is included are not taken.
  Shot outer(R"(<define name="rate" value="25"/><include file="inner.xml"/>)");
  outer.write("inner.xml", "<scene fps=\"$rate\">" + std::string(sheet_xml) + "</scene>");
  CHECK(outer.problems().empty());
  CHECK(outer.scene().fps == 24);
  // A fragment is no scene.
  const Shot shot("");
  shot.folder().write("shot.xml", "<fragment/>");
  CHECK(shot.problems() ==
        Lines{"shot.xml:1: the root element is <fragment>, which is not a scene, but what a "
              "scene may include"});
}

TEST_CASE("files that are nested too deep together", "[scene][expand]") {
  Shot shot(
      "<surface name=\"s\"><grid columns=\"3\" rows=\"3\"/><include file=\"a.xml\"/></surface>");
  std::string deep = "<material>";
  for (int k = 0; k < 47; ++k) deep += "<a>";
  deep += "<b/>";
  for (int k = 0; k < 47; ++k) deep += "</a>";
  shot.write("a.xml", deep + "</material>");
  const Lines problems = shot.problems();
  REQUIRE(problems.size() == 1);
  CHECK_THAT(problems[0],
             contains_text("a.xml:1: malformed XML: <b> is nested deeper than 50 elements"));
  CHECK_THAT(problems[0], Catch::Matchers::EndsWith("; included by shot.xml:2"));
}

TEST_CASE("a file that includes itself is found on every way", "[scene][expand]") {
  const auto check_cycle = [](const Shot& shot, const std::string& file) {
    const Lines problems = shot.problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("includes itself"));
    CHECK_THAT(problems[0], Catch::Matchers::StartsWith(file + ":"));
  };
  check_cycle(Shot("<include file=\"shot.xml\"/>"), "shot.xml");
  check_cycle(Shot("<include file=\"./shot.xml\"/>"), "shot.xml");
  check_cycle(Shot("<include file=\"a.xml\"/>").fragment("a.xml", "<include file=\"shot.xml\"/>"),
              "a.xml");
  Shot several("<include file=\"a/1.xml\"/>");
  several.fragment("a/1.xml", "<include file=\"../b/2.xml\"/>");
  several.fragment("b/2.xml", "<include file=\"3.xml\"/>");
  several.fragment("b/3.xml", "<include file=\".././a/../a/1.xml\"/>");
  check_cycle(several, "a/../b/3.xml");
  CHECK_THAT(
      several.problems()[0],
      Catch::Matchers::EndsWith("; included by a/../b/2.xml:2, by a/1.xml:2, by shot.xml:2"));

  Shot linked("<include file=\"a.xml\"/>");
  linked.fragment("a.xml", "<include file=\"soft.xml\"/>");
  std::filesystem::create_symlink("a.xml", linked.folder().file("soft.xml"));
  check_cycle(linked, "a.xml");
  Shot hard("<include file=\"a.xml\"/>");
  hard.fragment("a.xml", "<include file=\"hard.xml\"/>");
  std::filesystem::create_hard_link(hard.folder().file("a.xml"), hard.folder().file("hard.xml"));
  check_cycle(hard, "a.xml");
  Shot folders("<include file=\"a/a.xml\"/>");
  folders.fragment("a/a.xml", "<include file=\"same/a.xml\"/>");
  std::filesystem::create_directory_symlink(".", folders.folder().file("a/same"));
  check_cycle(folders, "a/a.xml");
  // Twice is no cycle.
  CHECK(Shot("<include file=\"a.xml\"/><include file=\"a.xml\"/>").fragment("a.xml", "").load());
}

TEST_CASE("limits of expansion end with one error", "[scene][expand]") {
  SECTION("depth") {
    const auto chain = [](int length) {
      Shot shot("<include file=\"1.xml\"/>");
      for (int k = 1; k < length; ++k)
        shot.fragment(fmt::format("{}.xml", k), fmt::format("<include file=\"{}.xml\"/>", k + 1));
      shot.fragment(fmt::format("{}.xml", length), sheet_xml);
      return shot.problems();
    };
    CHECK(chain(xml::deepest_include).empty());
    const Lines problems = chain(xml::deepest_include + 1);
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("files include each other deeper than 16"));
  }
  SECTION("ten files, each of which includes the next ten times") {
    Shot shot("<include file=\"0.xml\"/>");
    for (int k = 0; k < 10; ++k) {
      std::string content;
      for (int j = 0; j < 10; ++j) content += fmt::format("<include file=\"{}.xml\"/>", k + 1);
      shot.fragment(fmt::format("{}.xml", k), content);
    }
    shot.fragment("10.xml", "");
    const Lines problems = shot.problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("the scene includes more than 10000 files"));
  }
  SECTION("definitions that double") {
    std::string body = define("a0", "x");
    for (int k = 1; k < 10'000; ++k)
      body += define(fmt::format("a{}", k), fmt::format("$a{0}$a{0}", k - 1));
    const Lines problems = Shot(body).problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("<define> value=\"$a16$a16\": is longer than 64 KiB"));
  }
  SECTION("a value that is long as written") {
    for (const std::string& body :
         {"<point name=\"" + std::string(xml::longest_value, ' ') + "$a\"/>",
          define("a", std::string(xml::longest_value + 1, '1')) + "<point name=\"f$a\"/>"}) {
      const Lines problems = Shot(body).problems();
      REQUIRE(problems.size() == 1);
      CHECK_THAT(problems[0], contains_text("is longer than 64 KiB"));
    }
  }
  SECTION("more problems than are listed") {
    std::string body;
    for (int k = 0; k < 1000; ++k) body += define(fmt::format("a_definition_{}", k), "1");
    for (int k = 0; k < 100'000; ++k) body += fmt::format("<point name=\"$a_definitio_{}\"/>\n", k);
    CHECK_THAT(Shot(body).problems().back(),
               contains_text("too many problems; reading stopped here"));
  }
  SECTION("text that is included often") {
    std::string body;
    for (int k = 0; k < 300; ++k) body += "<include file=\"a.xml\"/>";
    Shot shot(body);
    shot.fragment("a.xml", "<!--" + std::string(1 << 20, ' ') + "-->");
    const Lines problems = shot.problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("is larger than 256 MiB"));
  }
  if (is_sanitized) return;  // two other ways to the same error, each with 256 MiB of values
  SECTION("definitions that are many and long") {
    std::string body = define("a", std::string(xml::longest_value, 'x'));
    for (int k = 0; k < 5000; ++k) body += define(fmt::format("b{}", k), "$a");
    const Lines problems = Shot(body).problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("is larger than 256 MiB"));
  }
  SECTION("values that are used often") {
    std::string body = define("a", std::string(60'000, 'x'));
    for (int k = 0; k < 5000; ++k) body += "<point name=\"$a\"/>";
    const Lines problems = Shot(body).problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("is larger than 256 MiB"));
  }
}

TEST_CASE("a problem of a file that is included often is told once", "[scene][expand]") {
  std::string body;
  for (int k = 0; k < 100; ++k) body += "<include file=\"a.xml\"/>\n";
  Shot shot(body);
  shot.fragment("a.xml", "<nonsense/>\n<uniform name=\"$x\"/>");
  CHECK(
      shot.problems() ==
      Lines{"a.xml:2: <scene> has no element \"nonsense\"; allowed: surface, point, radial, line, "
            "uniform, vortex, noise, inertia, pressure, group, collider; included by shot.xml:2",
            "a.xml:3: <uniform> name=\"$x\": no definition of \"x\" comes before it; "
            "included by shot.xml:2"});
  shot.fragment("a.xml", "<nonsense/>");
  CHECK(shot.problems().size() == 1);
  shot.fragment("a.xml", "<nonsense");
  CHECK(shot.problems().size() == 1);
  // Also if each has other values.
  body.clear();
  for (int k = 0; k < 9; ++k)
    body +=
        fmt::format("<include file=\"a.xml\">{}</include>\n", define("id", fmt::format("n{}", k)));
  Shot others(body);
  others.fragment("a.xml", define("id", "n") + "<radial name=\"$id\" centre=\"0 0 0\"/>");
  CHECK(others.problems().size() == 1);
}

TEST_CASE("the values of attributes survive being written anew", "[scene][expand]") {
  // Each object name next to its definition, which changes nothing but the way through the
  // expansion.
  for (const std::string name :
       {"a&amp;b", "a&lt;b&gt;", "&quot;&apos;", "\xC3\xA4\xF0\x9F\x98\x80",
        "&#228;&#x1F600;&#xFFFD;", "a\tb", "a\nb", "a\r\nb", "a&#13;&#10;b", "a&#9;b", "  a  ",
        "-->", "]]>"}) {
    CAPTURE(name);
    const auto object = [&](std::string_view value) {
      const Scene scene =
          scene_of(scene_with(define("e", "") + "<surface name=\"s\"><mesh file=\"a\" object=\"" +
                              std::string(value) + "\"/></surface>"));
      return std::get<MeshFile>(scene.surfaces[0].shape).object;
    };
    CHECK(object(name + "$e") == object(name));
  }
}

}  // namespace
}  // namespace pliant::testing
