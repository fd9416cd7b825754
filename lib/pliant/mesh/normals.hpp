#pragma once

#include <span>
#include <vector>

#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// How many normals a mesh has: one a vertex, or as many as `corner_normals` numbers.
int normal_count(const Mesh& mesh);

/// The number of a corner's normal.
inline int normal_of(const Mesh& mesh, std::size_t corner) {
  return mesh.corner_normals.empty() ? mesh.corner_vertices[corner] : mesh.corner_normals[corner];
}

/// Whether no corner of the mesh shares its normal with another face.
bool is_flat(const Mesh& mesh);

/// The unit normals (#normals x 3) of a mesh whose vertices are at `positions`: each the sum of the
/// area vectors of the faces around, so that large faces count for more; a face's corners run
/// counter-clockwise seen from where its normal points. (0,1,0) where the sum is 0 or not finite:
/// of a vertex without a face, of faces without an area.
Field unit_normals(const Mesh& mesh, const Field& positions);

/// What a file says of its shading.
struct Shading {
  static constexpr int unsaid = -1;
  static constexpr int flat = 0;

  std::vector<std::array<double, 3>> normals;  ///< that the corners refer to
  std::vector<int> corner_normals;             ///< #corners: index into `normals`, -1: none
  std::vector<int> smoothing;  ///< #faces: `flat`, `unsaid`, or a number that faces which join
                               ///< smoothly have in common; empty: unsaid of all
};

/// `Mesh::corner_normals` as a file means it. Corners of a `flat` face share with nobody. Others do
/// where their faces have the same number in `smoothing` and they are one vertex; or if the file
/// gives them normals, where these and the positions are equal, so that a surface which the file
/// cuts along a seam stays smooth over it. Empty where that is what an empty one means and no
/// normals were given.
std::vector<int> shared_normals(const Mesh& mesh, const Shading& shading);

}  // namespace pliant
