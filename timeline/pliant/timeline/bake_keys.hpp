#pragma once

#include <tl/expected.hpp>

#include "pliant/timeline/curve.hpp"

namespace pliant {

/// A key every `step` frames from `first` on, and one at `last`, with the values of the curve and,
/// for Bezier, its slopes as numbers: a smooth curve is met to fourth order in the step. Where the
/// curve jumps on such a frame, the key has what it arrives with as `left`; a jump between two of
/// them takes the whole span, and an infinite slope counts as that of the straight line. The keys
/// hold on both sides, and what the inner loop and the outsides show is written out.
/// `next`: Linear or Bezier. Errors: another kind; a number that is not finite; a step that is not
/// positive; last < first; more than a million keys; keys on one frame after rounding.
template <int D>
[[nodiscard]] tl::expected<CurveKeys<D>, CurveError> bake_keys(
    const Curve<D>& curve, double first, double last, double step,
    Interpolation::Kind next = Interpolation::Kind::Bezier);

extern template tl::expected<CurveKeys<1>, CurveError> bake_keys(const Curve<1>&, double, double,
                                                                 double, Interpolation::Kind);
extern template tl::expected<CurveKeys<3>, CurveError> bake_keys(const Curve<3>&, double, double,
                                                                 double, Interpolation::Kind);

}  // namespace pliant
