#pragma once

#include <cstdint>

#include "pliant/core/field.hpp"

namespace pliant {

/// A vector that varies smoothly in space and time, each component in [-1, 1] and 0 on average.
///
/// Every corner of the space-time lattice has a vector that depends on (seed, corner) only. The
/// sixteen corners around a place are blended with weights whose first and second derivatives are 0
/// at the corners: twice continuously differentiable, with hardly any frequency above one wave per
/// cell. docs/model.md, eq. (18) to (20), has the definition. `place` and `time` are counted in
/// cells; a coordinate that is not finite counts as 0.
Vector3d smooth_noise(std::uint64_t seed, const Vector3d& place, double time);

/// The vector of one corner of the lattice, each component one of 2^21 evenly spaced values.
Vector3d lattice_vector(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z,
                        std::int64_t t);

}  // namespace pliant
