#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/carriers.hpp"
#include "pliant/sampling/collider_mesh.hpp"
#include "pliant/sampling/noise_clock.hpp"
#include "pliant/sampling/targets.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// From channels to the values of one frame; not for programs.

/// Invalid results of custom forces: a negative or NaN distance, a force that is not finite. They
/// are replaced by "out of reach" and 0; likewise a cache that cannot be read, and a triangle that
/// carries a force and has no area. The caller that
/// sampled the inputs must end the run.
class ForceFaults {
 public:
  void add(std::string message);
  std::string first() const;  ///< names the force, the position and the value; empty: none
  void clear();

 private:
  mutable std::mutex mutex_;
  std::string first_;
};

/// The origin of a sampled force: a force, or the region of a group.
struct ForceSource {
  std::string_view name;
  std::string_view kind;  ///< the name of its element: point, ..., group; "custom"
  std::span<const std::string> targets;
  bool selects = true;        ///< false: its group selects instead
  std::string_view key = {};  ///< `CustomForce::key`
};

/// The inputs of one surface's step at a frame. Refers to the scene, which must outlive it and not
/// change.
struct SurfaceInputs {
  BodyInputs body;  ///< its forces in the order of the scene, then the regions of groups, if they
                    ///< select
  std::vector<ForceSource> sources;     ///< of `body.forces`; the selector of a force in a group is
                                        ///< that of the group
  std::shared_ptr<ForceFaults> faults;  ///< shared by the custom forces
  std::vector<int> group_selectors = {};  ///< reused to avoid allocations
};

/// A clock for a noise with a keyed rate, in a scene that starts at `start`; null for any other
/// force.
std::unique_ptr<NoiseClock> clock_of(const Force& force, int start);

/// Data for sampling that are the same at all frames of a scene: which forces act on which surface,
/// the clocks of noises with a keyed rate, and animated rest shapes. Stores only indices, so the
/// scene may move, but its surfaces, forces, groups and targets must not change. Thread-safe.
class SceneSampling {
 public:
  explicit SceneSampling(const Scene& scene);

  const SurfaceTargets& targets(std::size_t surface) const { return targets_[surface]; }

  /// Tells of a surface's rest shape and how it moves, before anything of the scene is sampled.
  void tell(std::size_t surface, const RestShape& shape);

  /// Tells of the mesh of a collider, before anything of the scene is sampled.
  void tell_mesh(std::size_t collider, std::shared_ptr<const ColliderMesh> mesh) {
    meshes_[collider] = std::move(mesh);
  }

  /// The mesh of a collider; null: it is none, or not told.
  const std::shared_ptr<const ColliderMesh>& mesh(std::size_t collider) const {
    return meshes_[collider];
  }
  const ColliderMeshes& meshes() const { return meshes_; }

  const Carriers& carriers() const { return *carriers_; }

  /// The animation of a surface's rest shape; null: it stays the same.
  const AnimatedShape* animation(std::size_t surface) const { return animations_[surface].get(); }

  /// The clock of a noise with a keyed rate; null for any other force.
  NoiseClock* clock(std::size_t force) const { return clocks_[force].get(); }

 private:
  std::vector<SurfaceTargets> targets_;
  std::vector<std::unique_ptr<NoiseClock>> clocks_;               // one per force
  std::vector<std::shared_ptr<const AnimatedShape>> animations_;  // one per surface
  ColliderMeshes meshes_;                                         // one per collider
  std::shared_ptr<const Carriers> carriers_;
};

/// The choices of a surface's body; `is_grid`: whether its nodes form a grid.
BodySettings body_settings(const Surface& surface, bool is_grid);

/// The rest shape of a surface's body at a frame and at its neighbours. An error is added to
/// `faults`, and the shape then stands still. `animation` null: none.
ShapeFrames sample_shape(const AnimatedShape* animation, int frame, ForceFaults& faults);

/// The inputs of a surface without forces.
BodyInputs sample_body(const Scene& scene, const Surface& surface, int frame,
                       const ShapeFrames& shape = {});

/// What colliders a surface may meet.
struct MetColliders {
  std::span<const std::size_t> colliders = {};  ///< that target it, by their index in the scene
  std::span<const std::shared_ptr<const ColliderMesh>> meshes = {};  ///< of all of the scene
  const AnimatedShape* animation = nullptr;  ///< of the surface; null: it stays the same
};

/// Adds to the inputs of a surface at a frame which colliders are enabled, and how they and it go
/// on to the next frame. Errors are added to `faults`.
void sample_colliders(const Scene& scene, const Surface& surface, const MetColliders& met,
                      int frame, BodyInputs& inputs, ForceFaults& faults);

/// The inputs of a surface's solve at a frame, as of `solved_frame`; the surface by its index in
/// the scene for which `sampling` was made. Reuses the memory of `reuse`, earlier inputs or empty
/// ones: then only custom functions allocate.
SurfaceInputs sample_inputs(const Scene& scene, const SceneSampling& sampling, std::size_t surface,
                            int frame, SurfaceInputs reuse = {});

/// A force as it acts on `surface`; a force in a group selects no region. Invalid results of custom
/// forces are added to `faults`. `clock` is that of the force; null: the time of a noise with a
/// keyed rate is summed again from the start. `shape` is that of `sample_shape`.
SampledForce sample_force(const Scene& scene, const Force& force, const Surface& surface, int frame,
                          const std::shared_ptr<ForceFaults>& faults, const Carriers& carriers,
                          NoiseClock* clock = nullptr, const ShapeFrames& shape = {});

/// The region of a group. An error of what carries it is added to `faults`.
SampledForce sample_group(const Scene& scene, const Group& group, int frame, ForceFaults& faults,
                          const Carriers& carriers);

/// The solid of a collider at a frame, without the scale; null: a mesh, which is in a file.
std::optional<Solid> shape_at(const Collider& collider, int frame);

/// The same, its scale taken up; null: a mesh that is not given, or whose cache cannot be read.
std::optional<Solid> solid_at(const Collider& collider, int frame,
                              const ColliderMesh* mesh = nullptr);

/// A force or group as it is in the world at a frame: one that follows nothing, with the places and
/// directions that it has there; itself if it follows nothing. Where nothing can carry it, it stays
/// as it is.
Force in_world(const Scene& scene, const Force& force, int frame, const Carriers& carriers);
Group in_world(const Scene& scene, const Group& group, int frame, const Carriers& carriers);

/// The first frame of a run, at which all surfaces are at rest: the scene's start, unless a surface
/// is solved ahead of it or begins a cycle at it, which it enters from the frame before.
int first_frame_of_run(const Scene& scene);

/// The frame whose inputs a surface's solve at `frame` uses: that frame, or in a loop that of its
/// first cycle.
int solved_frame(const Scene& scene, const Surface& surface, int frame);

/// Whether a frame shows the beginning of a cycle of the surface, once more or for the first time.
bool begins_cycle(const Scene& scene, const Surface& surface, int frame);

/// Whether a surface is solved at a frame; otherwise its state does not change.
bool is_solved_at(const Scene& scene, const Surface& surface, int frame);

/// The group of a force; null: none.
const Group* group_of(const Scene& scene, const Force& force);

/// Whether a force, and its group if it has one, is enabled at a frame, and targets a surface.
/// `SceneSampling` knows the targets of all pairs.
bool is_enabled(const Force& force, const Group* group, int frame);
bool targets(const Force& force, const Group* group, const std::string& surface);

}  // namespace pliant
