#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/pliant.hpp"
#include "pliant/scene/text/source_map.hpp"

namespace pliant::testing {

/// A curve from keys with automatic tangents.
inline Curve<1> curve(std::vector<std::pair<double, double>> keys) {
  CurveKeys<1> curve_keys;
  for (const auto& [frame, value] : keys) {
    curve_keys.keys.push_back({.frame = frame, .value = {value}});
  }
  return Curve<1>::make(std::move(curve_keys)).value();
}

inline Curve<3> vector_curve(std::vector<std::pair<double, Value<3>>> keys) {
  CurveKeys<3> curve_keys;
  for (const auto& [frame, value] : keys)
    curve_keys.keys.push_back({.frame = frame, .value = value});
  return Curve<3>::make(std::move(curve_keys)).value();
}

/// A switch that steps between the given states.
inline Switch switch_at(std::vector<std::pair<double, bool>> keys) {
  CurveKeys<1> curve_keys;
  for (const auto& [frame, state] : keys) {
    Key<1> key{.frame = frame, .value = {state ? 1.0 : 0.0}};
    key.next.kind = Interpolation::Kind::Step;
    curve_keys.keys.push_back(key);
  }
  return Switch(Curve<1>::make(std::move(curve_keys)).value());
}

/// Parts of a scene, in the order of names, that begin lines of a file.
inline SceneOrigin origin_of(const std::string& file,
                             const std::vector<std::pair<std::string, int>>& lines) {
  SceneOrigin origin{.file = file};
  std::string text;
  for (const auto& [part, line] : lines) {
    const auto begin = static_cast<std::uint32_t>(line - 1);
    origin.parts.push_back({part, {0, {begin, begin}}});
    text.resize(std::max<std::size_t>(text.size(), begin), '\n');
  }
  origin.sources = std::make_shared<SourceMap>(file, std::make_shared<SourceText>(text));
  return origin;
}

/// A square sheet with a spacing of 1 between vertices.
inline Surface sheet(const std::string& name, int count = 13) {
  Surface surface;
  surface.name = name;
  surface.shape =
      GridSheet{.columns = count, .rows = count, .width = count - 1.0, .depth = count - 1.0};
  surface.material.density = 40.0;
  surface.material.damping = 20.0;
  return surface;
}

/// A surface that is solved as a whole, and is light enough to swing fast.
inline Surface light(Surface surface) {
  surface.material.density = 0.02;
  surface.material.damping = 0.02;
  surface.solver.region = SolvedRegion::All;
  return surface;
}

/// A mesh as such a surface of triangles.
inline Surface light_skin(Mesh mesh, Border border = Border::Clamped) {
  Surface surface;
  surface.name = "s";
  surface.shape = std::move(mesh);
  surface.reading.uv = UvReading::Surface;
  if (border != Border::Clamped) surface.reading.border = border;
  return light(surface);
}

inline Force poke(const std::string& name, const Value<3>& center, double magnitude = 5000) {
  Force force;
  force.name = name;
  force.magnitude = magnitude;
  force.deformation_radius = 4.5;
  force.force_radius = 2.5;
  force.kind = PointChannels{.center = center};
  return force;
}

/// Frames 1 to `end` of the given surfaces and forces.
inline Scene scene(std::vector<Surface> surfaces, std::vector<Force> forces, int end = 12) {
  Scene scene;
  scene.end = end;
  scene.surfaces = std::move(surfaces);
  scene.forces = std::move(forces);
  return scene;
}

/// World positions of one surface at every frame, in order.
inline std::vector<Field> baked(const Scene& scene, const std::string& surface) {
  auto simulation = Simulation::make(scene).value();
  std::vector<Field> frames;
  for (const int frame : simulation.frames()) {
    frames.push_back(simulation.at(frame).value().surface(surface).positions());
  }
  return frames;
}

inline double largest_difference(const Field& a, const Field& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// The largest distance of a vertex from its position in the first frame.
inline double peak(const std::vector<Field>& frames) {
  double largest = 0;
  for (const Field& frame : frames) {
    largest = std::max(largest, (frame - frames.front()).rowwise().norm().maxCoeff());
  }
  return largest;
}

}  // namespace pliant::testing
