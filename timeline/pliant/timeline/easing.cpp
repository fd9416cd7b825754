#include "pliant/timeline/easing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/core/elementary.hpp"

namespace pliant::timeline {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double log_1024 = 10 * std::numbers::ln2;  // 2^(10 u) = exp(u log_1024)

double power(double base, int exponent) {
  double product = base;
  for (int i = 1; i < exponent; ++i) product *= base;
  return product;
}

int degree(Ease ease) {
  switch (ease) {
    case Ease::Quad:
      return 2;
    case Ease::Cubic:
      return 3;
    case Ease::Quart:
      return 4;
    default:
      return 5;
  }
}

// The four arcs of a ball that comes to rest (docs/timeline.md, eq. 20), in units of 1/2.75: each
// parabola covers [start, next start) with its foot at `foot`.
struct Arc {
  double start;
  double foot;
  double floor;
};
constexpr std::array<Arc, 4> arcs = {Arc{0, 0, 0}, Arc{1, 1.5, 0.75}, Arc{2, 2.25, 0.9375},
                                     Arc{2.5, 2.625, 0.984375}};

const Arc& arc_at(double passed) {
  int arc = 3;
  while (arc > 0 && passed * 2.75 < arcs[arc].start) --arc;
  return arcs[arc];
}

double bounce_out(double passed) {
  const Arc& arc = arc_at(passed);
  const double from_foot = passed * 2.75 - arc.foot;
  return from_foot * from_foot + arc.floor;  // 7.5625 = 2.75²
}

double bounce_out_slope(double passed) { return 2 * 2.75 * (passed * 2.75 - arc_at(passed).foot); }

}  // namespace

Easing::Easing(const Interpolation& interpolation, double length, double change)
    : ease_(interpolation.ease), side_(interpolation.side), length_(length) {
  const bool is_both = side_ == EaseSide::InOut;
  overshoot_ = interpolation.back.value_or(1.70158) * (is_both ? 1.525 : 1.0);
  if (ease_ != Ease::Elastic) return;
  double period = interpolation.period.value_or(0);
  // Only the ratio of the length and the period matters; tiny numbers are scaled up, which is
  // exact, so that a third of a tiny number does not underflow to 0.
  if (length < 0x1p-900) {
    length *= 0x1p+600;
    period *= 0x1p+600;
  }
  length_ = length;
  period_ = period != 0 ? period : (is_both ? 0.45 : 0.3) * length;
  // Without a change of value nothing swings, for any amplitude. Beyond 1e300 the swing of a tiny
  // change is clamped so that it does not overflow.
  const double relative =
      interpolation.amplitude && change != 0
          ? std::clamp(*interpolation.amplitude / std::fabs(change), -1e300, 1e300)
          : 1.0;
  if (relative >= 1) {
    amplitude_ = relative;
    shift_ = asin_of(1 / relative) / (2 * pi);
  } else {
    shift_ = 0.25;
    full_within_ = std::fabs(period_ / 4);
    damped_amplitude_ = relative;
  }
}

bool Easing::is_sound(const Interpolation& interpolation, double length) {
  if (interpolation.kind != Interpolation::Kind::Easing || interpolation.ease != Ease::Elastic) {
    return true;
  }
  const double period = interpolation.period.value_or(0);
  return period == 0 || length <= 1e15 * std::fabs(period);
}

Easing::Share Easing::share(Progress at) const {
  // Out(u) = 1 - In(1-u) and both halves of InOut, eq. 14. The part still to do is returned as
  // such: the end of the segment is then as exact as its start.
  switch (side_) {
    case EaseSide::In:
      return {ease_in(at), true};
    case EaseSide::Out:
      return {ease_in({at.left, at.passed}), false};
    default:
      break;
  }
  if (at.passed <= at.left) return {ease_in({2 * at.passed, at.left - at.passed}) / 2, true};
  return {ease_in({2 * at.left, at.passed - at.left}) / 2, false};
}

