#pragma once

#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/document/document.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::editor {

/// What a page asks to add.
struct NewObject {
  std::string kind;          ///< of a force, `group`, `grid`, `mesh`, or of a collider's shape
  std::string surface = {};  ///< at which it stands; empty: the first
  std::string group = {};    ///< of a force; empty: none
  std::string file = {};     ///< of a mesh, as the scene names it
  std::string object = {};   ///< of a mesh file with several; empty: its only one
};

struct Addition {
  std::string name;
  std::vector<Operation> operations;
};

/// The operations that add an object where it is seen at once: at the middle of the surface, with
/// radii that fit it, and with the magnitude that moves it by a tenth of its size if that can be
/// found. Errors: InvalidInput: no such kind or surface, or a mesh without a file; those of
/// `Simulation::make`.
Result<Addition> to_add(const SceneDocument& document, const NewObject& wanted,
                        const SimulationOptions& options);

}  // namespace pliant::editor
