#pragma once

#include <memory>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/adjustment.hpp"
#include "pliant/timeline/bounds.hpp"
#include "pliant/timeline/curve_report.hpp"
#include "pliant/timeline/handle.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant {

template <int D>
class Sampler;

namespace timeline {
template <int D>
struct Extrapolated;
}

/// The least and the greatest value of a curve over an interval, per component [unit].
template <int D>
using ValueRange = timeline::Bounds<D>;

/// A keyframe curve with D components as a function of the frame: keys compiled into segments that
/// are cheap and exact to evaluate. An immutable value, safe to share between threads; evaluation
/// neither allocates nor locks. The rules are in docs/timeline.md.
///
/// Between the keys a value is finite for all keys. Outside them a slope or an offset may make it
/// infinite, and the velocity is infinite at a vertical tangent; the caller checks. The value is
/// NaN only for a frame that is NaN.
template <int D>
class Curve {
 public:
  /// Errors, naming the key: no keys; a number that is not finite or beyond 1e150; a frame not
  /// greater than the one before; x1 or x2 of cubicBezier outside [0, 1]; more than 1e15 periods of
  /// an elastic in its segment; overshoot = Error and a tangent that makes time run backwards; a
  /// number of copies that is not an integer >= 1; a loop that does not start at a key, does not
  /// end after it, has a negative number of copies, or writes out more than a million keys or two
  /// on one frame; keys so close that the slope between them overflows. Notes (legal): a negative
  /// length, which counts as 0; a handle that points backwards, which is ignored; a tangent that
  /// `overshoot` changed; `left` after a step; a key hidden by the loop; a loop without copies.
  /// If it is stopped, an error that is an interruption.
  [[nodiscard]] static Checked<Curve> make(CurveKeys<D> keys, const StopRequest& should_stop = {});

  Curve(const Curve&);  ///< shares its keys: of constant cost
  Curve(Curve&&) noexcept;
  Curve& operator=(const Curve&);
  Curve& operator=(Curve&&) noexcept;
  ~Curve();

  Value<D> value(double frame) const;       ///< [unit]. Requires: finite. O(log keys)
  Value<D> left_value(double frame) const;  ///< the limit from the left [unit]
  Value<D> velocity(double frame) const;    ///< the limit of the slope from the right [unit/frame]
  Value<D> left_velocity(
      double frame) const;  ///< the limit of the slope from the left [unit/frame]

  /// The least and greatest value over [from, to], from closed-form extrema, including the
  /// one-sided limits inside. The cost grows with the number of keys in between; a loop counts once
  /// for any number of copies.
  ValueRange<D> range(double from, double to) const;

  /// The curve whose values are those of this one, adjusted. Requires: no component is adjusted
  /// already.
  Curve adjusted(const Adjustments<D>& adjustments) const;

  /// What it is adjusted by; null: it is not.
  const Adjustments<D>* adjustments() const;

  /// The curve that was adjusted; itself if none was.
  Curve unadjusted() const;

  /// Of an adjusted curve, its keys with values, slopes and handles adjusted, for drawing it.
  const CurveKeys<D>& keys() const;
  const std::vector<CurveNote>& notes() const;

  /// The handles of the Bézier segments, `out` and `in` of each, with those of a loop's copies, in
  /// the order of frames: for drawing the curve as its author sees it.
  const std::vector<KeyHandle<D>>& handles() const;

  /// The same keys and adjustments. Requires: neither is moved from.
  friend bool operator==(const Curve& a, const Curve& b) { return a.is_equal(b); }

 private:
  friend class Sampler<D>;

  struct Shared;

  const timeline::Extrapolated<D>& compiled() const;

  explicit Curve(Shared shared);
  explicit Curve(std::shared_ptr<const Shared> shared);
  bool is_equal(const Curve& other) const;

  std::shared_ptr<const Shared> shared_;  // of all copies; null once moved from
};

extern template class Curve<1>;
extern template class Curve<3>;

}  // namespace pliant
