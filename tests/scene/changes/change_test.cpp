#include "pliant/scene/changes/change.hpp"

#include <span>
#include <string>
#include <vector>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

constexpr std::string_view text = R"(<scene version="1" start="1" end="24">
  <surface name="sheet"><grid columns="5" rows="5"/>
    <transform translate="1 2 3"/>
    <material density="40"><animate attribute="damping"><key frame="1" value="2"/>
      <key frame="9" value="7"/></animate></material>
    <tangents su0="3" sv0="1 2 3"/>
  </surface>
  <point name="poke" magnitude="-8">
    <animate attribute="center"><key frame="1" value="1 2 3"/><key frame="5" value="3 2 1"/></animate>
  </point>
  <radial name="ball"><path attribute="center" progress="0.5">
    <waypoint at="0 0 0"/><waypoint at="4 0 0"/><waypoint at="4 2 0"/></path></radial>
  <group name="hand"><line name="edge"/></group>
</scene>)";

Scene scene_of_text() { return parse_scene(text, "test.xml", "").value(); }

std::string problem(std::string_view typed) {
  Scene scene = scene_of_text();
  const auto change = parse_change(typed);
  if (!change) return change.error().message;
  const auto changed = change_scene(scene, std::span(&*change, 1));
  return changed ? "" : changed.error().message;
}

Scene changed(const std::vector<std::string>& typed) {
  Scene scene = scene_of_text();
  std::vector<SceneChange> changes;
  for (const std::string& one : typed) changes.push_back(parse_change(one).value());
  const auto made = change_scene(scene, changes);
  INFO((made ? "" : made.error().message));
  REQUIRE(made);
  return scene;
}

// The values of all channels at some frames.
std::vector<double> values_of(const Scene& scene) {
  std::vector<double> values;
  for (const NamedChannel& named : channels_of(scene)) {
    for (const double frame : {0.0, 1.0, 3.0, 7.0, 30.0}) {
      std::visit(
          [&](const auto* channel) {
            const auto value = channel->at(frame);
            if constexpr (std::is_same_v<decltype(value), const bool>) {
              values.push_back(value ? 1 : 0);
            } else {
              values.insert(values.end(), value.begin(), value.end());
            }
          },
          named.channel);
    }
  }
  return values;
}

}  // namespace

TEST_CASE("every numeric channel is multiplied, and no other changes with it", "[scene][change]") {
  const Scene plain = scene_of_text();
  const std::vector<NamedChannel> all = channels_of(plain);
  for (const NamedChannel& named : all) {
    CAPTURE(named.path);
    Scene scene = scene_of_text();
    const SceneChange change = parse_change(named.path + "*=0.37").value();
    const auto made = make_changes(scene, std::span(&change, 1));
    if (std::holds_alternative<const Switch*>(named.channel)) {
      REQUIRE(!made);
      CHECK_THAT(made.error().message, Contains("is no numeric channel"));
      continue;
    }
    REQUIRE(made);
    const std::vector<NamedChannel> after = channels_of(scene);
    REQUIRE(after.size() == all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (const double frame : {0.0, 1.0, 3.0, 7.0, 30.0}) {
        std::visit(
            [&]<class C>(const C* before) {
              auto wanted = before->at(frame);
              if constexpr (!std::is_same_v<C, Switch>) {
                if (all[k].path == named.path) {
                  for (double& number : wanted) number = number * 0.37;
                }
              }
              CHECK(std::get<const C*>(after[k].channel)->at(frame) == wanted);
            },
            all[k].channel);
      }
    }
  }
}

