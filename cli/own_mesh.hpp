#pragma once

#include <string>

#include "pliant/document/document.hpp"
#include "starter_facts.hpp"

namespace pliant::cli {

/// Puts a mesh of the user's own in place of that of a starter: scales its lengths, moves its
/// forces to the same place of the mesh, and finds the density and the magnitudes with which the
/// motion is as fast and, for its size, as large as the starter's. `own` are the facts of the
/// starter. Returns the facts of the result. Errors: those of `look_at`; InvalidInput if nothing
/// holds the mesh. `file` is the mesh as the scene names it.
Result<StarterFacts> use_own_mesh(SceneDocument& scene, const std::string& file,
                                  const StarterFacts& own, const StarterSource& source);

}  // namespace pliant::cli
