#pragma once

#include <string>

#include "cli/new/starter_facts.hpp"
#include "pliant/document/document.hpp"

namespace pliant::cli {

/// A mesh of the user's own, as the scene names it.
struct OwnMesh {
  std::string file;
  std::string object = {};  ///< empty: the file's only one
};

/// Puts a mesh of the user's own in place of that of a starter: scales its lengths, moves its
/// forces to the same place of the mesh, and finds the density and the magnitudes with which the
/// motion is as fast and, for its size, as large as the starter's. What swings by inertia, and has
/// no border to hold it, gets a goal. `own` are the facts of the starter, and `own_piece` its mesh.
/// Of several pieces the forces stand on the largest, whose size counts. Returns the facts of the
/// result. Errors: those of `look_at` and `check_moves`; InvalidInput if nothing moves.
Result<StarterFacts> use_own_mesh(SceneDocument& scene, const OwnMesh& mesh,
                                  const StarterFacts& own, const MeshPiece& own_piece,
                                  const StarterSource& source);

/// Makes inertia weaker if it moves the first surface by more than half its size.
Result<void> keep_in_frame(SceneDocument& scene, StarterFacts& facts);

}  // namespace pliant::cli
