#include "pliant/scene/read.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "scene/scene_text.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("the example of the format is read to exact values", "[scene][read]") {
  const Scene scene = scene_of(R"(<?xml version="1.0" encoding="UTF-8"?>
<scene version="1" fps="24" start="1" end="96">
  <surface name="sheet">
    <grid columns="61" rows="61" width="20" depth="20"/>
    <transform translate="0 0 0" rotate="0 0 0" scale="1 1 1"/>
    <material density="40" damping="20" b="1" c="2" d="1"/>
    <tangents su0="0" su1="0" sv0="0" sv1="0"/>
    <solver dt="0.01" startFrame="1"/>
  </surface>
  <point name="poke" center="-3 0 0" direction="0 1 0" deformationRadius="6.1" forceRadius="2.1">
    <animate attribute="magnitude" after="repeat">
      <key frame="1" value="0"/>
      <key frame="12" value="8000" tangent="flat"/>
      <key frame="24" value="0"/>
    </animate>
  </point>
  <radial name="bulge" center="4 0 3" deformationRadius="5.1" forceRadius="3.1" magnitude="3200" falloff="smooth"/>
  <line name="crease" from="-6 0 -6" to="6 0 -6" direction="0 -1 0" deformationRadius="2.1" forceRadius="1.1" magnitude="2400"/>
</scene>
)");
  CHECK(scene.fps == 24);
  CHECK(scene.start == 1);
  CHECK(scene.end == 96);
  CHECK(scene.seed == 0);
  CHECK(scene.notes.empty());

  REQUIRE(scene.surfaces.size() == 1);
  const Surface& sheet = scene.surfaces[0];
  CHECK(sheet.name == "sheet");
  CHECK(sheet.enabled);
  const auto& grid = std::get<GridSheet>(sheet.shape);
  CHECK(grid.columns == 61);
  CHECK(grid.rows == 61);
  CHECK(grid.width == 20);
  CHECK(grid.depth == 20);
  CHECK_FALSE(grid.triangles);
  CHECK(sheet.material.density.at(1)[0] == 40);
  CHECK(sheet.material.damping.at(1)[0] == 20);
  CHECK(sheet.material.c.at(1)[0] == 2);
  CHECK(sheet.solver.dt.at(1)[0] == 0.01);
  CHECK(sheet.solver.start_frame == 1);

  REQUIRE(scene.forces.size() == 3);
  const Force& poke = scene.forces[0];
  CHECK(poke.name == "poke");
  CHECK(poke.deformation_radius.at(1)[0] == 6.1);
  CHECK(poke.force_radius.at(1)[0] == 2.1);
  CHECK(poke.falloff == Falloff::Constant);
  CHECK(std::get<PointChannels>(poke.kind).center.at(1) == Value<3>{-3, 0, 0});
  REQUIRE(poke.magnitude.is_animated());
  CurveKeys<1> expected;
  const Tangent<1> flat{.kind = Tangent<1>::Kind::Flat};
  expected.keys = {{.frame = 1, .value = {0}},
                   {.frame = 12, .value = {8000}, .in = flat, .out = flat},
                   {.frame = 24, .value = {0}}};
  expected.after.kind = Extrapolation<1>::Kind::Repeat;
  CHECK(poke.magnitude.curve().keys() == expected);
  CHECK(scene.forces[1].falloff == Falloff::Smooth);
  CHECK(scene.forces[1].magnitude.at(1)[0] == 3200);
  const auto& crease = std::get<LineChannels>(scene.forces[2].kind);
  CHECK(crease.from.at(1) == Value<3>{-6, 0, -6});
  CHECK(crease.to.at(1) == Value<3>{6, 0, -6});
  REQUIRE(crease.direction);
  CHECK(crease.direction->at(1) == Value<3>{0, -1, 0});

  CHECK(scene.origin.file == "plate.xml");
  CHECK(scene.origin.place_of("").line == 2);
  CHECK(scene.origin.place_of("", "end").line == 2);
  CHECK(scene.origin.place_of("sheet").line == 3);
  CHECK(scene.origin.place_of("sheet", "columns").line == 4);
  CHECK(scene.origin.place_of("sheet", "translate").line == 5);
  CHECK(scene.origin.place_of("sheet", "density").line == 6);
  CHECK(scene.origin.place_of("sheet", "sv1").line == 7);
  CHECK(scene.origin.place_of("sheet", "startFrame").line == 8);
  CHECK(scene.origin.place_of("poke", "center").line == 10);
  CHECK(scene.origin.place_of("poke", "magnitude").line == 11);
  CHECK(scene.origin.place_of("crease", "magnitude").line == 18);
  CHECK(scene.origin.place_of("crease", "enabled").line ==
        18);  // not given: the line of the element
}

