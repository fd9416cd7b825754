#pragma once

#include "pliant/core/field.hpp"
#include "pliant/forces/force.hpp"

namespace pliant {

// Forces evaluated at many positions at once. The results are bit-identical to those of single
// positions: the same operations in the same order, for several positions in parallel.

/// The most positions in a batch.
inline constexpr int batch_size = 32;

/// One vector for each of up to `batch_size` positions, component by component.
struct Batch {
  int count = 0;
  alignas(64) double x[batch_size];
  alignas(64) double y[batch_size];
  alignas(64) double z[batch_size];

  Vector3d at(int k) const { return {x[k], y[k], z[k]}; }
};

/// One number for each position of a batch.
struct BatchNumbers {
  alignas(64) double of[batch_size];
};

/// `distance` at each position. [length]
BatchNumbers distances(const ForceKind& force, const Batch& points);

/// Adds `force_on` of each position to `sums`, from index `first` on; the positions are those of
/// nodes from `node` on. `normals`: of these nodes, not null if `uses_normals`. Requires:
/// force.force_radius > 0.
void add_forces(const SampledForce& force, const Batch& points, const Batch* normals, int node,
                int first, Batch& sums);

/// A lower bound of `distance`, rounding included, for every position whose components are between
/// those of `low` and `high`. For a program's own function the bound is 0.
double least_distance(const ForceKind& force, const Vector3d& low, const Vector3d& high);

}  // namespace pliant
