#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant {

// Edits of curves: values in, values out. docs/timeline.md, section "Editing", lists the guarantees
// of each. Besides the errors named here, each may fail with one of `Curve::make`, for example if
// rounding puts two keys on one frame or a number exceeds 1e150.
//
// An edit must often write an automatic tangent as a number, because its slope would change with
// its new neighbours; tangents that stay the same keep their kind.

/// The same curve with one more key, at `frame`; the same keys if there is one already. Bézier and
/// cubicBezier segments are split; quad, cubic, back and bounce become Bézier segments with a key
/// at each of their joints. An inner loop with copies is written out. Errors: a frame that is not
/// finite; a segment of another easing, naming its left key; a frame before or after the keys if
/// one side repeats them.
template <int D>
[[nodiscard]] Checked<Curve<D>> insert_key(const Curve<D>& curve, double frame);

/// The curve without one of its keys: the segment before it is extended to the next key, and
/// automatic tangents follow their new neighbours. If two Bézier segments with written tangents of
/// general length are the halves of one, as after `insert_key`, the tangents beside them are
/// lengthened again and the curve stays the same. Errors: no such key; the only key; the key at
/// which an inner loop starts.
template <int D>
[[nodiscard]] Checked<Curve<D>> delete_key(const Curve<D>& curve, std::size_t key);

/// Change of value, for each component [unit]. Not used to deduce D.
template <int D>
using Rise = std::type_identity_t<Value<D>>;

/// The same for several keys, in the order of their frames, in one pass. `keys`: their indices in
/// the curve, increasing. Errors also: all keys.
template <int D>
[[nodiscard]] Checked<Curve<D>> delete_keys(const Curve<D>& curve,
                                            const std::vector<std::size_t>& keys);

/// The curve with one key moved by `frames`, its value and `left` raised by `rise`; the rest
/// follows from the rules. An inner loop that starts at the key is adjusted; its end stays. Errors:
/// no such key; a number that is not finite; a frame not between those of its neighbours.
template <int D>
[[nodiscard]] Checked<Curve<D>> move_key(const Curve<D>& curve, std::size_t key, double frames,
                                         const Rise<D>& rise);

/// The curve later by `frames` and higher by `rise`: g(t) = f(t - frames) + rise.
/// Errors: a number that is not finite.
template <int D>
[[nodiscard]] Checked<Curve<D>> move_keys(const Curve<D>& curve, double frames,
                                          const Rise<D>& rise);

/// How to stretch a curve, in time about `frame` and in value about `value`.
template <int D>
struct Scaling {
  double frame = 0;
  double time_factor = 1;  ///< [1]; negative: time runs backwards as well
  Value<D> value = {};
  Value<D> value_factor = filled(1);  ///< [1], for each component

  static Value<D> filled(double number) {
    Value<D> value;
    value.fill(number);
    return value;
  }
};

/// g(frame + time_factor·s) = value + value_factor·(f(frame + s) - value).
/// Errors: a factor of 0; a number that is not finite; an elastic with an amplitude, which all
/// components share, and value factors of different size; those of `reverse` when time_factor < 0.
template <int D>
[[nodiscard]] Checked<Curve<D>> scale(const Curve<D>& curve, const Scaling<D>& scaling);

/// Keys with the frames, values, slopes, lengths and parameters of that: kinds of tangents stay,
/// and with them all but rounding. Factors of 0 make a constant. Requires: time_factor > 0; of an
/// elastic with an amplitude, value factors of the same size.
template <int D>
[[nodiscard]] CurveKeys<D> scaled_keys(CurveKeys<D> keys, const Scaling<D>& scaling);

/// The curve run backwards: g(t) = f(2·pivot - t), with the values on both sides of a jump
/// exchanged. On the frame of a jump a curve has its new value, so at that frame alone g has the
/// limit of f from the left. Errors: a pivot that is not finite; a side that repeats for a number
/// of copies and then holds the value of an end key that jumps, which no key of the reversed curve
/// can express.
template <int D>
[[nodiscard]] Checked<Curve<D>> reverse(const Curve<D>& curve, double pivot);

/// The curve whose keys in [first, last] give way to those of a piece, such as a recorded one. But
/// for the segments that join them, all values between the keys outside, and between those of the
/// piece, stay to the bit. What is before and after the keys goes on as the curve's does; that of
/// the piece does not count. An inner loop is written out, unless it is the curve's and the piece
/// is beside all its copies. Errors: a frame that is not finite; last < first; a key of the piece
/// outside [first, last].
template <int D>
[[nodiscard]] Checked<Curve<D>> splice(const Curve<D>& curve, double first, double last,
                                       const Curve<D>& piece);

extern template Checked<Curve<1>> insert_key(const Curve<1>&, double);
extern template Checked<Curve<3>> insert_key(const Curve<3>&, double);
extern template Checked<Curve<1>> delete_key(const Curve<1>&, std::size_t);
extern template Checked<Curve<3>> delete_key(const Curve<3>&, std::size_t);
extern template Checked<Curve<1>> delete_keys(const Curve<1>&, const std::vector<std::size_t>&);
extern template Checked<Curve<3>> delete_keys(const Curve<3>&, const std::vector<std::size_t>&);
extern template Checked<Curve<1>> move_key(const Curve<1>&, std::size_t, double, const Value<1>&);
extern template Checked<Curve<3>> move_key(const Curve<3>&, std::size_t, double, const Value<3>&);
extern template Checked<Curve<1>> move_keys(const Curve<1>&, double, const Value<1>&);
extern template Checked<Curve<3>> move_keys(const Curve<3>&, double, const Value<3>&);
extern template Checked<Curve<1>> scale(const Curve<1>&, const Scaling<1>&);
extern template Checked<Curve<3>> scale(const Curve<3>&, const Scaling<3>&);
extern template CurveKeys<1> scaled_keys(CurveKeys<1>, const Scaling<1>&);
extern template CurveKeys<3> scaled_keys(CurveKeys<3>, const Scaling<3>&);
extern template Checked<Curve<1>> reverse(const Curve<1>&, double);
extern template Checked<Curve<3>> reverse(const Curve<3>&, double);
extern template Checked<Curve<1>> splice(const Curve<1>&, double, double, const Curve<1>&);
extern template Checked<Curve<3>> splice(const Curve<3>&, double, double, const Curve<3>&);

}  // namespace pliant
