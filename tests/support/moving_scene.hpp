#pragma once

#include <string>
#include <vector>

#include "support/scenes.hpp"

namespace pliant::testing {

/// A scene with every feature that has a state: surfaces that start late and that recover, a moving
/// transform, forces that are switched on and off, also in a group, noise at a keyed rate, an
/// authored falloff curve. Frames 3 to 28.
inline Scene moving_scene() {
  Surface first = sheet("first", 11);
  first.transform.rotate = vector_curve({{3, {0, 0, 0}}, {28, {0, 40, 5}}});
  Surface second = sheet("second", 9);
  second.solver.release = Release::Recover;
  second.solver.combine = Combine::Union;
  second.solver.start_frame = 6;
  second.material.damping = curve({{3, 20}, {20, 5}});

  Force travelling = poke("travelling", {});
  travelling.kind = PointChannels{.center = vector_curve({{3, {-4, 0, -2}}, {20, {4, 0, 3}}}),
                                  .direction = Value<3>{0.3, 1, 0}};
  travelling.magnitude = curve({{3, 0}, {9, 8000}, {22, 2000}});
  travelling.enabled = switch_at({{3, true}, {12, false}, {15, true}, {23, false}});
  travelling.falloff_curve = curve({{0, 1}, {0.5, 0.8}, {1, 0}});
  Force gust = poke("gust", {}, 3000);
  gust.kind = NoiseChannels{.frequency = 0.3, .rate = curve({{3, 1}, {28, 4}})};
  gust.targets = {"first"};
  gust.group = "weather";
  gust.force_radius = 4;
  Group weather;
  weather.name = "weather";
  weather.center = vector_curve({{3, {2, 0, 2}}, {28, {-1, 0, 0}}});
  weather.deformation_radius = 4.2;
  Scene s = scene({first, second}, {travelling, gust}, 28);
  s.start = 3;
  s.groups = {weather};
  return s;
}

/// The channel's samples at frames until `last`, each constant for a frame, and then `value`.
inline Curve<1> sampled_until(const Channel<1>& channel, int last, double value) {
  CurveKeys<1> keys;
  for (int frame = 0; frame <= last + 1; ++frame) {
    Key<1> key{.frame = static_cast<double>(frame),
               .value = {frame <= last ? channel.at(frame)[0] : value}};
    key.next.kind = Interpolation::Kind::Step;
    keys.keys.push_back(key);
  }
  return Curve<1>::make(std::move(keys)).value();
}

/// The state of all surfaces at a frame as bytes: equal exactly if bit-identical.
inline std::string state_at(Simulation& simulation, int frame) {
  return simulation.state_bytes(frame).value();
}

/// The states of all frames of a scene, in order, solved without a store.
inline std::vector<std::string> all_states(const Scene& scene) {
  auto simulation = Simulation::make(scene).value();
  std::vector<std::string> states;
  for (const int frame : simulation.frames()) states.push_back(state_at(simulation, frame));
  return states;
}

}  // namespace pliant::testing