TEST_CASE("everything that is left out has its documented default", "[scene][read]") {
  const Scene scene = scene_of(
      "<scene start=\"3\" end=\"4\"><surface name=\"s\"><grid columns=\"3\" rows=\"4\"/></surface>"
      "<surface name=\"t\"><mesh file=\"t.obj\"/></surface>"
      "<point name=\"p\"/><radial name=\"r\"/><line name=\"l\"/></scene>");
  CHECK(scene.fps == 24);
  CHECK(scene.seed == 0);
  const Surface& surface = scene.surfaces.at(0);
  CHECK(surface.enabled);
  const auto& grid = std::get<GridSheet>(surface.shape);
  CHECK(grid.width == 1);
  CHECK(grid.depth == 1);
  CHECK_FALSE(grid.triangles);
  CHECK(std::get<MeshFile>(scene.surfaces.at(1).shape).object.empty());
  CHECK(surface.transform.translate.at(3) == Value<3>{0, 0, 0});
  CHECK(surface.transform.rotate.at(3) == Value<3>{0, 0, 0});
  CHECK(surface.transform.scale.at(3) == Value<3>{1, 1, 1});
  CHECK(surface.transform.rotate_order == RotateOrder::Xyz);
  CHECK(surface.material.density.at(3)[0] == 1);
  CHECK(surface.material.damping.at(3)[0] == 1);
  CHECK(surface.material.b.at(3)[0] == 1);
  CHECK(surface.material.c.at(3)[0] == 2);
  CHECK(surface.material.d.at(3)[0] == 1);
  for (const TangentChannel* tangent :
       {&surface.tangents.su0, &surface.tangents.su1, &surface.tangents.sv0, &surface.tangents.sv1})
    CHECK(std::get<Channel<1>>(*tangent).at(3)[0] == 0);
  CHECK(surface.solver.dt.at(3)[0] == 0.01);
  CHECK_FALSE(surface.solver.start_frame);
  CHECK(surface.solver.stepping == Stepping::Exact);
  CHECK(surface.solver.reference == Reference::Rest);
  CHECK_FALSE(surface.solver.measure);
  for (const Force& force : scene.forces) {
    CAPTURE(force.name);
    CHECK(force.enabled.at(3));
    CHECK(force.targets.empty());
    CHECK(force.magnitude.at(3)[0] == 0);
    CHECK(force.deformation_radius.at(3)[0] == 1);
    CHECK(force.force_radius.at(3)[0] == 1);
    CHECK(force.falloff == Falloff::Constant);
  }
  const auto& point = std::get<PointChannels>(scene.forces.at(0).kind);
  CHECK(point.center.at(3) == Value<3>{0, 0, 0});
  CHECK(point.direction.at(3) == Value<3>{0, 1, 0});
  CHECK(std::get<RadialChannels>(scene.forces.at(1).kind).center.at(3) == Value<3>{0, 0, 0});
  const auto& line = std::get<LineChannels>(scene.forces.at(2).kind);
  CHECK(line.from.at(3) == Value<3>{0, 0, 0});
  CHECK(line.to.at(3) == Value<3>{1, 0, 0});
  CHECK_FALSE(line.direction);
}

