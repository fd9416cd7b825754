#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/mesh/solid_mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The solid of a collider as a mesh that moves, to be drawn and written. Its offset is not part of
/// it.
class ColliderMesh {
 public:
  /// Of one, with what a writer keeps of it, at most. [bytes]
  static constexpr std::size_t most_bytes = std::size_t{1} << 18U;

  /// None: a plane, which has no end. Requires: `collider` outlives it; `check_channels` accepts it
  /// at all frames asked for.
  static std::optional<ColliderMesh> make(const Collider& collider, int first_frame);

  const Collider& collider() const { return *collider_; }
  const Mesh& mesh() const { return solid_.mesh; }  ///< of the first frame

  bool moves_points() const;  ///< whether points may differ from those of the first frame

  /// Points that change only if the lengths do and no scale can say so: those of a capsule, and of
  /// a box with round edges, which also take up its scale. The scale is above 0.
  SurfacePose at(int frame) const;

 private:
  ColliderMesh(const Collider& collider, SolidMesh solid, const SolidLengths& first)
      : collider_(&collider), solid_(std::move(solid)), first_(first) {}

  const Collider* collider_;
  SolidMesh solid_;
  SolidLengths first_;
};

/// The colliders of a scene that have a mesh and target one of some surfaces, for a writer.
class ColliderMeshes {
 public:
  ColliderMeshes() = default;

  /// Those that target a surface of the plan, if its format contains colliders. Errors:
  /// OutOfMemory if they need more than `free_memory` [bytes]. Requires: `scene` outlives it.
  static Result<ColliderMeshes> make(const Scene& scene, const AnimationPlan& plan,
                                     std::size_t free_memory);

  std::vector<AnimatedSurface> surfaces() const;  ///< valid while this is
  std::vector<SurfacePose> at(int frame) const;

 private:
  std::vector<ColliderMesh> meshes_;
};

}  // namespace pliant
