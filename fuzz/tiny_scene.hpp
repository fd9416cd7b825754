#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>

#include "fuzz.hpp"
#include "pliant/pliant.hpp"

namespace pliant::fuzzing {

inline constexpr auto any_number = std::numeric_limits<std::size_t>::max();
inline constexpr int most_frames = 100;    // that are checked
inline constexpr int most_vertices = 400;  // that are played
inline constexpr int most_levels = 2;

inline bool is_tiny(const Surface& surface) {
  if (surface.subdivision && surface.subdivision->levels > most_levels) return false;
  if (const auto* const sheet = std::get_if<GridSheet>(&surface.shape))
    return std::int64_t{sheet->columns} * sheet->rows <= most_vertices;
  if (const auto* const net = std::get_if<NurbsNet>(&surface.shape))
    return std::int64_t{samples_of(net->u)} * samples_of(net->v) <= most_vertices;
  return true;  // the meshes there are tiny
}

/// Whether it can be played at once.
inline bool is_tiny(const Scene& scene) {
  return scene.surfaces.size() <= 4 && scene.forces.size() <= 8 &&
         std::ranges::all_of(scene.surfaces, [](const Surface& one) { return is_tiny(one); });
}

/// A sheet of 9 nodes that is pushed for 3 frames. `solver`: attributes of its <solver>.
inline Result<Simulation> tiny_simulation(const std::string& solver = "", bool yields = false) {
  const std::string material = yields ? R"(<material yield="0.1"/>)" : "";
  auto scene = parse_scene(R"(<scene version="1" fps="24" start="1" end="3"><surface name="sheet">
    <grid columns="3" rows="3" width="1" depth="1"/>)" +
                               material + "<solver" + solver + R"(/></surface>
  <point name="poke" center="0 0 0" direction="0 1 0" magnitude="1" deformationRadius="2"/>
</scene>)",
                           "tiny.xml", "");
  if (!scene) return fail(scene.error());
  return Simulation::make(*std::move(scene));
}

/// Whether its channels can be checked at once.
inline bool is_short(const Scene& scene) {
  const FrameSpan frames = sampled_frames(scene);
  return frames.last - std::int64_t{frames.first} < most_frames;
}

/// For a run that ends soon whatever the scene asks for: a frame may have 10^5 steps. `steps`
/// counts.
inline SimulationOptions bounded(int& steps) {
  SimulationOptions options;
  options.max_memory = std::size_t{100} << 20;
  options.should_stop = [&steps] { return ++steps > 200; };
  return options;
}

}  // namespace pliant::fuzzing
