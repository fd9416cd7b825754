#pragma once

#include <cstddef>
#include <span>
#include <vector>

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

/// The most positions that a program's function is asked for at once: this bounds the memory.
inline constexpr std::size_t most_asked = std::size_t{1} << 16U;

/// Whether a force is asked for up to `most_asked` positions at once, and not for a batch: if a
/// program's functions are of many positions.
inline bool takes_many(const ForceKind& force) {
  const auto* const own = std::get_if<SampledCustomForce>(&force);
  return own && own->is_of_many;
}

inline std::size_t asked_at_once(const ForceKind& force) {
  return takes_many(force) ? most_asked : batch_size;
}

/// `force_on` at each of `points`, of a program's own force: one call of each of its functions.
/// `normals`: of these nodes; empty unless `uses_normals`. Requires: force.force_radius > 0.
std::vector<Vector3d> own_forces(const SampledForce& force, std::span<const Vector3d> points,
                                 std::span<const Vector3d> normals);

/// A lower bound of `distance`, rounding included, for every position whose components are between
/// those of `low` and `high`. For a program's own function the bound is 0.
double least_distance(const ForceKind& force, const Vector3d& low, const Vector3d& high);

}  // namespace pliant
