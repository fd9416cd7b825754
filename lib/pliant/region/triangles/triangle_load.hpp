#pragma once

#include <span>
#include <vector>

#include "pliant/forces/force.hpp"
#include "pliant/region/placed_nodes.hpp"
#include "pliant/region/selection.hpp"
#include "pliant/region/triangles/triangle_cut.hpp"

namespace pliant {

/// The loads of forces on the patches of a region, one force after the other. The area on which a
/// force acts is cut where force radius - distance, linear on each triangle, changes its sign, so
/// that the load of a moving force moves evenly. docs/model.md, "Surfaces".
class TriangleLoads {
 public:
  /// `measured` are the nodes of the surface from which distances are measured, world space.
  /// Requires: all outlive it.
  TriangleLoads(const LevelSet& level_set, std::span<const TrianglePatch> patches,
                const PlacedNodes& measured)
      : level_set_(level_set), patches_(patches), measured_(measured) {}

  /// Computes the loads of a force: then `loads` are valid. Whether it acts on a free
  /// node's area, be its push 0 or not.
  bool compute(const SampledForce& force);

  /// Of the last force on the free nodes of a patch (#free_nodes x 3, world space): its force times
  /// the area that the node stands for. [length b length^2/uv^4]
  const Field& loads(std::size_t patch) const { return loads_[patch]; }

  /// The sum of the last force's loads on all patches, per area.
  Push push() const;

 private:
  std::vector<double> areas_on(const TrianglePatch& patch) const;

  const LevelSet& level_set_;
  std::span<const TrianglePatch> patches_;
  const PlacedNodes& measured_;
  std::vector<double> at_nodes_, at_centres_;  // force radius - distance
  std::vector<Field> loads_;
};

}  // namespace pliant
