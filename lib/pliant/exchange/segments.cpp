#include "pliant/exchange/segments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/edit/split.hpp"

namespace pliant::exchange {
namespace {

using InterpolationKind = Interpolation::Kind;

Arm arm_of(const timeline::Handle<1>& handle) { return {handle.frames, handle.value[0]}; }

Segment segment_of(const CurveKeys<1>& keys, const timeline::Track<1>& track, std::size_t k) {
  const timeline::Segment<1>& of = track.segments[k];
  const Interpolation& next = keys.keys[k].next;
  Segment segment{.start = track.frames[k],
                  .end = track.frames[k + 1],
                  .from = track.values[k][0],
                  .to = track.arrivals[k + 1][0],
                  .key = k};
  switch (next.kind) {
    case InterpolationKind::Step:
      segment.kind = Segment::Kind::Constant;
      segment.to = segment.from;
      break;
    case InterpolationKind::StepNext:
      segment.kind = Segment::Kind::Constant;
      segment.from = segment.to;
      break;
    case InterpolationKind::Linear:
      segment.kind = Segment::Kind::Line;
      break;
    case InterpolationKind::Easing:
      segment.kind = Segment::Kind::Easing;
      segment.easing = next;
      break;
    case InterpolationKind::Bezier:
    case InterpolationKind::CubicBezier: {
      segment.kind = Segment::Kind::Bezier;
      const timeline::Handles<1> handles = timeline::handles_of(track, k);
      segment.out = arm_of(handles.start);
      segment.in = arm_of(handles.end);
      segment.is_cubic_in_time = of.kind == timeline::Segment<1>::Kind::Cubic;
      break;
    }
  }
  return segment;
}

Beyond beyond_of(const timeline::Outside<1>& outside, const Extrapolation<1>& author) {
  using Mode = timeline::Outside<1>::Mode;
  Beyond beyond{.slope = outside.slope[0],
                .anchor = outside.anchor[0],
                .offset = outside.offset[0],
                .count = outside.count};
  if (outside.mode == Mode::Mirror) beyond.kind = Beyond::Kind::Mirror;
  if (outside.mode == Mode::Repeat) {
    beyond.kind = author.kind == Extrapolation<1>::Kind::RepeatOffset ? Beyond::Kind::RepeatOffset
                                                                      : Beyond::Kind::Repeat;
  }
  return beyond;
}

Tangent<1> tangent_of(const Arm& arm, bool is_out, const Segment& segment) {
  if (segment.is_cubic_in_time) {
    const double slope = 3 * arm.value / segment.length();
    return {.kind = Tangent<1>::Kind::Slope, .slope = {is_out ? slope : -slope}};
  }
  return {.kind = Tangent<1>::Kind::Handle,
          .handle_frames = is_out ? arm.frames : -arm.frames,
          .handle_value = {arm.value}};
}

EaseSide opposite(EaseSide side) {
  if (side == EaseSide::InOut) return side;
  return side == EaseSide::In ? EaseSide::Out : EaseSide::In;
}

/// The segment run backwards about a frame.
Segment mirrored(const Segment& segment, double pivot) {
  Segment result = segment;
  result.start = 2 * pivot - segment.end;
  result.end = 2 * pivot - segment.start;
  std::swap(result.from, result.to);
  std::swap(result.out, result.in);
  result.easing.side = opposite(segment.easing.side);
  return result;
}

Segment moved(const Segment& segment, double frames, double rise) {
  Segment result = segment;
  result.start += frames;
  result.end += frames;
  result.from += rise;
  result.to += rise;
  return result;
}

/// One copy of all segments, `copy` >= 1 counted away from them.
struct CopyRow {
  std::vector<double> frames;
  std::vector<double> values;
  std::vector<Segment> segments;
};

CopyRow copy_of(const Segments& own, const Beyond& side, bool is_before, double copy) {
  CopyRow row;
  const double span = own.frames.back() - own.frames.front();
  const double direction = is_before ? -1 : 1;
  const double frames = direction * copy * span;
  const double rise = direction * copy * side.offset;
  if (side.kind == Beyond::Kind::Mirror && std::fmod(copy, 2) == 1) {
    // Frames first … last become those of this copy, backwards.
    const double pivot = (own.frames.front() + own.frames.back() + frames) / 2;
    for (std::size_t k = own.frames.size(); k-- > 0;) {
      row.frames.push_back(2 * pivot - own.frames[k]);
      row.values.push_back(own.values[k]);
      if (k > 0) row.segments.push_back(mirrored(own.segments[k - 1], pivot));
    }
    return row;
  }
  for (std::size_t k = 0; k < own.frames.size(); ++k) {
    row.frames.push_back(own.frames[k] + frames);
    row.values.push_back(own.values[k] + rise);
    if (k > 0) row.segments.push_back(moved(own.segments[k - 1], frames, rise));
  }
  return row;
}

}  // namespace

Segments segments_of(const Curve<1>& curve) {
  auto keys = timeline::without_loop(curve.keys());
  PLIANT_EXPECTS(keys.has_value());  // it compiled before
  const auto compiled = timeline::compile(*keys);
  PLIANT_EXPECTS(compiled.has_value());
  const timeline::Track<1>& track = compiled->curve.track;
  Segments segments;
  segments.frames = track.frames;
  for (const Value<1>& value : track.values) segments.values.push_back(value[0]);
  for (std::size_t k = 0; k < track.segments.size(); ++k)
    segments.segments.push_back(segment_of(*keys, track, k));
  segments.before = beyond_of(compiled->curve.before, keys->before);
  segments.after = beyond_of(compiled->curve.after, keys->after);
  return segments;
}

CurveKeys<1> keys_of(const Segments& segments) {
  CurveKeys<1> keys;
  for (std::size_t k = 0; k < segments.frames.size(); ++k)
    keys.keys.push_back({.frame = segments.frames[k], .value = {segments.values[k]}});
  for (std::size_t k = 0; k < segments.segments.size(); ++k) {
    const Segment& segment = segments.segments[k];
    Key<1>& key = keys.keys[k];
    switch (segment.kind) {
      case Segment::Kind::Constant:
        key.next.kind =
            segment.from == key.value[0] ? InterpolationKind::Step : InterpolationKind::StepNext;
        break;
      case Segment::Kind::Line:
        key.next.kind = InterpolationKind::Linear;
        break;
      case Segment::Kind::Bezier:
        key.out = tangent_of(segment.out, true, segment);
        keys.keys[k + 1].in = tangent_of(segment.in, false, segment);
        break;
      case Segment::Kind::Easing:
        key.next = segment.easing;
        break;
    }
    const bool is_step = key.next.kind == InterpolationKind::Step;
    if (!is_step && segment.to != segments.values[k + 1]) keys.keys[k + 1].left = {{segment.to}};
  }
  return keys;
}

Curve<1> curve_of(const Segment& segment) {
  auto curve = Curve<1>::make(keys_of(
      {{segment.start, segment.end}, {segment.from, segment.to}, {segment}, Beyond{}, Beyond{}}));
  PLIANT_EXPECTS(curve.has_value());  // a part of a curve is one
  return *std::move(curve);
}

Segment cubic_segment(double start, double end, double from, double to, double from_slope,
                      double to_slope) {
  const double third = (end - start) / 3;
  return {.kind = Segment::Kind::Bezier,
          .start = start,
          .end = end,
          .from = from,
          .to = to,
          .out = {third, from_slope * third},
          .in = {third, -to_slope * third},
          .is_cubic_in_time = true};
}

double slope_at_start(const Segment& segment) {
  if (segment.kind == Segment::Kind::Constant) return 0;
  if (segment.kind == Segment::Kind::Line) return (segment.to - segment.from) / segment.length();
  if (segment.is_cubic_in_time) return 3 * segment.out.value / segment.length();
  return curve_of(segment).velocity(segment.start)[0];
}

double slope_at_end(const Segment& segment) {
  if (segment.kind == Segment::Kind::Constant) return 0;
  if (segment.kind == Segment::Kind::Line) return (segment.to - segment.from) / segment.length();
  if (segment.is_cubic_in_time) return -3 * segment.in.value / segment.length();
  return curve_of(segment).left_velocity(segment.end)[0];
}

Cut cut(const Segment& segment, double frame) {
  PLIANT_EXPECTS(segment.kind != Segment::Kind::Easing);
  PLIANT_EXPECTS(segment.start < frame && frame < segment.end);
  Cut parts{segment, segment};
  parts.left.end = parts.right.start = frame;
  if (segment.kind == Segment::Kind::Constant) return parts;
  const Curve<1> whole = curve_of(segment);
  parts.left.to = parts.right.from = whole.value(frame)[0];
  if (segment.kind == Segment::Kind::Line) return parts;
  const auto compiled = timeline::compile(whole.keys());
  PLIANT_EXPECTS(compiled.has_value());
  const timeline::Split<1> split = timeline::split(compiled->curve.track, 0, frame);
  parts.left.out = arm_of(split.left.start);
  parts.left.in = arm_of(split.left.end);
  parts.right.out = arm_of(split.right.start);
  parts.right.in = arm_of(split.right.end);
  return parts;
}

// Time over the parameter u has the derivative x' = 3·(a(1-u)² + 2(L-a-b)u(1-u) + bu²), least where
// x'' = 0. From there to either end it grows, as m + c·s², so that the third of its value at the
// end, the arm, is at most its mean, the length.
Cut cut_where_slowest(const Segment& segment) {
  const double length = segment.length();
  const double a = segment.out.frames, b = segment.in.frames;
  const double between = length - a - b;
  const double u = (a - between) / (a + b - 2 * between);
  PLIANT_EXPECTS(u > 0 && u < 1);
  const auto split = [u](double start, double out, double in, double change) {
    // De Casteljau, relative to the start: 0, out, change - in, change.
    const double first = u * out;
    const double middle = out + u * (change - in - out);
    const double last = change - in + u * in;
    const double second = first + u * (middle - first);
    const double third = middle + u * (last - middle);
    const double meeting = second + u * (third - second);
    struct {
      double at, out, left_in, right_out, in;
    } parts{start + meeting, first, meeting - second, third - meeting, change - last};
    return parts;
  };
  const auto time = split(segment.start, a, b, length);
  const auto value =
      split(segment.from, segment.out.value, -segment.in.value, segment.to - segment.from);
  Cut parts{segment, segment};
  parts.left.end = parts.right.start = time.at;
  parts.left.to = parts.right.from = value.at;
  parts.left.is_cubic_in_time = parts.right.is_cubic_in_time = false;
  // Rounding must not leave an arm longer than its part.
  const auto arm = [](double frames, double rise, const Segment& part) {
    return Arm{std::clamp(frames, 0.0, part.length()), rise};
  };
  parts.left.out = arm(time.out, value.out, parts.left);
  parts.left.in = arm(time.left_in, -value.left_in, parts.left);
  parts.right.out = arm(time.right_out, value.right_out, parts.right);
  parts.right.in = arm(time.in, -value.in, parts.right);
  return parts;
}

Result<Segments> with_copies(const Segments& own, std::optional<double> first,
                             std::optional<double> last) {
  const double span = own.frames.back() - own.frames.front();
  const auto copies = [&](const Beyond& side, double reach) {
    return std::min(side.count, std::max(1.0, std::ceil(reach / span)));
  };
  const double before = first ? copies(own.before, own.frames.front() - *first) : 0;
  const double after = last ? copies(own.after, *last - own.frames.back()) : 0;
  const double count = (before + after) * static_cast<double>(own.segments.size());
  if (!(count <= static_cast<double>(most_segments))) {
    return invalid(
        fmt::format("the copies beside the keys would become {} keys; at most {} are allowed",
                    count, most_segments));
  }
  // A joint has the value of the copy that is nearer to the keys.
  Segments result;
  const auto add = [&](const CopyRow& row, bool has_first, bool has_last) {
    for (std::size_t k = has_first ? 0 : 1; k + (has_last ? 0 : 1) < row.frames.size(); ++k) {
      result.frames.push_back(row.frames[k]);
      result.values.push_back(row.values[k]);
    }
    result.segments.insert(result.segments.end(), row.segments.begin(), row.segments.end());
  };
  for (double copy = before; copy >= 1; --copy)
    add(copy_of(own, own.before, true, copy), true, false);
  add({own.frames, own.values, own.segments}, true, true);
  for (double copy = 1; copy <= after; ++copy)
    add(copy_of(own, own.after, false, copy), false, true);
  // Rounding must not leave gaps between segments and keys.
  for (std::size_t k = 0; k < result.segments.size(); ++k) {
    result.segments[k].start = result.frames[k];
    result.segments[k].end = result.frames[k + 1];
    if (!(result.frames[k] < result.frames[k + 1]))
      return invalid("rounding puts two keys of the copies beside the keys on one frame");
  }
  result.before = first ? Beyond{.anchor = result.values.front()} : own.before;
  result.after = last ? Beyond{.anchor = result.values.back()} : own.after;
  return result;
}

}  // namespace pliant::exchange