double Easing::slope(Progress at, double scale) const {
  switch (side_) {
    case EaseSide::In:
      return ease_in_slope(at, scale);
    case EaseSide::Out:
      return ease_in_slope({at.left, at.passed}, scale);
    default:
      break;
  }
  if (at.passed <= at.left) return ease_in_slope({2 * at.passed, at.left - at.passed}, scale);
  return ease_in_slope({2 * at.left, at.passed - at.left}, scale);
}

bool Easing::is_upright(Progress at) const { return ease_ == Ease::Circ && std::isinf(slope(at)); }

double Easing::ease_in(Progress at) const {
  const double u = at.passed;
  if (u <= 0) return 0;
  if (at.left <= 0) return 1;
  switch (ease_) {
    case Ease::Sine: {
      const double half = sin_of(u * (pi / 4));  // 1 - cos x = 2 sin²(x/2), without cancellation
      return 2 * half * half;
    }
    case Ease::Quad:
    case Ease::Cubic:
    case Ease::Quart:
    case Ease::Quint:
      return power(u, degree(ease_));
    case Ease::Expo:
      return (exp_of(u * log_1024) - 1) / 1023;
    case Ease::Circ:
      return u * u / (1 + std::sqrt(at.left * (1 + u)));  // 1 - √(1-u²) likewise
    case Ease::Back:
      return u * u * ((overshoot_ + 1) * u - overshoot_);
    case Ease::Bounce:
      return 1 - bounce_out(at.left);
    case Ease::Elastic:
      return elastic(at);
  }
  return u;
}

double Easing::ease_in_slope(Progress at, double scale) const {
  const double u = at.passed;
  switch (ease_) {
    case Ease::Sine:
      return scale * (pi / 2 * sin_of(u * (pi / 2)));
    case Ease::Quad:
    case Ease::Cubic:
    case Ease::Quart:
    case Ease::Quint:
      return scale * (degree(ease_) * power(u, degree(ease_) - 1));
    case Ease::Expo:
      return scale * (log_1024 * exp_of(u * log_1024) / 1023);
    case Ease::Circ:
      return scale * (u / std::sqrt(at.left * (1 + u)));
    case Ease::Back:
      return scale * (u * (3 * (overshoot_ + 1) * u - 2 * overshoot_));
    case Ease::Bounce:
      return scale * (bounce_out_slope(at.left));
    case Ease::Elastic:
      return elastic_slope(at, scale);
  }
  return scale;
}

// Elastic, eq. 22: In = -f A' 2^(10(u-1)) sin(2π (w/p - s/p)) with w = (u-1) L; here -w/p is the
// number of remaining periods, and shift_ = s/p.

double Easing::elastic(Progress at) const {
  const double frames_left = at.left * length_;
  const double turns = -frames_left / period_ - shift_;
  const double wave = sin_of(2 * pi * (turns - std::nearbyint(turns)));
  const double fade = exp_of(-at.left * log_1024);
  double factor = 1;
  if (full_within_ > 0) {
    factor = 1 - (1 - damped_amplitude_) * std::min(1.0, frames_left / full_within_);
  }
  return -factor * amplitude_ * fade * wave;
}

double Easing::elastic_slope(Progress at, double scale) const {
  const double frames_left = at.left * length_;
  const double turns = -frames_left / period_ - shift_;
  const double angle = 2 * pi * (turns - std::nearbyint(turns));
  const double fade = exp_of(-at.left * log_1024);
  double factor = 1;
  double factor_slope = 0;
  if (full_within_ > 0) {
    factor = 1 - (1 - damped_amplitude_) * std::min(1.0, frames_left / full_within_);
    if (frames_left < full_within_) {
      factor_slope = (1 - damped_amplitude_) * (length_ / full_within_);
    }
  }
  const double wave = sin_of(angle);
  const double wave_slope = 2 * pi * (length_ / period_) * cos_of(angle);
  return -(scale * amplitude_) * fade *
         (factor * (log_1024 * wave + wave_slope) + factor_slope * wave);
}

