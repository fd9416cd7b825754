#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "pliant/core/transform.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::exchange {

/// A quaternion x y z w, as glTF has it; of any length but 0.
using Quaternion = Value<4>;

/// The rotation about x, y and z [degrees], of all that turn alike the nearest to `near`. Where the
/// middle angle is ±90 degrees the first one is that of `near`.
Value<3> euler_near(const Quaternion& rotation, RotateOrder order, const Value<3>& near);

/// The unit quaternion of angles [degrees]; of both, the nearer to `near`.
Quaternion quaternion_near(const Value<3>& degrees, RotateOrder order, const Quaternion& near);

/// Smaller turns are less than rounding makes of quaternions in single precision [degrees].
inline constexpr double least_rotation_tolerance = 5e-6;

/// A rotation over some frames as D numbers, of which several stand for the same: the choice
/// follows the one beside it, so that they change without jumps.
template <int D>
class RotationTrack {
 public:
  /// The numbers at a frame, of all that turn alike the nearest to those beside it.
  using At = std::function<Value<D>(double frame, const Value<D>& beside)>;

  /// `steps`: between which the rotation turns by less than half a turn.
  RotationTrack(At at, double start, double end, const Value<D>& near, int steps)
      : at_(std::move(at)), start_(start), end_(end) {
    Value<D> beside = near;
    for (int k = 0; k <= steps; ++k) {
      beside = at_(frame_of(k, steps), beside);
      samples_.push_back(beside);
    }
  }

  double start() const { return start_; }
  double end() const { return end_; }
  const Value<D>& last() const { return samples_.back(); }

  Value<D> value(double frame) const {
    const double share = (frame - start_) / (end_ - start_);
    const auto steps = samples_.size() - 1;
    const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(steps);
    return at_(frame, samples_[std::min(static_cast<std::size_t>(std::lround(place)), steps)]);
  }

  void add_bounds(Value<D>& low, Value<D>& high) const {
    for (const Value<D>& sample : samples_) {
      for (std::size_t c = 0; c < D; ++c) {
        low[c] = std::min(low[c], sample[c]);
        high[c] = std::max(high[c], sample[c]);
      }
    }
  }

  /// With slopes by differences of second order. The track must outlive it.
  SmoothFunction<D> function() const {
    const auto slope = [this](double frame, double direction) {
      const double step = direction * 1e-4 * (end_ - start_);
      const Value<D> here = value(frame), near = value(frame + step), far = value(frame + 2 * step);
      Value<D> result;
      for (std::size_t c = 0; c < D; ++c)
        result[c] = (4 * (near[c] - here[c]) - (far[c] - here[c])) / (2 * step);
      return result;
    };
    return {[this](double frame) { return value(frame); },
            [slope](double frame) { return slope(frame, 1); },
            [slope](double frame) { return slope(frame, -1); }};
  }

 private:
  double frame_of(int step, int steps) const {
    return step == steps ? end_ : start_ + (end_ - start_) * step / steps;
  }

  At at_;
  double start_;
  double end_;
  std::vector<Value<D>> samples_;
};

/// Between two rotations, along the shorter way, at constant speed. Source: Shoemake, Animating
/// rotation with quaternion curves.
Quaternion slerp(const Quaternion& from, const Quaternion& to, double share);

}  // namespace pliant::exchange
