#pragma once

#include <array>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"

namespace pliant {

/// The triangles of a surface as corners. Their points are its nodes, then the centres of its faces
/// that have one, each the mean of its corners.
struct FaceTriangles {
  using Corners = std::array<int, 3>;

  FaceTriangles() = default;

  /// Unfinished if it is stopped.
  FaceTriangles(const TriangleSurface& surface, StopPoll& poll);

  std::vector<Corners> triangles;
  int node_count = 0;
  std::vector<int> centre_starts = {0};  ///< #centres + 1
  std::vector<int> centre_nodes;         ///< the nodes whose mean a centre is

  int centre_count() const { return static_cast<int>(centre_starts.size()) - 1; }

  /// The place of a point for places of the nodes (#nodes x 3).
  Vector3d point(int index, const Field& nodes) const;

  /// All points (#points x 3). Unfinished if it is stopped.
  Field with_centres(const Field& nodes, StopPoll& poll) const;
};

}  // namespace pliant
