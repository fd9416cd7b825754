#pragma once

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant {

/// A key every `step` frames from `first` on, and one at `last`, with the values of the curve and,
/// for Bezier, its slopes as numbers: for a smooth curve the error is of fourth order in the step.
/// If the curve jumps at such a frame, `left` of the key is the limit from the left; a jump between
/// two keys is spread over the whole span, and an infinite slope is replaced by that of the
/// straight line. The result is constant outside the keys; the inner loop and the copies on both
/// sides are written out. `next`: Linear or Bezier. Errors: another kind; a number that is not
/// finite; a step that is not positive; last < first; more than a million keys; keys on one frame
/// after rounding; an interruption if it is stopped.
template <int D>
[[nodiscard]] Checked<CurveKeys<D>> bake_keys(
    const Curve<D>& curve, double first, double last, double step,
    Interpolation::Kind next = Interpolation::Kind::Bezier, const StopRequest& should_stop = {});

extern template Checked<CurveKeys<1>> bake_keys(const Curve<1>&, double, double, double,
                                                Interpolation::Kind, const StopRequest&);
extern template Checked<CurveKeys<3>> bake_keys(const Curve<3>&, double, double, double,
                                                Interpolation::Kind, const StopRequest&);

}  // namespace pliant
