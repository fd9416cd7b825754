#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/mesh/drawn_solid.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

class ColliderMesh;

/// The solid of a collider as a mesh that moves, to be drawn and written. Its offset is not part of
/// it.
class DrawnCollider {
 public:
  /// None: a plane, which has no end. `file`: of a mesh, as of `Simulation::collider_mesh`.
  /// Requires: `collider` outlives it; `check_channels` accepts it at all frames asked for. Errors:
  /// as `at`.
  static Result<std::optional<DrawnCollider>> make(const Collider& collider, int first_frame,
                                                   std::shared_ptr<const ColliderMesh> file = {});

  const Collider& collider() const { return *collider_; }
  const Mesh& mesh() const { return solid_.mesh; }  ///< of the first frame

  bool moves_points() const;  ///< whether points may differ from those of the first frame

  /// Points that change only if the lengths do and no scale can say so: those of a capsule, and of
  /// a box with round edges, which also take up its scale. The scale is above 0, but of a mesh.
  /// Errors: those of the cache of a mesh.
  Result<SurfacePose> at(int frame) const;

  Placement placement_at(int frame) const;  ///< that of the pose

  std::size_t bytes() const;  ///< with what a writer keeps of it

 private:
  Result<Field> positions_at(int frame) const;
  DrawnCollider(const Collider& collider, DrawnSolid solid, const SolidLengths& first)
      : collider_(&collider), solid_(std::move(solid)), first_(first) {}

  const Collider* collider_;
  DrawnSolid solid_;
  SolidLengths first_;
  std::shared_ptr<const ColliderMesh> file_ = {};  // null: it is no mesh
};

/// The colliders of a scene that have a mesh and target one of some surfaces, for a writer.
class DrawnColliders {
 public:
  DrawnColliders() = default;

  /// Those that target a surface of the plan, if its format contains colliders. `files`: of each
  /// collider of the scene, as of `Simulation::collider_mesh`. Errors: OutOfMemory if they need
  /// more than `free_memory` [bytes]; those of `DrawnCollider`. Requires: `scene` outlives it.
  static Result<DrawnColliders> make(const Scene& scene,
                                     std::span<const std::shared_ptr<const ColliderMesh>> files,
                                     const AnimationPlan& plan, std::size_t free_memory);

  std::vector<AnimatedSurface> surfaces() const;  ///< valid while this is
  Result<std::vector<SurfacePose>> at(int frame) const;

 private:
  std::vector<DrawnCollider> meshes_;
};

}  // namespace pliant
