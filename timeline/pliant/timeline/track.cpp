#include "pliant/timeline/track.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/timeline/track_evaluation.hpp"

namespace pliant::timeline {

namespace {

template <int D>
Progress progress(const Segment<D>& segment, double frame) {
  const LinearPlace place = LinearPlace::of(segment, frame);
  if (place.end == 0) return {place.q, 1 - place.q};
  return {1 - place.q, place.q};
}

/// Where the slope of a cubic vanishes: c1 + 2 c2 q + 3 c3 q² = 0, without cancellation; -1 for a
/// root that does not exist.
std::array<double, 2> roots_of_slope(const Cubic& cubic) {
  const double size = std::max({std::fabs(cubic.c1), std::fabs(cubic.c2), std::fabs(cubic.c3)});
  if (size == 0) return {-1, -1};
  const double a = 3 * (cubic.c3 / size);
  const double b = cubic.c2 / size;
  const double c = cubic.c1 / size;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return {-1, -1};
  const double sum = -(b + std::copysign(std::sqrt(discriminant), b));
  return {a != 0 ? sum / a : -1, sum != 0 ? c / sum : -1};
}

}  // namespace

template <int D>
Value<D> Track<D>::careful_value_in(const Segment<D>& segment, double frame) const {
  Value<D> value;
  if (segment.kind == Segment<D>::Kind::Bezier) {
    const TimeCubic::Place place = times[segment.extra].place_of(frame);
    const auto& cubics = segment.ends[place.end];
    for (int c = 0; c < D; ++c) {
      value[c] = cubics[c].value(place.q) + cubics[c].slope(place.q) * place.correction;
    }
    return value;
  }
  const Progress at = progress(segment, frame);
  const Easings<D>& eased = easings[segment.extra];
  Easing::Share share = eased[0].share(at);
  for (int c = 0; c < D; ++c) {
    if (c > 0 && eased[c].is_elastic()) share = eased[c].share(at);
    const Cubic& line = segment.ends[share.is_from_start ? 0 : 1][c];
    value[c] = line.c0 + line.c1 * share.amount;
  }
  return value;
}

template <int D>
Value<D> Track<D>::velocity_in(const Segment<D>& segment, double frame) const {
  Value<D> velocity;
  if (segment.kind == Segment<D>::Kind::Bezier) {
    const TimeCubic& time = times[segment.extra];
    const TimeCubic::Place place = time.place_of(frame);
    const double q = place.q + place.correction;
    const Cubic run = time.from_end(place.end);
    for (int c = 0; c < D; ++c) {
      const double slope = slope_of_curve(run, segment.ends[place.end][c], q);
      velocity[c] = place.end == 0 ? slope : -slope;
    }
    return velocity;
  }
  if (segment.kind == Segment<D>::Kind::Easing) {
    const Progress at = progress(segment, frame);
    const Easings<D>& eased = easings[segment.extra];
    double slope = eased[0].slope(at);
    for (int c = 0; c < D; ++c) {
      if (c > 0 && eased[c].is_elastic()) slope = eased[c].slope(at);
      const double change = segment.ends[0][c].c1;
      velocity[c] = change != 0 ? change * slope / segment.length : 0;
      if (std::isfinite(velocity[c]) || eased[c].is_upright(at)) continue;
      // The share's slope may overflow if the change is tiny.
      velocity[c] = within_numbers(eased[c].slope(at, change) / segment.length);
    }
    return velocity;
  }
  const LinearPlace place = LinearPlace::of(segment, frame);
  const double unit = place.end == 0 ? segment.length : -segment.length;
  for (int c = 0; c < D; ++c) {
    velocity[c] = within_numbers(segment.ends[place.end][c].slope(place.q) / unit);
  }
  return velocity;
}

template <int D>
Value<D> Track<D>::value(double frame, Limit limit, std::size_t segment) const {
  if (frame == last()) return limit == Limit::Left ? arrivals.back() : values.back();
  const Segment<D>& here = segments[segment];
  if (frame == here.start) {
    if (limit == Limit::Left) return arrivals[segment];
    const bool jumps = here.kind == Segment<D>::Kind::Jump && limit == Limit::Right;
    return jumps ? arrivals[segment + 1] : values[segment];
  }
  return value_in(here, frame);
}

template <int D>
Value<D> Track<D>::velocity(double frame, Limit limit, std::size_t segment) const {
  if (limit == Limit::Left && segment > 0 && frame == segments[segment].start) --segment;
  return velocity_in(segments[segment], frame);
}

template <int D>
void Track<D>::add_extrema(const Segment<D>& segment, double from, double to,
                           Bounds<D>& bounds) const {
  if (segment.kind == Segment<D>::Kind::Easing) {
    const double low = progress(segment, from).passed;
    const double high = progress(segment, to).passed;
    for (int c = 0; c < D; ++c) {
      const Easing& easing = easings[segment.extra][c];
      const Easing::Places places = easing.extrema(low, high);
      for (int i = 0; i < places.count; ++i) {
        const double passed = places.passed[i];
        if (!(passed > low && passed < high)) continue;
        const Easing::Share share = easing.share({passed, 1 - passed});
        const Cubic& line = segment.ends[share.is_from_start ? 0 : 1][c];
        const double value = line.c0 + line.c1 * share.amount;
        bounds.low[c] = std::min(bounds.low[c], value);
        bounds.high[c] = std::max(bounds.high[c], value);
      }
    }
    return;
  }
  const bool is_bezier = segment.kind == Segment<D>::Kind::Bezier;
  for (int end = 0; end < 2; ++end) {
    const Cubic run =
        is_bezier ? times[segment.extra].from_end(end) : Cubic{0, segment.length, 0, 0};
    for (int c = 0; c < D; ++c) {
      const Cubic& cubic = segment.ends[end][c];
      for (const double q : roots_of_slope(cubic)) {
        if (!(q > 0 && q <= 0.5 + 0x1p-10)) continue;
        const double frame = end == 0 ? segment.start + run.value(q) : segment.end - run.value(q);
        if (!(frame >= from && frame <= to)) continue;
        bounds.low[c] = std::min(bounds.low[c], cubic.value(q));
        bounds.high[c] = std::max(bounds.high[c], cubic.value(q));
      }
    }
  }
}

template <int D>
void Track<D>::add_bounds(const Interval& interval, Bounds<D>& bounds) const {
  const auto& [from, to, holds_from, holds_to] = interval;
  if (segments.empty()) return bounds.add(values.front());
  std::size_t segment = segment_at(from);
  if (holds_from) bounds.add(value(from, Limit::At, segment));
  for (; segment < segments.size() && segments[segment].start < to; ++segment) {
    const Segment<D>& here = segments[segment];
    const double low = std::max(from, here.start);
    const double high = std::min(to, here.end);
    if (low >= high) continue;
    bounds.add(value(low, Limit::Right, segment));
    add_extrema(here, low, high, bounds);
    bounds.add(high == here.end ? arrivals[segment + 1] : value_in(here, high));
    if (high == here.end && (high < to || holds_to)) bounds.add(values[segment + 1]);
  }
}

template struct Track<1>;
template struct Track<3>;

}  // namespace pliant::timeline