TEST_CASE("a component is changed, and the others stay", "[scene][change]") {
  const Scene plain = scene_of_text();
  const Scene scene =
      changed({"poke.center.y+=10", "sheet.translate.z=-1", "sheet.sv0.x*=4", "ball.center.y+=3",
               "ball.center.progress+=0.25", "sheet.rotate+=1 0 -1", "sheet.scale*=2"});
  const auto& center = std::get<PointChannels>(scene.forces[0].kind).center;
  const auto& before = std::get<PointChannels>(plain.forces[0].kind).center;
  for (const double frame : {1.0, 2.5, 5.0}) {
    const Value<3> at = before.at(frame);
    CHECK(center.at(frame) == Value<3>{at[0], at[1] + 10, at[2]});
  }
  CHECK(scene.surfaces[0].transform.translate.at(0) == Value<3>{1, 2, -1});
  CHECK(scene.surfaces[0].transform.rotate.at(0) == Value<3>{1, 0, -1});
  CHECK(scene.surfaces[0].transform.scale.at(0) == Value<3>{2, 2, 2});
  CHECK(std::get<Channel<3>>(scene.surfaces[0].tangents.sv0).at(0) == Value<3>{4, 2, 3});
  const auto& ball = std::get<RadialChannels>(scene.forces[1].kind).center;
  CHECK(ball.path()->progress.at(0)[0] == 0.75);
  const Value<3> on_path = ball.path()->path.at(0.75);
  CHECK(ball.at(0) == Value<3>{on_path[0], on_path[1] + 3, on_path[2]});
}

TEST_CASE("a value that is set is that of a file that says so", "[scene][change]") {
  // The element around the attribute, its name and a value.
  struct Row {
    std::string element, path, value;
  };
  const Row rows[] = {
      {"scene", "scene.fps", "24000/1001"},
      {"scene", "scene.end", "48"},
      {"scene", "scene.seed", "18446744073709551615"},
      {"surface", "sheet.enabled", "false"},
      {"grid", "sheet.columns", "7"},
      {"grid", "sheet.width", "0.1"},
      {"grid", "sheet.faces", "triangles"},
      {"transform", "sheet.translate", "1 -2 3e-3"},
      {"transform", "sheet.rotateOrder", "zyx"},
      {"material", "sheet.density", "0.30000000000000004"},
      {"material", "sheet.dampingRatio", "0.2"},
      {"material", "sheet.yield", "3"},
      {"tangents", "sheet.su0", "4"},
      {"tangents", "sheet.sv1", "1 2 3"},
      {"solver", "sheet.dt", "0.002"},
      {"solver", "sheet.startFrame", "5"},
      {"solver", "sheet.combine", "islands"},
      {"solver", "sheet.measure", "rest"},
      {"solver", "sheet.integrator", "exact"},
      {"point", "poke.magnitude", "-12.5"},
      {"point", "poke.enabled", "false"},
      {"point", "poke.targets", "sheet"},
      {"point", "poke.center", "1 2 3"},
      {"point", "poke.direction", "0 0 1"},
      {"point", "poke.falloff", "gaussian"},
  };
  const auto text_with = [](const Row& row) {
    const auto tag = [&](std::string element, const std::string& rest) {
      const std::string attribute = row.path.substr(row.path.find('.') + 1);
      const std::string own =
          row.element == element ? " " + attribute + "=\"" + row.value + "\"" : std::string();
      return "<" + element + own + rest;
    };
    const auto unless = [&](const std::string& path, const std::string& otherwise) {
      return row.path == path ? std::string() : otherwise;
    };
    return tag("scene", " version=\"1\" start=\"1\"") + unless("scene.end", " end=\"9\"") + ">" +
           tag("surface", " name=\"sheet\">") +
           tag("grid", unless("sheet.columns", " columns=\"5\"") + " rows=\"6\"/>") +
           tag("transform", "/>") + tag("material", "/>") + tag("tangents", "/>") +
           tag("solver", "/>") + "</surface>" + tag("point", " name=\"poke\">") +
           unless("poke.magnitude",
                  "<animate attribute=\"magnitude\"><key frame=\"1\" value=\"1\"/></animate>") +
           unless("poke.center",
                  "<path attribute=\"center\"><waypoint at=\"0 0 0\"/><waypoint at=\"1 0 0\"/>"
                  "<waypoint at=\"1 1 0\"/></path>") +
           unless("poke.falloff", "<falloff><key at=\"0\" value=\"1\"/></falloff>") +
           "</point></scene>";
  };
  for (const Row& row : rows) {
    CAPTURE(row.path, row.value);
    const Result<Scene> wanted = parse_scene(text_with(row), "test.xml", "");
    REQUIRE(wanted);
    Scene scene = parse_scene(text_with({}), "test.xml", "").value();
    const SceneChange change = parse_change(row.path + "=" + row.value).value();
    const auto made = change_scene(scene, std::span(&change, 1));
    INFO((made ? "" : made.error().message));
    REQUIRE(made);
    CHECK(to_xml(scene).value() == to_xml(*wanted).value());
    const std::string name = row.path.substr(0, row.path.find('.'));
    CHECK(scene.origin.gives(name == "scene" ? "" : name, row.path.substr(row.path.find('.') + 1)));
  }
}

