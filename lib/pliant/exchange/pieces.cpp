#include "pliant/exchange/pieces.hpp"

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

using Segments = Interpolation::Kind;

Arm arm_of(const timeline::Handle<1>& handle) { return {handle.frames, handle.value[0]}; }

Piece piece_of(const CurveKeys<1>& keys, const timeline::Track<1>& track, std::size_t k) {
  const timeline::Segment<1>& segment = track.segments[k];
  const Interpolation& next = keys.keys[k].next;
  Piece piece{.start = track.frames[k],
              .end = track.frames[k + 1],
              .from = track.values[k][0],
              .to = track.arrivals[k + 1][0],
              .key = k};
  switch (next.kind) {
    case Segments::Step:
      piece.kind = Piece::Kind::Constant;
      piece.to = piece.from;
      break;
    case Segments::StepNext:
      piece.kind = Piece::Kind::Constant;
      piece.from = piece.to;
      break;
    case Segments::Linear:
      piece.kind = Piece::Kind::Line;
      break;
    case Segments::Easing:
      piece.kind = Piece::Kind::Easing;
      piece.easing = next;
      break;
    case Segments::Bezier:
    case Segments::CubicBezier: {
      piece.kind = Piece::Kind::Bezier;
      const timeline::Handles<1> handles = timeline::handles_of(track, k);
      piece.out = arm_of(handles.start);
      piece.in = arm_of(handles.end);
      piece.is_cubic_in_time = segment.kind == timeline::Segment<1>::Kind::Cubic;
      break;
    }
  }
  return piece;
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

Tangent<1> tangent_of(const Arm& arm, bool is_out, const Piece& piece) {
  if (piece.is_cubic_in_time) {
    const double slope = 3 * arm.value / piece.length();
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

/// The piece run backwards about a frame.
Piece mirrored(const Piece& piece, double pivot) {
  Piece result = piece;
  result.start = 2 * pivot - piece.end;
  result.end = 2 * pivot - piece.start;
  std::swap(result.from, result.to);
  std::swap(result.out, result.in);
  result.easing.side = opposite(piece.easing.side);
  return result;
}

Piece moved(const Piece& piece, double frames, double rise) {
  Piece result = piece;
  result.start += frames;
  result.end += frames;
  result.from += rise;
  result.to += rise;
  return result;
}

/// One copy of all pieces, `copy` >= 1 counted away from them.
struct CopyRow {
  std::vector<double> frames;
  std::vector<double> values;
  std::vector<Piece> pieces;
};

CopyRow copy_of(const Pieces& own, const Beyond& side, bool is_before, double copy) {
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
      if (k > 0) row.pieces.push_back(mirrored(own.pieces[k - 1], pivot));
    }
    return row;
  }
  for (std::size_t k = 0; k < own.frames.size(); ++k) {
    row.frames.push_back(own.frames[k] + frames);
    row.values.push_back(own.values[k] + rise);
    if (k > 0) row.pieces.push_back(moved(own.pieces[k - 1], frames, rise));
  }
  return row;
}

}  // namespace

Pieces pieces_of(const Curve<1>& curve) {
  auto keys = timeline::without_loop(curve.keys());
  PLIANT_EXPECTS(keys.has_value());  // it compiled before
  const auto compiled = timeline::compile(*keys);
  PLIANT_EXPECTS(compiled.has_value());
  const timeline::Track<1>& track = compiled->curve.track;
  Pieces pieces;
  pieces.frames = track.frames;
  for (const Value<1>& value : track.values) pieces.values.push_back(value[0]);
  for (std::size_t k = 0; k < track.segments.size(); ++k)
    pieces.pieces.push_back(piece_of(*keys, track, k));
  pieces.before = beyond_of(compiled->curve.before, keys->before);
  pieces.after = beyond_of(compiled->curve.after, keys->after);
  return pieces;
}

CurveKeys<1> keys_of(const Pieces& pieces) {
  CurveKeys<1> keys;
  for (std::size_t k = 0; k < pieces.frames.size(); ++k)
    keys.keys.push_back({.frame = pieces.frames[k], .value = {pieces.values[k]}});
  for (std::size_t k = 0; k < pieces.pieces.size(); ++k) {
    const Piece& piece = pieces.pieces[k];
    Key<1>& key = keys.keys[k];
    switch (piece.kind) {
      case Piece::Kind::Constant:
        key.next.kind = piece.from == key.value[0] ? Segments::Step : Segments::StepNext;
        break;
      case Piece::Kind::Line:
        key.next.kind = Segments::Linear;
        break;
      case Piece::Kind::Bezier:
        key.out = tangent_of(piece.out, true, piece);
        keys.keys[k + 1].in = tangent_of(piece.in, false, piece);
        break;
      case Piece::Kind::Easing:
        key.next = piece.easing;
        break;
    }
    const bool is_step = key.next.kind == Segments::Step;
    if (!is_step && piece.to != pieces.values[k + 1]) keys.keys[k + 1].left = {{piece.to}};
  }
  return keys;
}

