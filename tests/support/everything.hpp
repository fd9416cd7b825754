#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"

namespace pliant::testing {

/// Two surfaces, and forces of every kind, in and without a group, with constant and keyed
/// channels.
inline Scene of_everything() {
  const auto text = R"(<scene start="-2" end="9" fps="30000/1001">
    <surface name="sheet"><grid columns="11" rows="12" width="10" depth="10"/>
      <transform translate="1 0 0" rotate="5 10 15"/><material density="0.02" damping="0.05"/>
      <tangents su0="0.1" sv1="0.1 0.2 0"/></surface>
    <surface name="other"><grid columns="9" rows="9" width="8" depth="8"/>
      <transform><animate attribute="translate"><key frame="-3" value="0 3 0"/>
        <key frame="9" value="1 2 1"/></animate></transform>
      <solver dt="0.02" release="recover" startFrame="0" combine="islands"/></surface>
    <point name="poke" magnitude="400" center="1 0.5 0" deformationRadius="4" forceRadius="4"/>
    <radial name="swell" deformationRadius="3" forceRadius="3" center="2 1 0">
      <animate attribute="magnitude"><key frame="1" value="100"/><key frame="6" value="300"/>
      </animate></radial>
    <line name="ridge" magnitude="200" from="-2 0.5 0" to="2 0.5 1" direction="0 1 1"
      deformationRadius="2" forceRadius="2"/>
    <uniform name="weight" magnitude="-5" deformationRadius="1">
      <animate attribute="enabled"><key frame="0" value="true"/><key frame="5" value="false"/>
      </animate></uniform>
    <vortex name="turn" magnitude="50" center="0 0.5 0" pull="0.5" deformationRadius="3"
      forceRadius="3"/>
    <noise name="wind" magnitude="80" frequency="0.5" rate="2" deformationRadius="5"
      forceRadius="5"/>
    <inertia name="sway" deformationRadius="3"/>
    <point name="slide" magnitude="100" deformationRadius="2" forceRadius="2">
      <path attribute="center" progress="0.25"><waypoint at="-3 0.5 0"/><waypoint at="3 0.5 1"/><waypoint at="0 0 3"/>
      </path></point>
    <collider name="ball" friction="0.2" targets="sheet"><sphere radius="1.5"/>
      <transform><animate attribute="translate"><key frame="-2" value="1 3 0"/><key frame="8" value="1 0.5 1"/></animate>
      </transform></collider>
    <collider name="bar" offset="0.05" stick="true" enabled="false"><capsule length="3"/>
      <transform translate="-2 1 0" rotate="90 0 0"/></collider>
    <collider name="block"><box size="2 0.5 1" round="0.125"/><transform translate="2 -1.5 1"/></collider>
    <group name="pair" center="0 0 1" deformationRadius="3">
      <radial name="left" magnitude="60" center="-1 -1 1" forceRadius="3"/>
      <noise name="right" magnitude="40" forceRadius="3"/>
    </group></scene>)";
  auto scene = parse_scene(text, "scene.xml", "");
  REQUIRE(scene);
  return *std::move(scene);
}

/// The numbers of a channel at a frame; of a switch, 0 or 1.
inline std::vector<double> value_at(const NamedChannel& named, double frame) {
  std::vector<double> value;
  std::visit(
      [&](const auto* channel) {
        if constexpr (std::is_same_v<decltype(channel), const Switch*>) {
          value.push_back(channel->at(frame) ? 1 : 0);
        } else {
          for (const double number : channel->at(frame)) value.push_back(number);
        }
      },
      named.channel);
  return value;
}

/// A valid value other than that of the channel at the frame.
inline std::vector<double> other_value(const NamedChannel& named, int frame) {
  std::vector<double> value = value_at(named, frame);
  for (double& number : value) {
    if (std::holds_alternative<const Switch*>(named.channel)) {
      number = 1 - number;
    } else {
      number = number == 0 ? 0.0625 * std::abs(frame) : number * (1 + 0.03125 * frame);
    }
  }
  // With release="recover" tangents must stay 0.
  if (named.path.starts_with("other.s") && named.path.find("scale") == std::string::npos) {
    for (double& number : value) number = 0;
  }
  return value;
}

inline std::vector<std::string> paths_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (const NamedChannel& named : channels_of(scene)) paths.push_back(named.path);
  return paths;
}

}  // namespace pliant::testing
