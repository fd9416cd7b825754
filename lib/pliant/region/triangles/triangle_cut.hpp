#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/triangle_cells.hpp"
#include "pliant/mesh/mesh_reading.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/region/selection.hpp"
#include "pliant/region/triangles/level_set.hpp"

namespace pliant {

/// A corner of cells that is no node.
struct CutPoint {
  enum class Kind {
    Centre,  ///< of a face
    Rim,     ///< where phi is 0 on an edge
    Part,    ///< the mean of the corners of a part of a triangle
  };

  Kind kind = Kind::Centre;
  int face = -1;  ///< of a centre: index into the level set's faces

  /// Of a point on the rim: the ends of its edge, the first of them inside. An end is an index
  /// into the level set's nodes, or -1 - k for the centre of faces[k]. Of the mean of a part: its
  /// four corners, as points of the patch.
  std::array<int, 4> of = {};
  double t = 0;  ///< on the rim: its share of the way from the first end to the second
};

/// A connected part of a region: its cells, and what its points are. Free nodes come first, then
/// all other free points, then what is held.
struct TrianglePatch {
  TriangleCells cells;

  /// #points: the index of a node in the level set's `nodes`, or -1 - k for `cut_points[k]`.
  std::vector<int> points;
  std::vector<CutPoint> cut_points;
  int free_nodes = 0;
  std::vector<double> masses;  ///< #free_nodes: its share of the area [length^2]

  bool may_float = false;       ///< whether it moves if nothing is held
  bool has_rim = true;          ///< what is held of it are not only nodes within
  bool is_held_within = false;  ///< such nodes hold it, or a goal does

  bool is_held() const {
    return is_held_within || (has_rim && cells.free_points < cells.point_count);
  }

  /// Whether it is solved.
  bool moves() const { return free_nodes > 0 && (may_float || is_held()); }

  CutCounts counts(const LevelSet& level_set) const;

  /// The same of the nodes (#nodes of the level set) that are `within`, and the cells at them.
  CutCounts counts_of(const std::vector<bool>& within) const;
};

/// Hands what lies on the points of a patch (#points) to its free nodes (#free_nodes): the mean of
/// a part hands its share on in equal parts to its corners, then a centre to the corners of its
/// face; what then lies on anything but a free node is dropped.
std::vector<double> shared_out(const TrianglePatch& patch, const LevelSet& level_set,
                               std::vector<double> at_points);

/// A function that is linear on each triangle, on the points of a patch (#points): from its values
/// on the nodes and at the centres of the level set.
std::vector<double> values_at_points(const TrianglePatch& patch, std::span<const double> at_nodes,
                                     std::span<const double> at_centres);

/// Cuts the region phi >= 0 out of the triangles. `is_border` (#nodes of the surface) marks the
/// nodes of edges with one face; `held` (#nodes, or empty) those that are held wherever they are.
/// The patches are in the order of their first cells. Requires: `level_set` is snapped. Errors:
/// Interrupted. Cost: proportional to the region.
Result<std::vector<TrianglePatch>> cut_out(const TriangleSurface& surface,
                                           const LevelSet& level_set,
                                           const std::vector<bool>& is_border, Border border,
                                           const StopRequest& should_stop = {},
                                           std::span<const std::uint8_t> held = {});

}  // namespace pliant
