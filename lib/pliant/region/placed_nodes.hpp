#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/batch.hpp"
#include "pliant/mesh/node_faces.hpp"

namespace pliant {

/// Nodes in world space, as forces use them; transformed on demand, so that there is no copy. Keeps
/// a reference to the positions, the faces and the factors of density, which must outlive it.
class PlacedNodes {
 public:
  /// #nodes x 3, in world space. Not explicit: the positions are used unchanged.
  PlacedNodes(const Field& positions) : positions_(&positions) {}

  /// #nodes x 3, in object space.
  /// `densities`: the factor of each node's density, which its inertia is multiplied by; null or
  /// empty: 1. `faces`: those of the surface, for its normals; null if no force uses them.
  PlacedNodes(const Field& positions, const Transform& transform,
              const std::vector<double>* densities = nullptr, const NodeFaces* faces = nullptr);

  Eigen::Index count() const { return positions_->rows(); }

  /// World [length].
  Vector3d at(int node) const {
    const Vector3d position = positions_->row(node).transpose();
    return transform_ ? to_world(*transform_, position) : position;
  }

  /// `count` nodes from node `first` on, world [length]; the numbers are those of `at`. Requires: 0
  /// <= count <= batch_size.
  Batch batch(int first, int count) const;

  /// The same for any nodes.
  Batch batch(std::span<const int> nodes) const;

  /// The distances of nodes from a force. Of a program's own, one call for `asked_at_once`.
  std::vector<double> distances(std::span<const int> nodes, const ForceKind& force,
                                std::vector<double> reuse = {}) const;

  /// The normal of a node, world; of length 1 or 0. Requires: there are faces.
  Vector3d normal(int node) const { return normal_at(*faces_, *positions_, to_normals_, node); }

  /// The force on a node [length b/uv^4]. Requires: force.force_radius > 0; faces if it uses them.
  Vector3d load_on(int node, const SampledForce& force) const;

  /// The same on each of `nodes`. Of a program's own, one call of each function for
  /// `asked_at_once`.
  std::vector<Vector3d> loads_on(std::span<const int> nodes, const SampledForce& force) const;

  /// Adds `load_on` of `count` nodes from node `first` on to `sums`, from index `place` on.
  /// Requires: as for `batch` and `load_on`.
  void add_loads(int first, int count, const SampledForce& force, int place, Batch& sums) const;

 private:
  std::vector<Vector3d> places_of(std::span<const int> nodes) const;

  // Whether the force on a node is multiplied by the factor of its density.
  bool is_weighted(const SampledForce& force) const {
    return densities_ && std::holds_alternative<InertiaForce>(force.kind);
  }

  const Field* positions_;
  std::optional<Transform> transform_;
  const std::vector<double>* densities_ = nullptr;
  const NodeFaces* faces_ = nullptr;
  Matrix3d to_normals_ = Matrix3d::Identity();  // of vector areas
};

}  // namespace pliant
