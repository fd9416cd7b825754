#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/read.hpp"
#include "support/catch.hpp"

namespace pliant::testing {

/// A scene around `body`, whose first line is line 2.
inline std::string scene_with(std::string_view body) {
  return "<scene version=\"1\" start=\"1\" end=\"96\">\n" + std::string(body) + "\n</scene>\n";
}

/// A surface named sheet around a grid and `parts`, which begin on the line after the grid.
inline std::string surface_with(std::string_view parts) {
  return scene_with("<surface name=\"sheet\"><grid columns=\"5\" rows=\"4\"/>\n" +
                    std::string(parts) + "</surface>");
}

/// A point force named poke around `children`, which begin on the line after it.
inline std::string force_with(std::string_view children) {
  return scene_with("<point name=\"poke\">\n" + std::string(children) + "</point>");
}

/// The magnitude of poke, animated: `attributes` of the <animate> in line 3, `keys` from line 4 on.
inline std::string animate_with(std::string_view attributes, std::string_view keys) {
  return force_with("<animate attribute=\"magnitude\" " + std::string(attributes) + ">\n" +
                    std::string(keys) + "</animate>");
}

inline Result<Scene> read(std::string_view text) { return parse_scene(text, "plate.xml", "shots"); }

/// The scene of a valid text; fails with its problems if it is not valid.
inline Scene scene_of(std::string_view text) {
  Result<Scene> scene = read(text);
  if (!scene)
    for (const std::string& line : to_lines(scene.error())) UNSCOPED_INFO(line);
  REQUIRE(scene);
  return *scene;
}

/// All problems of a text, `LINE: MESSAGE` each; empty for a valid scene.
inline std::vector<std::string> problems_of(std::string_view text) {
  const Result<Scene> scene = read(text);
  if (scene) return {};
  std::vector<std::string> problems{std::to_string(scene.error().line) + ": " +
                                    scene.error().message};
  for (const Error& other : scene.error().others)
    problems.push_back(std::to_string(other.line) + ": " + other.message);
  return problems;
}

/// A bad scene, and the expected parts of its only problem.
struct BadScene {
  std::string text;
  int line;
  std::vector<std::string> fragments;
};

/// Checks that each scene has exactly one problem, at its line, with its fragments.
inline void check_each(const std::vector<BadScene>& scenes) {
  for (const BadScene& bad : scenes) {
    CAPTURE(bad.text);
    const Result<Scene> scene = read(bad.text);
    REQUIRE_FALSE(scene);
    CAPTURE(to_lines(scene.error()));
    CHECK(scene.error().code == ErrorCode::InvalidInput);
    CHECK(scene.error().file == "plate.xml");
    CHECK(scene.error().line == bad.line);
    CHECK(scene.error().others.empty());
    for (const std::string& fragment : bad.fragments)
      CHECK_THAT(scene.error().message, contains_text(fragment));
  }
}

/// A scene that uses most of the format.
inline constexpr std::string_view rich_scene = R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- a sheet, a mesh and three forces -->
<scene version="1" fps="24000/1001" start="-5" end="96" seed="7">
  <surface name="sheet" enabled="true">
    <grid columns="61" rows="41" width="20" depth="12.5" faces="triangles"/>
    <transform rotate="0 90 0" rotateOrder="zxy">
      <animate attribute="scale"><key frame="1" value="1 1 1"/><key frame="9" value="2 1 3" in="0 0 1"/></animate>
    </transform>
    <material density="40" damping="20" b="1" c="-1.5" d="1e0"/>
    <tangents su0="0.5" su1="0 1 0">
      <animate attribute="sv0"><key frame="1" value="0"/><key frame="5" value="0 2 0"/></animate>
    </tangents>
    <solver dt="0.01" startFrame="3" stepping="overshoot" reference="none" measure="rest" combine="box"
            release="freeze" integrator="backwardEuler" region="forces"/>
    <animate attribute="translate"><key frame="1" value="0 0 0" left="1 1 1"/></animate>
  </surface>
  <surface name="body" enabled="false"><mesh file="body &amp; soul.obj" object="torso" uvSet="0" uv="grid" wrap="uv"/></surface>
  <point name="poke" center="-3 0 0" direction="0 1 0" deformationRadius="6.1" forceRadius="2.1" targets="sheet body">
    <animate attribute="magnitude" before="slope 2" after="repeat 3" tangent="flat" interpolation="linear" overshoot="contain">
      <key frame="1" value="0" interpolation="elasticOut" amplitude="3" period="4"/>
      <key frame="12" value="8e3" interpolation="bezier" in="spline" out="-2.5" inLength="1.5" outLength="2"/>
      <key frame="24" value="-1" interpolation="cubicBezier" control="0.1 0 0.9 1" inHandle="-2 3" outHandle="1 4" left="5"/>
      <key frame="30" value="0" interpolation="backInOut" back="2"/>
      <loop from="1" to="24" before="1" after="2" offset="10"/>
    </animate>
    <animate attribute="enabled" after="mirror"><key frame="1" value="true"/><key frame="5.5" value="false" interpolation="stepNext"/></animate>
  </point>
  <radial name="bulge" center="4 0 3" magnitude="-3200" falloff="smooth" targets="sheet"/>
  <line name="crease" from="-6 0 -6" to="6 0 -6" direction="0 -1 0" magnitude="2400" enabled="false"/>
</scene>
)";

}  // namespace pliant::testing
