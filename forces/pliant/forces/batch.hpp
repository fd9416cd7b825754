#pragma once

#include "pliant/core/field.hpp"
#include "pliant/forces/force.hpp"

namespace pliant {

// Forces asked about many positions at once. The numbers are those of the same questions asked one
// by one, to the last bit: the same exact operations in the same order, several positions beside
// each other.

/// The most positions of a batch.
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
  alignas(64) double of[batch_size] = {};
};

/// `distance` from each. [length]
BatchNumbers distances(const ForceShape& shape, const Batch& points);

/// Adds `force_at` each position to `sums`, number `first` on. Requires: force.force_radius > 0.
void add_forces(const SampledForce& force, const Batch& points, int first, Batch& sums);

/// A lower bound of what `distance` gives, its rounding included, for every position whose
/// components lie between those of `low` and `high`. A program's own function has none but 0.
double least_distance(const ForceShape& shape, const Vector3d& low, const Vector3d& high);

}  // namespace pliant
