#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

/// How the text of a starter is read.
struct StarterSource {
  std::string name;           ///< of the scene, in messages
  std::string folder;         ///< to which its mesh is relative
  std::string root = {};      ///< as of `load_scene`
  std::string_view obj = {};  ///< the text of its mesh; empty: the file that the scene names
  SimulationOptions options = {};
};

/// What the first surface of a scene does under all its forces, to choose numbers.
struct StarterFacts {
  Vector3d low;  ///< corners of the box around its vertices, its own [length]
  Vector3d high;
  Field vertices;              ///< its own [length]
  bool is_held = true;         ///< whether anything holds it
  double frequency = 0;        ///< of the slowest vibration of what moves [Hz]; 0: unknown
  double peak = 0;             ///< `played_peak` [length]
  double reach = 0;            ///< half the width of what moves [uv]
  bool is_by_inertia = false;  ///< whether a force is <inertia>, whose load is the density's

  double diagonal() const { return (high - low).norm(); }  ///< [length]
  double bend() const {
    return peak / (reach * reach);
  }  ///< the size of its curvature [length/uv²]
};

/// The box and the vertices of the first surface; no more. Errors: as `look_at`.
Result<StarterFacts> measure(const std::string& text, const StarterSource& source);

/// Reads a scene, and previews it. Errors: those of `parse_scene` and `Simulation::make`;
/// InvalidInput if nothing moves, or the surface has too many nodes for a preview.
Result<StarterFacts> look_at(const std::string& text, const StarterSource& source);

/// The largest displacement of the first surface in the whole animation, world [length]. Errors:
/// those of `parse_scene`, `Simulation::make` and `Simulation::at`.
Result<double> played_peak(const std::string& text, const StarterSource& source);

}  // namespace pliant::cli
