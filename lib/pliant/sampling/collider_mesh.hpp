#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "pliant/contact/solid_mesh.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/triangles/face_triangles.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The mesh of a collider, as it is read, and as its cache moves it. Thread-safe.
class ColliderMesh {
 public:
  /// Reads the mesh and its cache, and checks that it is closed. `surfaces`: how many meet it.
  /// `memory` takes what it needs. Errors, with the line in the scene: those of `read_mesh`,
  /// `make_surface` and `animate`; an edge without two faces that run through it in opposite
  /// directions; OutOfMemory; Interrupted.
  static Result<std::shared_ptr<const ColliderMesh>> make(const Collider& collider,
                                                          const Scene& scene, std::size_t surfaces,
                                                          const RunContext& context,
                                                          MemoryShare& memory);

  /// Without the collider's transform. Errors: those of `AnimatedShape::nodes_at`.
  Result<std::shared_ptr<const PosedMesh>> at(int frame) const;

  bool is_animated() const { return animation_ != nullptr; }

  /// The triangles with the points of `at_rest`, without (u,v). Edges at which it turns by more
  /// than 40 degrees are hard.
  Mesh drawn() const;

  /// As it is read, whatever its cache says.
  const std::shared_ptr<const PosedMesh>& at_rest() const { return at_rest_; }

 private:
  ColliderMesh() = default;

  FaceTriangles faces_;
  std::shared_ptr<const PosedMesh> at_rest_;
  std::shared_ptr<const AnimatedShape> animation_;  // null: it keeps its shape

  struct Kept {
    std::shared_ptr<const Field> nodes;
    std::shared_ptr<const PosedMesh> posed;
  };
  mutable std::mutex mutex_;        // of what follows
  mutable std::vector<Kept> kept_;  // the last ones, the newest first
};

/// Of the colliders of a scene; null: it has no mesh, or is not told.
using ColliderMeshes = std::vector<std::shared_ptr<const ColliderMesh>>;

/// As `ColliderMesh::make`, but that of the same collider if the context's shelf has it; otherwise
/// the new one is kept there. Requires: the files do not change while the shelf lives.
Result<std::shared_ptr<const ColliderMesh>> find_collider_mesh(const Collider& collider,
                                                               const Scene& scene,
                                                               const RunContext& context,
                                                               MemoryShare& memory);

}  // namespace pliant
