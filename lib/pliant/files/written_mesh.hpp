#pragma once

#include <memory>
#include <string>

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
