#pragma once

#include <numbers>

#include "pliant/core/elementary.hpp"
#include "pliant/exchange/segments.hpp"

namespace pliant::exchange {

/// Blender's elastic, if it falls by less than its amplitude: its phase is turned round. Source:
/// BLI_easing_elastic_ease_in and the others, easing.c.
class TurnedElastic {
 public:
  explicit TurnedElastic(const Segment& segment)
      : start_(segment.start),
        length_(segment.length()),
        from_(segment.from),
        change_(segment.to - segment.from),
        side_(segment.easing.side),
        amplitude_(*segment.easing.amplitude),
        period_(segment.easing.period.value_or(0)) {
    if (period_ == 0) period_ = length_ * (side_ == EaseSide::InOut ? 0.45 : 0.3);
    shift_ = period_ / (2 * std::numbers::pi) * asin_of(change_ / amplitude_);
  }

  double value(double frame) const {
    const double u = (frame - start_) / length_;
    if (u <= 0) return from_;
    if (u >= 1) return from_ + change_;
    if (side_ == EaseSide::In) return from_ - wave(u - 1);
    if (side_ == EaseSide::Out) return from_ + change_ + wave(-u);
    const double t = 2 * u - 1;
    return t < 0 ? from_ - wave(t) / 2 : from_ + change_ + wave(-t) / 2;
  }

 private:
  double wave(double t) const {
    return amplitude_ * exp_of(10 * std::numbers::ln2 * t) *
           sin_of((t * length_ - shift_) * 2 * std::numbers::pi / period_);
  }

  double start_, length_, from_, change_;
  EaseSide side_;
  double amplitude_, period_, shift_ = 0;
};

}  // namespace pliant::exchange
