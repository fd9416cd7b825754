#include "pliant/exchange/segment_cubics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pliant/core/elementary.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/timeline/edit/edit.hpp"

namespace pliant::exchange {
namespace {

std::size_t most_cubics(double length) {
  constexpr double per_frame = 16;
  constexpr double for_short_ones = 1024;
  return static_cast<std::size_t>(
      std::clamp(per_frame * length, for_short_ones, static_cast<double>(most_fitted)));
}

// In: time = sin a, value = 1 - cos a; Out is the same turned by half a turn.
std::vector<Segment> quarter(const Segment& segment, double start, double end, double from,
                             double to, int count, bool is_in) {
  const double step = std::numbers::pi / 2 / count;
  const double reach = 4.0 / 3 * std::tan(step / 4);
  const double length = end - start;
  const double rise = to - from;
  std::vector<Segment> parts;
  for (int k = 0; k < count; ++k) {
    const int n = is_in ? k : count - k - 1;  // counted from the level end
    const auto at = [&](int place) {
      const double angle = place * step;
      return std::pair(place == count ? 1.0 : sin_of(angle), place == count ? 0.0 : cos_of(angle));
    };
    const auto [near_sine, near_cosine] = at(n);
    const auto [far_sine, far_cosine] = at(n + 1);
    const Arm near{reach * near_cosine * length, reach * near_sine * rise};
    const Arm far{reach * far_cosine * length, -reach * far_sine * rise};
    Segment part{.kind = Segment::Kind::Bezier, .key = segment.key};
    if (is_in) {
      part.start = k == 0 ? start : start + near_sine * length;
      part.end = k + 1 == count ? end : start + far_sine * length;
      part.from = from + (1 - near_cosine) * rise;
      part.to = k + 1 == count ? to : from + (1 - far_cosine) * rise;
      part.out = near;
      part.in = far;
    } else {
      part.start = k == 0 ? start : end - far_sine * length;
      part.end = k + 1 == count ? end : end - near_sine * length;
      part.from = k == 0 ? from : to - (1 - far_cosine) * rise;
      part.to = to - (1 - near_cosine) * rise;
      part.out = {far.frames, -far.value};
      part.in = {near.frames, -near.value};
    }
    parts.push_back(part);
  }
  return parts;
}

std::vector<Segment> arcs(const Segment& segment, int count) {
  if (segment.easing.side == EaseSide::InOut) {
    const double middle = segment.start + segment.length() / 2;
    const double half = segment.from + (segment.to - segment.from) / 2;
    std::vector<Segment> parts =
        quarter(segment, segment.start, middle, segment.from, half, count, true);
    for (Segment& part : quarter(segment, middle, segment.end, half, segment.to, count, false))
      parts.push_back(part);
    return parts;
  }
  return quarter(segment, segment.start, segment.end, segment.from, segment.to, count,
                 segment.easing.side == EaseSide::In);
}

}  // namespace

std::optional<std::vector<Segment>> exact_cubics(const Segment& segment) {
  const Curve<1> curve = curve_of(segment);
  const Segment whole = cubic_segment(segment.start, segment.end, segment.from, segment.to,
                                      slope_at_start(segment), slope_at_end(segment));
  const bool is_cubic = segment.easing.side != EaseSide::InOut &&
                        (segment.easing.ease == Ease::Quad || segment.easing.ease == Ease::Cubic ||
                         segment.easing.ease == Ease::Back);
  if (is_cubic) {
    std::vector<Segment> one = {whole};
    one[0].key = segment.key;
    return one;
  }
  const auto inserted = insert_key(curve, segment.start + segment.length() / 2);
  if (!inserted) return {};
  std::vector<Segment> parts = segments_of(*inserted).segments;
  for (Segment& part : parts) part.key = segment.key;
  return parts;
}

Cubics arcs_of(const Segment& segment, double tolerance) {
  Cubics best;
  for (int count = 2; count <= 64; count *= 2) {
    best.segments = arcs(segment, count);
    best.deviation = deviation_of(best.segments, segment);
    if (best.deviation <= 0.8 * tolerance) break;
  }
  return best;
}

std::optional<Cubics> fitted_cubics(const Segment& segment, double tolerance,
                                    const StopRequest& should_stop) {
  const Curve<1> curve = curve_of(segment);
  // An elastic jumps at its quiet end, by up to a thousandth of its change.
  const auto limit = [&](double end, double step, double value) {
    const double beside = curve.value(end + step)[0];
    const bool jumps = segment.kind == Segment::Kind::Easing &&
                       segment.easing.ease == Ease::Elastic &&
                       std::fabs(beside - value) > 0.1 * tolerance;
    return Value<1>{jumps ? beside : value};
  };
  const Value<1> from = limit(segment.start, 1e-8 * segment.length(), segment.from);
  const Value<1> to = limit(segment.end, -1e-8 * segment.length(), segment.to);
  const SmoothFunction<1> function{[&](double frame) {
                                     if (frame == segment.start) return from;
                                     return frame == segment.end ? to : curve.value(frame);
                                   },
                                   [&](double frame) { return curve.velocity(frame); },
                                   [&](double frame) { return curve.left_velocity(frame); }};
  const double shortest = std::min(1.0 / 1024, segment.length() / 1024);
  const Fit<1> fit =
      Fitter<1>(function, tolerance, shortest, most_cubics(segment.length()), should_stop)
          .fit(segment.start, segment.end);
  if (fit.is_stopped) return {};
  Cubics result{.deviation = fit.deviation, .are_close = fit.is_close};
  for (const FittedCubic<1>& cubic : fit.cubics) {
    result.segments.push_back(cubic_segment(cubic.start, cubic.end, cubic.from[0], cubic.to[0],
                                            cubic.from_slope[0], cubic.to_slope[0]));
    result.segments.back().key = segment.key;
  }
  return result;
}

double deviation_of(const std::vector<Segment>& parts, const Segment& segment) {
  const Curve<1> exact = curve_of(segment);
  double largest = 0;
  for (const Segment& part : parts) {
    const Curve<1> curve = curve_of(part);
    constexpr int steps = 48;
    for (int k = 1; k < steps; ++k) {
      const double frame = part.start + part.length() * k / steps;
      largest = std::max(largest, std::fabs(curve.value(frame)[0] - exact.value(frame)[0]));
    }
  }
  return largest;
}

}  // namespace pliant::exchange
