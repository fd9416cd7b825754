#pragma once

#include <span>
#include <string>
#include <string_view>

#include "cli/new/starter_facts.hpp"
#include "pliant/document/document.hpp"

namespace pliant::cli {

/// A material as it looks, whatever the size of the surface.
struct Look {
  std::string_view name;
  std::string_view summary;      ///< in one line
  double frequency = 0;          ///< of the slowest vibration of what moves [Hz]
  double damping_ratio = 0;      ///< of that vibration [1]
  double softness = 1;           ///< peak displacement over that of the starter's own material [1]
  double c = 2;                  ///< mixed stiffness, if b is 1
  double d = 1;                  ///< stiffness along v, if b is 1
  double poisson = 0.3;          ///< [1]
  double give = 0;               ///< by how much the peak grows because it yields [1]; 0: elastic
  double hardening = 0;          ///< [1]
  std::string_view ring = {};    ///< why this frequency and this damping ratio
  std::string_view shape = {};   ///< why this stiffness and poisson
  std::string_view memory = {};  ///< why this yield and hardening; empty: it is elastic
};

/// All looks, the most elastic first.
std::span<const Look> looks();

/// Gives the surface of `source` the look, in place of its <material>: finds the numbers that
/// the look has at the size of the surface and its forces. `own` are the facts of the scene as it
/// is. Returns those of the result. Errors: those of `look_and_play`.
Result<StarterFacts> apply_look(SceneDocument& scene, const Look& look, const StarterFacts& own,
                                const StarterSource& source);

}  // namespace pliant::cli