Easing::Places Easing::extrema(double from, double to) const {
  Places places;
  Places found;
  switch (side_) {
    case EaseSide::In:
      add_extrema_of_ease_in(from, to, places);
      break;
    case EaseSide::Out:
      add_extrema_of_ease_in(1 - to, 1 - from, found);
      for (int i = 0; i < found.count; ++i) places.add(1 - found.passed[i]);
      break;
    case EaseSide::InOut:
      if (from < 0.5) {
        add_extrema_of_ease_in(2 * from, std::min(1.0, 2 * to), found);
        for (int i = 0; i < found.count; ++i) places.add(found.passed[i] / 2);
      }
      if (to > 0.5) {
        found = {};
        add_extrema_of_ease_in(2 - 2 * to, std::min(1.0, 2 - 2 * from), found);
        for (int i = 0; i < found.count; ++i) places.add(1 - found.passed[i] / 2);
      }
      break;
  }
  return places;
}

void Easing::add_extrema_of_ease_in(double from, double to, Places& places) const {
  if (ease_ == Ease::Back) {
    const double turning = 2 * overshoot_ / (3 * (overshoot_ + 1));
    if (turning > 0 && turning < 1) places.add(turning);
  } else if (ease_ == Ease::Bounce) {
    for (const Arc& arc : arcs) {
      if (arc.start > 0) places.add(1 - arc.start / 2.75);
    }
    // The earliest foot bounds the others; but a part of the segment may contain only one foot, so
    // all three are added.
    for (const Arc& arc : arcs) {
      if (arc.foot > 0) places.add(1 - arc.foot / 2.75);
    }
  } else if (ease_ == Ease::Elastic) {
    places.add(0x1p-50);  // In(0) = 0 by definition, but In jumps there by up to A'/1024
    add_extrema_of_elastic(from, to, places);
  }
}

void Easing::add_extrema_of_elastic(double from, double to, Places& places) const {
  // If f is constant, In' = 0 means tan(θ) = -(2π/p) L / log_1024 (eq. 23). Extrema are half a
  // period apart and grow towards the end by a constant ratio, so the last two before `to`, and
  // before the ramp of f, bound all before them.
  const double turns_per_unit = length_ / period_;
  const double steepness = 2 * pi * turns_per_unit / log_1024;
  const double lead = -asin_of(steepness / std::sqrt(1 + steepness * steepness)) / (2 * pi);
  const auto add_last_before = [&](double place) {
    // θ/2π = (u-1) L/p - shift = lead + k/2, solved for the last k whose u is below `place`.
    const double halves = 2 * ((place - 1) * turns_per_unit - shift_ - lead);
    const double k = turns_per_unit > 0 ? std::floor(halves) : std::ceil(halves);
    const double back = turns_per_unit > 0 ? -1 : 1;
    for (int i = 0; i < 2; ++i) {
      const double u = 1 + (lead + (k + back * i) / 2 + shift_) / turns_per_unit;
      if (u > from && u < to) places.add(u);
    }
  };
  if (full_within_ <= 0) {
    add_last_before(to);
    return;
  }
  const double ramp = std::max(0.0, 1 - full_within_ / length_);
  add_last_before(std::min(to, ramp));
  if (ramp > from && ramp < to) places.add(ramp);
  // On the ramp f falls from 1 to A within a quarter of a period, where the wave keeps its sign:
  // the slope has at most two zeros there. They are found between sign changes of a fine scan.
  constexpr int parts = 64;
  double left = std::max(from, ramp);
  const double step = (std::min(to, 1.0) - left) / parts;
  for (int part = 0; part < parts && step > 0; ++part, left += step) {
    double low = left;
    double high = left + step;
    const bool rises = elastic_slope({low, 1 - low}) > 0;
    if (rises == (elastic_slope({high, 1 - high}) > 0)) continue;
    for (int round = 0; round < 60; ++round) {
      const double middle = low + (high - low) / 2;
      ((elastic_slope({middle, 1 - middle}) > 0) == rises ? low : high) = middle;
    }
    places.add(low);
  }
}

}  // namespace pliant::timeline
