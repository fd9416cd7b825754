#pragma once

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant {

/// Fewer keys for nearly the same curve.
template <int D>
struct Simplified {
  CurveKeys<D> keys;
  double error = 0;  ///< bound of the deviation of any component at any frame [unit]
};

/// Replaces rows of segments between keys in [first, last] by cubics in time with the curve's own
/// slopes at their ends, each as long as possible with a deviation of at most `max_error` [unit].
/// The outermost keys in this range, jumps, infinite slopes and easings (already one segment each)
/// are kept, and so is the curve outside, except for copies. The deviation is not sampled: it is a
/// polynomial of the segment's parameter, bounded by its Bernstein coefficients to a thousandth,
/// apart from rounding of the values. If max_error is 0, the keys stay the same. An inner loop with
/// copies is written out. Errors: a frame that is not finite; last < first; max_error not finite or
/// negative. If it is stopped, an error that is an interruption. Cost: O(keys · log keys)
/// polynomials.
template <int D>
[[nodiscard]] Checked<Simplified<D>> simplify(const Curve<D>& curve, double first, double last,
                                              double max_error,
                                              const StopRequest& should_stop = {});

extern template Checked<Simplified<1>> simplify(const Curve<1>&, double, double, double,
                                                const StopRequest&);
extern template Checked<Simplified<3>> simplify(const Curve<3>&, double, double, double,
                                                const StopRequest&);

}  // namespace pliant