TEST_CASE("files are relative to the scene's folder", "[scene][change]") {
  Scene scene = parse_scene(R"(<scene version="1" start="1" end="2"><surface name="s">
    <mesh file="a.obj"/></surface></scene>)",
                            "shots/one/test.xml", "shots/one")
                    .value();
  const SceneChange change = parse_change("s.file=../b.obj").value();
  REQUIRE(make_changes(scene, std::span(&change, 1)));
  CHECK(std::get<MeshFile>(scene.surfaces[0].shape).path == "shots/one/../b.obj");
}

TEST_CASE("what cannot be changed is told with the change and the nearest word",
          "[scene][change]") {
  CHECK_THAT(problem("pokee.magnitude*=2"), Contains("did you mean \"poke\""));
  CHECK_THAT(problem("pokee.magnitude*=2"), Contains("pokee.magnitude*=2: "));
  CHECK_THAT(problem("poke.magnitud=2"), Contains("did you mean \"magnitude\""));
  CHECK_THAT(problem("scene.fp=2"), Contains("did you mean \"fps\""));
  CHECK_THAT(problem("poke.center.w*=2"), Contains("allowed: x, y, z, progress"));
  CHECK_THAT(problem("poke*=2"), Contains("write NAME.ATTRIBUTE"));
  CHECK_THAT(problem("poke.=2"), Contains("write NAME.ATTRIBUTE"));
  CHECK_THAT(problem("=2"), Contains("write PATH=TEXT"));
  CHECK_THAT(problem("poke.magnitude"), Contains("write PATH=TEXT"));
  CHECK_THAT(problem("poke.name=b"), Contains("cannot be changed"));
  CHECK_THAT(problem("scene.version=1"), Contains("cannot be changed"));
  CHECK_THAT(problem("poke.enabled*=2"), Contains("is no numeric channel"));
  CHECK_THAT(problem("poke.targets+=2"), Contains("is no numeric channel"));
  CHECK_THAT(problem("sheet.columns*=2"), Contains("is no numeric channel"));
  CHECK_THAT(problem("sheet.columns.x=2"), Contains("sheet.columns is a single value"));
  CHECK_THAT(problem("sheet.yield*=2"), Contains("sheet.yield is not given"));
  CHECK_THAT(problem("sheet.su0.x*=2"), Contains("is a single number"));
  CHECK_THAT(problem("poke.magnitude.x*=2"), Contains("is a single number"));
  CHECK_THAT(problem("poke.center.progress*=2"), Contains("is not on a <path>"));
  CHECK_THAT(problem("ball.center.progress=2"), Contains("\"2\""));
  CHECK_THAT(problem("edge.deformationRadius*=2"),
             Contains("a force in a <group> must not have one"));
  CHECK_THAT(problem("poke.magnitude*=2,5"), Contains("not a number"));
  CHECK_THAT(problem("poke.magnitude+=nan"), Contains("\"nan\""));
  CHECK_THAT(problem("sheet.translate+=1 2"), Contains("\"1 2\""));
  CHECK_THAT(problem("sheet.density=-1"), Contains("sheet.density=-1: \"-1\": "));
  CHECK_THAT(problem("sheet.combine=bax"), Contains("did you mean \"box\""));
  CHECK_THAT(problem("sheet.c=-5"), Contains("c is -5"));  // only b and d say that it is too small
  CHECK_THAT(problem("sheet.damping*=-1"), Contains("damping at frame 1 is -2"));
  CHECK_THAT(problem("poke.targets=shet"), Contains("shet"));
}

