#pragma once

#include <cstddef>

#include "pliant/timeline/curve.hpp"

namespace pliant {

namespace timeline {
template <int D>
struct Extrapolated;
template <int D>
struct Segment;
}  // namespace timeline

/// Evaluates one curve at one frame after the other. It remembers the last segment, so that
/// playback needs no search; the values are bit-identical to those of the curve. Not thread-safe;
/// use one sampler per thread.
template <int D>
class Sampler {
 public:
  /// Requires: the curve outlives the sampler and is not moved.
  explicit Sampler(const Curve<D>& curve);
  explicit Sampler(Curve<D>&&) = delete;

  Value<D> value(double frame);          ///< see Curve. Amortised O(1) from frame to frame
  Value<D> left_value(double frame);     ///< see Curve
  Value<D> velocity(double frame);       ///< see Curve
  Value<D> left_velocity(double frame);  ///< see Curve

 private:
  std::size_t locate(double frame);
  [[gnu::noinline]] Value<D> value_anywhere(double frame);  // keeps value() short
  [[gnu::noinline]] Value<D> adjusted_anywhere(double frame);

  const timeline::Extrapolated<D>* curve_;
  const Adjustments<D>* adjustments_;           // null: none
  const timeline::Segment<D>* here_ = nullptr;  // of the last frame; null for a single key
  const timeline::Segment<D>* last_ = nullptr;  // the last one of the curve
};

extern template class Sampler<1>;
extern template class Sampler<3>;

}  // namespace pliant
