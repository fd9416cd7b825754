#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"

namespace pliant {

struct RestShape;

/// Segments on a surface. Their ends are points that are weighted sums of nodes, or of the vertices
/// of a mesh, so that they follow it.
struct SurfaceLines {
  std::vector<int> starts = {0};  ///< #points + 1: the first entry of each point
  std::vector<int> sources;       ///< #entries: a node or vertex, or -1 - k for the earlier point k
  std::vector<double> shares;     ///< #entries; those of a point add up to 1
  std::vector<std::array<int, 2>> segments;  ///< two points each

  int point_count() const { return static_cast<int>(starts.size()) - 1; }

  void add_source(int source, double share);  ///< of the point that is added next
  int add_point();                            ///< the sum of these sources; its number

  /// The points (#points x 3) for positions of the nodes or vertices (#rows x 3).
  Field points(const Field& positions) const;
};

/// The outline of a connected part of a region that is cut out of triangles, between nodes: where
/// phi is 0, and along a border that is held.
struct PatchOutline {
  bool is_solved = false;  ///< whether it moves
  SurfaceLines lines;
};

/// The vertex of the mesh as it is written at which each node is drawn (#nodes); -1: none. If each
/// vertex moves as its node, it is the lowest one. The vertices of a net or of a subdivided cage
/// are sums of nodes, which do not lie on the mesh: there it is the one in which the node has the
/// greatest share, the first of equals.
std::vector<int> node_vertices(const RestShape& shape);

/// Takes lines from the nodes of a surface to the vertices of its mesh as it is written. Nodes are
/// at their `node_vertices`; of a net or a subdivided cage, lines between them run along the
/// closest points of the mesh at rest.
class LinesOnMesh {
 public:
  /// Requires: `shape` outlives it.
  explicit LinesOnMesh(const RestShape& shape);
  LinesOnMesh(LinesOnMesh&&) noexcept;
  LinesOnMesh& operator=(LinesOnMesh&&) noexcept;
  ~LinesOnMesh();

  /// Lines between vertices, for lines between nodes.
  SurfaceLines to_vertices(const SurfaceLines& of_nodes) const;

  /// The outline of the cells of some boxes of a grid, between vertices; a box without cells is a
  /// line. Requires: the shape has a grid.
  SurfaceLines around(std::span<const Box> boxes) const;

 private:
  class Mapping;
  std::unique_ptr<const Mapping> mapping_;
};

}  // namespace pliant
