#pragma once

#include <Eigen/LU>

#include "pliant/core/transform.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant::testing {

/// Where the faces of a mesh look, and how large they are: Newell's area vectors, #faces x 3.
inline Field area_vectors(const Mesh& mesh) {
  Field areas = Field::Zero(static_cast<Eigen::Index>(mesh.face_sizes.size()), 3);
  std::size_t first = 0;
  for (Eigen::Index face = 0; face < areas.rows(); ++face) {
    const auto size = static_cast<std::size_t>(mesh.face_sizes[static_cast<std::size_t>(face)]);
    for (std::size_t k = 0; k < size; ++k) {
      const Eigen::RowVector3d a = mesh.positions.row(mesh.corner_vertices[first + k]);
      const Eigen::RowVector3d b = mesh.positions.row(mesh.corner_vertices[first + (k + 1) % size]);
      areas.row(face) += 0.5 * a.cross(b);
    }
    first += size;
  }
  return areas;
}

/// Where the faces look in the world if their outer sides stay the outer ones: a normal goes by the
/// inverse transpose, and its length by the factor of volumes.
inline Field moved_areas(const Field& areas, const Matrix3d& linear) {
  return std::abs(linear.determinant()) * areas * linear.inverse();
}

}  // namespace pliant::testing