TEST_CASE("a path is closed and opened", "[scene][change]") {
  const auto is_closed = [](const Scene& scene) {
    return std::get<RadialChannels>(scene.forces[1].kind).center.path()->path.is_closed();
  };
  const Scene scene = changed({"ball.center.closed=true", "ball.center.progress=0.25"});
  CHECK(is_closed(scene));
  // As a file that says so.
  std::string said(text);
  said.replace(said.find("progress=\"0.5\""), 14, "progress=\"0.25\" closed=\"true\"");
  CHECK(values_of(scene) == values_of(parse_scene(said, "test.xml", "").value()));
  CHECK_FALSE(is_closed(changed({"ball.center.closed= false "})));
  CHECK_THAT(problem("ball.center.closed=1"), Contains("must be true or false"));
  CHECK_THAT(problem("ball.center.closed*=2"), Contains("no numeric channel"));
  CHECK_THAT(problem("poke.center.closed=true"), Contains("is not on a <path>"));
  CHECK_THAT(problem("poke.magnitude.closed=true"), Contains("has no closed"));
}

TEST_CASE("a rule that a change breaks is told with the change", "[scene][change]") {
  const auto problem_of = [](const std::vector<std::string>& typed) {
    Scene scene = scene_of_text();
    const auto made = change_scene(scene, std::span(typed));
    REQUIRE_FALSE(made);
    CHECK(made.error().file.empty());
    CHECK(scene.end == 24);
    return made.error().message;
  };
  CHECK_THAT(problem_of({"scene.end=0"}), StartsWith("--set scene.end=0: "));
  CHECK_THAT(problem_of({"poke.magnitude=3", "sheet.c=-2", "scene.end=9"}),
             StartsWith("--set sheet.c=-2: sheet.c is -2, but"));
  // What a later one mends is no fault.
  CHECK_THAT(problem_of({"scene.start=50", "scene.end=60", "sheet.density*=-1", "sheet.columns=9"}),
             StartsWith("--set sheet.density*=-1: "));
}

TEST_CASE("two changes of one value are refused, and nothing is changed then", "[scene][change]") {
  const std::vector<double> before = values_of(scene_of_text());
  const auto both = [&](std::string one, std::string other) {
    Scene scene = scene_of_text();
    const SceneChange changes[] = {parse_change(one).value(), parse_change(other).value()};
    const auto made = make_changes(scene, changes);
    if (!made) CHECK(values_of(scene) == before);
    return made.has_value();
  };
  CHECK(!both("poke.magnitude=2", "poke.magnitude*=3"));
  CHECK(!both("poke.center=1 2 3", "poke.center.x+=1"));
  CHECK(!both("poke.center.x=1", "poke.center.x=1"));
  CHECK(!both("ball.center=1 2 3", "ball.center.progress=0.5"));
  CHECK(!both("ball.center.progress=0.5", "ball.center=1 2 3"));
  CHECK(!both("poke.magnitude=2", "poke.magnitud=2"));
  CHECK(both("poke.center.x=1", "poke.center.y=1"));
  CHECK(both("ball.center.y+=1", "ball.center.progress=0.5"));
  CHECK(both("sheet.b=2", "sheet.d=2"));
  Scene scene = changed({"poke.center.x*=2"});
  const SceneChange again = parse_change("poke.center.x+=1").value();
  CHECK_THAT(make_changes(scene, std::span(&again, 1)).error().message,
             Contains("poke.center is changed already"));
}

TEST_CASE("a scene file cannot contain a curve that is adjusted", "[scene][change]") {
  CHECK(to_xml(changed({"poke.magnitude*=2"})));  // a constant is another constant
  const auto written = to_xml(changed({"sheet.damping*=2"}));
  REQUIRE(!written);
  CHECK_THAT(written.error().message, Contains("sheet.damping"));
  CHECK_THAT(to_xml(changed({"ball.center.x+=2"})).error().message, Contains("ball.center"));
}