TEST_CASE("most of the format at once", "[scene][read]") {
  const Scene scene = scene_of(rich_scene);
  CHECK(scene.fps == 24000.0 / 1001.0);
  CHECK(scene.start == -5);
  CHECK(scene.seed == 7);
  const Surface& sheet = scene.surfaces.at(0);
  CHECK(std::get<GridSheet>(sheet.shape).triangles);
  CHECK(sheet.transform.rotate_order == RotateOrder::Zxy);
  CHECK(sheet.transform.scale.is_animated());
  CHECK(sheet.solver.stepping == Stepping::Overshoot);
  CHECK(sheet.solver.reference == Reference::None);
  CHECK(sheet.solver.measure == Measure::Rest);
  CHECK_FALSE(scene.surfaces.at(1).enabled);
  const auto& mesh = std::get<MeshFile>(scene.surfaces.at(1).shape);
  CHECK(mesh.path == "shots/body & soul.obj");
  CHECK(mesh.object == "torso");
  CHECK(scene.surfaces.at(1).reading.wrap == Wrap::UV);
  CHECK(scene.forces.at(0).magnitude.curve().keys().overshoot == Overshoot::Contain);
  CHECK(scene.origin.place_of("sheet", "scale").line == 7);
  CHECK(scene.origin.place_of("sheet", "translate").line == 15);
}

TEST_CASE("reading twice gives the same", "[scene][read]") {
  const Scene first = scene_of(rich_scene);
  const Scene second = scene_of(rich_scene);
  CHECK(first.origin.parts == second.origin.parts);
  CHECK(first.notes == second.notes);
  CHECK(first.forces.at(0).magnitude.curve().keys() ==
        second.forces.at(0).magnitude.curve().keys());
}

TEST_CASE("a scene without a surface is legal to read", "[scene][read]") {
  const Scene scene = scene_of("<scene start=\"1\" end=\"1\"/>");
  CHECK(scene.surfaces.empty());
  CHECK(scene.forces.empty());
}

