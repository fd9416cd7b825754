#pragma once

#include <span>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Number of normals of a mesh: one per vertex, or the number of different `corner_normals`.
int normal_count(const Mesh& mesh);

/// The index of a corner's normal.
inline int normal_of(const Mesh& mesh, std::size_t corner) {
  return mesh.corner_normals.empty() ? mesh.corner_vertices[corner] : mesh.corner_normals[corner];
}

/// Whether no corner of the mesh shares its normal with another face.
bool is_flat(const Mesh& mesh);

/// The unit normals (#normals x 3) of a mesh whose vertices are at `positions`: each the sum of the
/// area vectors of the faces around it, so that large faces count more; a face's corners are
/// counter-clockwise seen from the tip of its normal. (0,1,0) if the sum is 0 or not finite, as for
/// a vertex without a face or faces without area.
Field unit_normals(const Mesh& mesh, const Field& positions);

/// The same. Errors: Interrupted.
Result<Field> unit_normals(const Mesh& mesh, const Field& positions,
                           const StopRequest& should_stop);

/// The shading given by a file.
struct Shading {
  static constexpr int unsaid = -1;
  static constexpr int flat = 0;

  std::vector<std::array<double, 3>> normals;  ///< referred to by the corners
  std::vector<int> corner_normals;             ///< #corners: index into `normals`, -1: none
  std::vector<int> smoothing;  ///< #faces: `flat`, `unsaid`, or a number shared by faces that join
                               ///< smoothly; empty: all `unsaid`
};

/// `Mesh::corner_normals` for the shading of a file. Corners of a `flat` face share their normal
/// with no other face. Without normals in the file, other corners share one if they belong to the
/// same vertex and their faces have the same number in `smoothing`. With normals, they share one if
/// normals and positions are equal, so that a surface which the file cuts along a seam stays smooth
/// across it. Empty if an empty vector means the same and the file has no normals. Errors:
/// Interrupted.
Result<std::vector<int>> shared_normals(const Mesh& mesh, const Shading& shading,
                                        const StopRequest& should_stop = {});

}  // namespace pliant
