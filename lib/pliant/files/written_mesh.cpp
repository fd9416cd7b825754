#include "pliant/files/written_mesh.hpp"

#include <fmt/format.h>

namespace pliant {

std::string told_as(WrittenAs as, const std::string& name) {
  return fmt::format("{} \"{}\"", as == WrittenAs::Collider ? "collider" : "surface", name);
}

const Mesh& WrittenMesh::in_space(bool is_mirrored) {
  if (!is_mirrored) return *mesh_;
  if (!turned_) {
    turned_ = std::make_unique<Mesh>(*mesh_);
    turn_faces(*turned_);
  }
  return *turned_;
}

}  // namespace pliant
