#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

/// The most intervals that are sampled together.
inline constexpr std::size_t most_intervals = 32;

/// Points of the Sobol' sequence with the direction numbers of Joe and Kuo (new-joe-kuo-6) in
/// Gray-code order, without its point 0: (1/2, 1/2, 1/2), (3/4, 1/4, 1/4), (1/4, 3/4, 3/4), …
/// By Boost.Random. Source: Joe, Kuo, Constructing Sobol sequences with better two-dimensional
/// projections, SIAM J. Sci. Comput. 30 (2008).
///
/// Returns point `first` to `first + count - 1`, counted from 0: count x dimensions, each in [0,
/// 1). Requires: 1 <= dimensions <= most_intervals.
std::vector<double> sobol_points(std::size_t dimensions, std::uint64_t first, std::size_t count);

}  // namespace pliant