TEST_CASE("all problems of a file are told in one run, in the order of lines", "[scene][read]") {
  const std::vector<std::string> problems =
      problems_of(R"(<scene version="1" start="1" end="96" fsp="25">
  <surface name="sheet">
    <grid columns="2" rows="61.5" width="1,5"/>
    <material density="-1" damping="nan"/>
    <solver dt="0.01" integrator="rk4"/>
    <solver/>
  </surface>
  <radial name="bulge" falof="smooth" targets="sheat"/>
  <point name="bulge" enabled="yes">
    <animate attribute="magnitude">
      <key frame="1" value="0" in="fat"/>
      <key frame="1" value="1.5abc"/>
    </animate>
    <animate attribute="centre"/>
  </point>
  <vortex name="twist" pul="1"/>
</scene>
)");
  const std::vector<std::string> expected = {
      "1: <scene> has no attribute \"fsp\"",
      "3: <grid> columns=\"2\"",
      "3: <grid> rows=\"61.5\"",
      "3: <grid> width=\"1,5\"",
      "4: <material> density=\"-1\"",
      "4: <material> damping=\"nan\"",
      "5: <solver> integrator=\"rk4\"",
      "6: <surface> \"sheet\" has a second <solver>",
      "8: <radial> has no attribute \"falof\"",
      "8: bulge.targets: no surface is named \"sheat\"",
      "9: <point> enabled=\"yes\"",
      "9: <point> name=\"bulge\": the name is already used",
      "11: <key> in=\"fat\"",
      "12: <key> value=\"1.5abc\"",
      "12: <key> frame 1 repeats the key of line 11",
      "14: <animate> attribute=\"centre\"",
      "14: <animate> has no keys",
      "16: <vortex> has no attribute \"pul\"",
  };
  CAPTURE(problems);
  REQUIRE(problems.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    CHECK_THAT(problems[k], Catch::Matchers::StartsWith(expected[k]));
}

TEST_CASE("a long value does not make a long message", "[scene][read]") {
  const std::string flood(100'000, 'x');
  for (const std::string& text : {scene_with("<point name=\"" + flood + "\"/>"),
                                  scene_with("<point name=\"p\" magnitude=\"" + flood + "\"/>"),
                                  scene_with(flood), animate_with("after=\"" + flood + "\"", ""),
                                  scene_with("<point name=\"p\" targets=\"" + flood + "\"/>")})
    for (const std::string& problem : problems_of(text)) {
      CHECK(problem.size() < 600);
      CHECK(problem.find('\n') == std::string::npos);
    }
}

TEST_CASE("a scene file is read, with its meshes beside it", "[scene][read]") {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write("rich.xml", rich_scene);
  const Result<Scene> scene = load_scene(file);
  REQUIRE(scene);
  CHECK(scene->origin.file == file.string());
  CHECK(std::get<MeshFile>(scene->surfaces.at(1).shape).path == folder.path() / "body & soul.obj");
}

TEST_CASE("a file that cannot be read is one clear line", "[scene][read]") {
  const ScratchFolder folder;
  const auto refused = [](const std::filesystem::path& file) {
    const Result<Scene> scene = load_scene(file);
    REQUIRE_FALSE(scene);
    CHECK(scene.error().file == file.string());
    CHECK(scene.error().others.empty());
    return scene.error();
  };
  const Error missing = refused(folder.path() / "missing.xml");
  CHECK(missing.code == ErrorCode::Unreadable);
  CHECK_THAT(missing.message, contains_text("cannot read the file: No such file"));
  const Error directory = refused(folder.path());
  CHECK(directory.code == ErrorCode::Unreadable);
  CHECK_THAT(directory.message, contains_text("it is a folder"));
  const Error empty = refused(folder.write("empty.xml", ""));
  CHECK(empty.code == ErrorCode::InvalidInput);
  CHECK(empty.line == 1);
  CHECK_THAT(empty.message, contains_text("the file is empty"));

  const std::filesystem::path huge = folder.write("huge.xml", "");
  std::filesystem::resize_file(huge, (std::uintmax_t{256} << 20U) + 1);  // sparse: needs no disk
                                                                         // space
  const Error too_large = refused(huge);
  CHECK(too_large.code == ErrorCode::Unreadable);
  CHECK_THAT(too_large.message, contains_text("larger than 256 MiB"));
}

TEST_CASE("a file with a mistake tells also what a run would have refused", "[scene][read]") {
  const std::string rest =
      "<surface name=\"sheet\">\n"                                               // 2
      "<mesh file=\"none.obj\"/>\n"                                              // 3
      "<material{}>\n"                                                           // 4
      "<animate attribute=\"c\"><key frame=\"1\" value=\"0\"/>"                  // 5
      "<key frame=\"5\" value=\"-3\"/><key frame=\"9\" value=\"0\"/></animate>"  // 5
      "</material></surface>\n"                                                  // 5
      "<point name=\"poke\">\n"                                                  // 6
      "<animate attribute=\"forceRadius\"><key frame=\"1\" value=\"1\"/>"        // 7
      "<key frame=\"20\" value=\"-1\"/></animate>{}</point>";                    // 7
  const auto with = [&](std::string_view material, std::string_view point) {
    return problems_of(scene_with(fmt::format(fmt::runtime(rest), material, point)));
  };
  CHECK(with("", "").empty());  // no other problem: the run checks these

  const auto all = with("", "<pond/>");
  REQUIRE(all.size() == 4);
  CHECK_THAT(all[0], Catch::Matchers::StartsWith(
                         "3: surface \"sheet\": shots/none.obj: cannot read the file: No such"));
  CHECK_THAT(all[1], Catch::Matchers::StartsWith("5: sheet.c at frame 4 is -2."));
  CHECK_THAT(all[3], Catch::Matchers::StartsWith("7: poke.forceRadius at frame 11 is -"));
  CHECK_THAT(all[2], Catch::Matchers::StartsWith("7: <point> has no element \"pond\""));

  // An unsound value is not replaced by its default in checks: c is not checked against a d that is
  // not a number.
  const auto some = with(" d=\"9x\"", "");
  REQUIRE(some.size() == 3);
  CHECK_THAT(some[1], Catch::Matchers::StartsWith("4: <material> d=\"9x\""));
  CHECK_THAT(some[2], Catch::Matchers::StartsWith("7: poke.forceRadius"));
}

TEST_CASE("channels of names given twice, or over bad frames, are not judged", "[scene][read]") {
  const std::string_view surface =
      "<surface name=\"a\"><grid columns=\"3\" rows=\"3\"/><material>"
      "<animate attribute=\"b\"><key frame=\"1\" value=\"-1\"/></animate></material></surface>\n";
  const auto twice = problems_of(scene_with(fmt::format("{0}{0}", surface)));
  REQUIRE(twice.size() == 1);
  CHECK_THAT(twice[0], contains_text("the name is already used"));
  const auto backwards =
      problems_of(fmt::format("<scene version=\"1\" start=\"9\" end=\"1\">{}</scene>", surface));
  REQUIRE(backwards.size() == 1);
  CHECK_THAT(backwards[0], contains_text("must not be before"));
}

}  // namespace
}  // namespace pliant::testing
