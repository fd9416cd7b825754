#pragma once

#include <functional>
#include <span>
#include <vector>

#include "pliant/core/transform.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/region/placed_nodes.hpp"

namespace pliant {

/// How deep the nodes around a region lie in the forces' spheres: phi, the largest of deformation
/// radius - distance over the forces [length], linear on each triangle. The region is where it is
/// not negative. docs/model.md, "Surfaces".
struct LevelSet {
  std::vector<int> faces;          ///< those with a corner where phi > 0, ascending
  std::vector<int> nodes;          ///< their corners, ascending
  std::vector<int> corner_starts;  ///< #faces + 1: the first corner of each in `corners`
  std::vector<int> corners;        ///< index into `nodes` of each corner of `faces`
  std::vector<double> at_nodes;    ///< phi of each of `nodes`
  std::vector<double> at_centres;  ///< phi at the centre of each of `faces`; 0 for a triangle

  /// Indices into `nodes` of the corners of faces[k].
  std::span<const int> corners_of(std::size_t k) const {
    return std::span(corners).subspan(corner_starts[k], corner_starts[k + 1] - corner_starts[k]);
  }

  /// phi of a node of the surface; negative if it is not among `nodes`.
  double at_node(int node) const;

  friend bool operator==(const LevelSet&, const LevelSet&) = default;
};

/// How deep a node lies in what selects besides forces, as phi is meant. [length]
using NodeDepth = std::function<double(int node)>;

/// Finds phi of the forces that select, on the rest positions under `transform`. `tree` is of the
/// surface's nodes; `selectors` as in `BodyInputs`: a force that another one selects for does not
/// count. A program's own function, and each of `others`, is called for every node. Cost: that of
/// the nodes within reach, not of all.
LevelSet find_level_set(const TriangleSurface& surface, const PointTree& tree,
                        const Transform& transform, std::span<const SampledForce> forces,
                        std::span<const int> selectors, std::span<const NodeDepth> others = {});

/// How deep each of `nodes` lies in a sphere around a force: radius - distance, within the bounds
/// -1e150 and 1e150, so that it is finite however far a program's own force says it is. [length]
std::vector<double> depths_of(const PlacedNodes& placed, std::span<const int> nodes,
                              const ForceKind& force, double radius,
                              std::vector<double> reuse = {});

/// For each of the level set's nodes, whether it is nearer to a force than its deformation radius,
/// at rest under `transform`.
std::vector<bool> nodes_within(const TriangleSurface& surface, const LevelSet& level_set,
                               const Transform& transform, const SampledForce& force);

/// Whether any node at rest is nearer to a force than `radius`, or, with `with_faces`, any place on
/// a face.
bool reaches(const TriangleSurface& surface, const PointTree& tree, const Transform& transform,
             const SampledForce& force, double radius, bool with_faces);

/// A snapped level set in which `nodes` (ascending) count as inside too, and with them the centres
/// of their faces; the other corners of these faces are held if they were outside.
LevelSet with_inside(const TriangleSurface& surface, const LevelSet& level_set,
                     std::span<const int> nodes);

/// Values on `nodes` (#nodes of the level set) as their means at the centres of its faces; 0 for a
/// triangle.
std::vector<double> means_at_centres(const LevelSet& level_set, std::span<const double> at_nodes,
                                     std::vector<double> reuse = {});

/// Lets the rim pass through a node or centre wherever it would pass very close to one, so that no
/// cell becomes a sliver: phi becomes 0 there.
void snap(LevelSet& level_set);

}  // namespace pliant
