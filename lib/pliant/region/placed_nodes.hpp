#pragma once

#include <optional>
#include <span>

#include "pliant/core/field.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/batch.hpp"

namespace pliant {

/// Nodes in world space, as forces use them; transformed on demand, so that there is no copy. Keeps
/// a reference to the positions, which must outlive it.
class PlacedNodes {
 public:
  /// #nodes x 3, in world space. Not explicit: the positions are used unchanged.
  PlacedNodes(const Field& positions) : positions_(&positions) {}

  /// #nodes x 3, in object space.
  PlacedNodes(const Field& positions, const Transform& transform)
      : positions_(&positions), transform_(transform) {}

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

 private:
  const Field* positions_;
  std::optional<Transform> transform_;
};

}  // namespace pliant
