#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/result.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

// How a mesh is written. Internal to output.
enum class WrittenAs {
  Surface,        // its positions are in the world
  PlacedSurface,  // they are in object space
  Collider,       // likewise, and mostly do not change
};

/// Of the material of colliders: red, green and blue, linear.
inline constexpr double collider_grey = 0.25;

/// It in a message: `surface "mat"`.
std::string told_as(WrittenAs as, const std::string& name);

// Adds what a plan has, surfaces, then colliders: `add(surface, written_as)`.
template <class Add>
Result<void> add_things(const AnimationPlan& plan, const Add& add) {
  for (const AnimatedSurface& surface : plan.surfaces) {
    auto added = add(surface, plan.is_placed ? WrittenAs::PlacedSurface : WrittenAs::Surface);
    if (!added) return added;
  }
  for (const AnimatedSurface& collider : plan.colliders) {
    if (auto added = add(collider, WrittenAs::Collider); !added) return added;
  }
  return {};
}

// Adds the poses of a frame to what is written, surfaces, then colliders: `add(thing, pose)`. There
// are as many poses as things.
template <class Thing, class Add>
Result<void> add_poses(std::vector<Thing>& things, std::span<const SurfacePose> surfaces,
                       std::span<const SurfacePose> colliders, const Add& add) {
  PLIANT_EXPECTS(surfaces.size() + colliders.size() == things.size());
  auto thing = things.begin();
  for (const std::span<const SurfacePose> poses : {surfaces, colliders}) {
    for (const SurfacePose& pose : poses) {
      if (auto added = add(*thing++, pose); !added) return added;
    }
  }
  return {};
}

// A mesh in the spaces that it is written in. Internal to output.
class WrittenMesh {
 public:
  explicit WrittenMesh(const Mesh& mesh) : mesh_(&mesh) {}  ///< must outlive it

  /// The mesh for positions in a space that is mirrored or not: if it is, with its faces turned
  /// round. That one is made when it is first asked for; both stay where they are.
  const Mesh& in_space(bool is_mirrored);

 private:
  const Mesh* mesh_;
  std::unique_ptr<Mesh> turned_;
};

}  // namespace pliant