Curve<1> curve_of(const Piece& piece) {
  auto curve = Curve<1>::make(
      keys_of({{piece.start, piece.end}, {piece.from, piece.to}, {piece}, Beyond{}, Beyond{}}));
  PLIANT_EXPECTS(curve.has_value());  // a part of a curve is one
  return *std::move(curve);
}

Piece cubic_piece(double start, double end, double from, double to, double from_slope,
                  double to_slope) {
  const double third = (end - start) / 3;
  return {.kind = Piece::Kind::Bezier,
          .start = start,
          .end = end,
          .from = from,
          .to = to,
          .out = {third, from_slope * third},
          .in = {third, -to_slope * third},
          .is_cubic_in_time = true};
}

double slope_at_start(const Piece& piece) {
  if (piece.kind == Piece::Kind::Constant) return 0;
  if (piece.kind == Piece::Kind::Line) return (piece.to - piece.from) / piece.length();
  if (piece.is_cubic_in_time) return 3 * piece.out.value / piece.length();
  return curve_of(piece).velocity(piece.start)[0];
}

double slope_at_end(const Piece& piece) {
  if (piece.kind == Piece::Kind::Constant) return 0;
  if (piece.kind == Piece::Kind::Line) return (piece.to - piece.from) / piece.length();
  if (piece.is_cubic_in_time) return -3 * piece.in.value / piece.length();
  return curve_of(piece).left_velocity(piece.end)[0];
}

Cut cut(const Piece& piece, double frame) {
  PLIANT_EXPECTS(piece.kind != Piece::Kind::Easing);
  PLIANT_EXPECTS(piece.start < frame && frame < piece.end);
  Cut parts{piece, piece};
  parts.left.end = parts.right.start = frame;
  if (piece.kind == Piece::Kind::Constant) return parts;
  const Curve<1> whole = curve_of(piece);
  parts.left.to = parts.right.from = whole.value(frame)[0];
  if (piece.kind == Piece::Kind::Line) return parts;
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
Cut cut_where_slowest(const Piece& piece) {
  const double length = piece.length();
  const double a = piece.out.frames, b = piece.in.frames;
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
  const auto time = split(piece.start, a, b, length);
  const auto value = split(piece.from, piece.out.value, -piece.in.value, piece.to - piece.from);
  Cut parts{piece, piece};
  parts.left.end = parts.right.start = time.at;
  parts.left.to = parts.right.from = value.at;
  parts.left.is_cubic_in_time = parts.right.is_cubic_in_time = false;
  // Rounding must not leave an arm longer than its part.
  const auto arm = [](double frames, double rise, const Piece& part) {
    return Arm{std::clamp(frames, 0.0, part.length()), rise};
  };
  parts.left.out = arm(time.out, value.out, parts.left);
  parts.left.in = arm(time.left_in, -value.left_in, parts.left);
  parts.right.out = arm(time.right_out, value.right_out, parts.right);
  parts.right.in = arm(time.in, -value.in, parts.right);
  return parts;
}

Result<Pieces> with_copies(const Pieces& own, std::optional<double> first,
                           std::optional<double> last) {
  const double span = own.frames.back() - own.frames.front();
  const auto copies = [&](const Beyond& side, double reach) {
    return std::min(side.count, std::max(1.0, std::ceil(reach / span)));
  };
  const double before = first ? copies(own.before, own.frames.front() - *first) : 0;
  const double after = last ? copies(own.after, *last - own.frames.back()) : 0;
  const double count = (before + after) * static_cast<double>(own.pieces.size());
  if (!(count <= static_cast<double>(most_pieces))) {
    return invalid(
        fmt::format("the copies beside the keys would become {} keys; at most {} are allowed",
                    count, most_pieces));
  }
  // A joint has the value of the copy that is nearer to the keys.
  Pieces result;
  const auto add = [&](const CopyRow& row, bool has_first, bool has_last) {
    for (std::size_t k = has_first ? 0 : 1; k + (has_last ? 0 : 1) < row.frames.size(); ++k) {
      result.frames.push_back(row.frames[k]);
      result.values.push_back(row.values[k]);
    }
    result.pieces.insert(result.pieces.end(), row.pieces.begin(), row.pieces.end());
  };
  for (double copy = before; copy >= 1; --copy)
    add(copy_of(own, own.before, true, copy), true, false);
  add({own.frames, own.values, own.pieces}, true, true);
  for (double copy = 1; copy <= after; ++copy)
    add(copy_of(own, own.after, false, copy), false, true);
  // Rounding must not leave gaps between pieces and keys.
  for (std::size_t k = 0; k < result.pieces.size(); ++k) {
    result.pieces[k].start = result.frames[k];
    result.pieces[k].end = result.frames[k + 1];
    if (!(result.frames[k] < result.frames[k + 1]))
      return invalid("rounding puts two keys of the copies beside the keys on one frame");
  }
  result.before = first ? Beyond{.anchor = result.values.front()} : own.before;
  result.after = last ? Beyond{.anchor = result.values.back()} : own.after;
  return result;
}

}  // namespace pliant::exchange
