#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "cli/new/mesh_piece.hpp"
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
  std::size_t surface = 0;    ///< the one that is looked at
  SimulationOptions options = {};
};

/// What a surface of a scene does under all its forces, to choose numbers.
struct StarterFacts {
  double size = 0;             ///< of its largest piece: the diagonal of a box around it [length]
  bool selects = false;        ///< whether anything is selected; false: the following are unknown
  bool is_solvable = false;    ///< whether any node moves
  bool is_held = true;         ///< whether something holds all that moves
  double frequency = 0;        ///< of the slowest vibration of what moves [Hz]; 0: unknown
  double peak = 0;             ///< `played_peak` [length]; 0: unknown
  double reach = 0;            ///< half the width of what moves [uv]
  bool is_by_inertia = false;  ///< whether a force is <inertia>, whose load is the density's

  double bend() const {
    return peak / (reach * reach);
  }  ///< the size of its curvature [length/uv²]
};

/// The largest piece of the surface. Errors: those of `parse_scene` and `Simulation::make`.
Result<MeshPiece> measure(const std::string& text, const StarterSource& source);

/// Reads a scene, and finds its slowest vibration; the peak is left out. Errors: those of
/// `parse_scene`, `Simulation::make` and `preview_slowest`.
Result<StarterFacts> look_at(const std::string& text, const StarterSource& source);

/// Checks that something moves, is held and vibrates. Errors: InvalidInput with the reason.
Result<void> check_moves(const StarterFacts& facts);

/// The largest displacement of the surface in the whole animation, world [length], or one
/// larger than `until` if there is one. Errors: those of `parse_scene`, `Simulation::make` and
/// `play_forces`.
Result<double> played_peak(const std::string& text, const StarterSource& source,
                           double until = std::numeric_limits<double>::infinity());

/// `look_at`, `check_moves` and `played_peak`.
Result<StarterFacts> look_and_play(const std::string& text, const StarterSource& source);

}  // namespace pliant::cli
