#pragma once

#include <optional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::timeline {

/// A tangent with a written slope [unit/frame], 0 in place of -0.
template <int D>
Tangent<D> slope_tangent(const Value<D>& slope) {
  Tangent<D> tangent;
  tangent.kind = Tangent<D>::Kind::Slope;
  for (int c = 0; c < D; ++c) tangent.slope[c] = slope[c] + 0.0;
  return tangent;
}

/// The slopes with which the tangents of a key shape the curve [unit/frame]; nullopt if unused.
template <int D>
struct KeySlopes {
  std::optional<Value<D>> in = {};
  std::optional<Value<D>> out = {};
};

/// The slopes that follow from automatic tangents and linear extrapolation: an edit must not change
/// them.
template <int D>
struct Shape {
  std::vector<KeySlopes<D>> keys;
  /// Slope before the first key, read by `linear` [unit/frame]; nullopt: it follows the keys.
  std::optional<Value<D>> before = {};
  std::optional<Value<D>> after = {};
};

/// Allowed change by rounding: values [unit] and frames. Default: none.
struct Slack {
  double value = 0;
  double frame = 0;
};

/// The same curve with the inner loop's copies written out as keys.
/// Errors: those of `written_out`. Requires: broken_rule(keys) finds nothing.
template <int D>
[[nodiscard]] Checked<CurveKeys<D>> without_loop(const CurveKeys<D>& keys);

/// The shape of keys. Errors: those of `Curve::make`. Requires: no loop with copies.
template <int D>
[[nodiscard]] Checked<Shape<D>> shape_of(const CurveKeys<D>& keys,
                                         const StopRequest& should_stop = {});

/// The curve of edited keys, with the given shape: a tangent whose slope would follow its new
/// neighbours is written as a number, with its length, and so is a linear extrapolation whose slope
/// would change. Everything that stays the same keeps its kind. Errors: those of `Curve::make`.
/// Requires: no loop with copies; `shape` has as many keys.
template <int D>
[[nodiscard]] Checked<Curve<D>> preserved(CurveKeys<D> keys, const Shape<D>& shape,
                                          const Slack& slack = {},
                                          const StopRequest& should_stop = {});

/// Allowed rounding for keys that are moved as a whole: 64 units in the last place of the largest
/// value and of the largest frame.
template <int D>
Slack rounding_of(const CurveKeys<D>& keys);

/// Whether the keys of an author, with their loop written out, equal `written` and have its shape.
template <int D>
bool stands_for(const CurveKeys<D>& author, const CurveKeys<D>& written, const Shape<D>& shape,
                const Slack& slack);

/// Writes the lengths of Bézier tangents that `policy` changes into the keys. Requires: no loop
/// with copies.
template <int D>
void write_corrections(CurveKeys<D>& keys, Overshoot policy);

extern template Checked<CurveKeys<1>> without_loop(const CurveKeys<1>&);
extern template Checked<CurveKeys<3>> without_loop(const CurveKeys<3>&);
extern template Checked<Shape<1>> shape_of(const CurveKeys<1>&, const StopRequest&);
extern template Checked<Shape<3>> shape_of(const CurveKeys<3>&, const StopRequest&);
extern template Checked<Curve<1>> preserved(CurveKeys<1>, const Shape<1>&, const Slack&,
                                            const StopRequest&);
extern template Checked<Curve<3>> preserved(CurveKeys<3>, const Shape<3>&, const Slack&,
                                            const StopRequest&);
extern template Slack rounding_of(const CurveKeys<1>&);
extern template Slack rounding_of(const CurveKeys<3>&);
extern template bool stands_for(const CurveKeys<1>&, const CurveKeys<1>&, const Shape<1>&,
                                const Slack&);
extern template bool stands_for(const CurveKeys<3>&, const CurveKeys<3>&, const Shape<3>&,
                                const Slack&);
extern template void write_corrections(CurveKeys<1>&, Overshoot);
extern template void write_corrections(CurveKeys<3>&, Overshoot);

}  // namespace pliant::timeline
