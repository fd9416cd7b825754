#pragma once

#include <memory>

#include "pliant/mesh/mesh.hpp"

namespace pliant {

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
