#include "pliant/exchange/hold.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/elementary.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/exchange/loss_log.hpp"
#include "pliant/timeline/edit/edit.hpp"

namespace pliant::exchange {
namespace {

constexpr double largest_held_frame = 1e7;
constexpr double largest_held_value = 1e30;
constexpr double shortest_held_piece = 1e-6;

std::string_view name_of(Ease ease) {
  constexpr std::string_view names[] = {"sine", "quad", "cubic", "quart",  "quint",
                                        "expo", "circ", "back",  "bounce", "elastic"};
  return names[static_cast<int>(ease)];
}

/// How many cubics a segment becomes at most. More keys a frame than these are of no use to anyone
/// who looks at it, such as those of an elastic with many periods in each frame.
std::size_t most_cubics(double length) {
  constexpr double per_frame = 16;
  constexpr double for_short_ones = 1024;
  return static_cast<std::size_t>(
      std::clamp(per_frame * length, for_short_ones, static_cast<double>(most_fitted)));
}

std::optional<Error> beyond_bounds(const Pieces& pieces) {
  const auto error = [](std::string message) {
    return Error{ErrorCode::InvalidInput, std::move(message)};
  };
  for (std::size_t k = 0; k < pieces.frames.size(); ++k) {
    if (!(std::fabs(pieces.frames[k]) <= largest_held_frame)) {
      return error(
          fmt::format("key {} is too far away: frames of other programs reach from {} to {}",
                      pieces.frames[k], -largest_held_frame, largest_held_frame));
    }
    if (!(std::fabs(pieces.values[k]) <= largest_held_value)) {
      return error(fmt::format("the value {} of key {} is too large: its size must not exceed {}",
                               pieces.values[k], pieces.frames[k], largest_held_value));
    }
  }
  for (const Piece& piece : pieces.pieces) {
    if (!(piece.length() >= shortest_held_piece)) {
      return error(fmt::format("key {} and key {} are too close: other programs need {} frames",
                               piece.start, piece.end, shortest_held_piece));
    }
    for (const double number : {piece.from, piece.to, piece.out.value, piece.in.value}) {
      if (std::fabs(number) <= largest_held_value) continue;
      return error(
          fmt::format("the segment of key {} has the value {}: its size must not exceed {}",
                      piece.start, number, largest_held_value));
    }
  }
  return {};
}

class Holder {
 public:
  Holder(Pieces pieces, const Abilities& abilities, double tolerance, WantedFrames wanted,
         const StopRequest& should_stop)
      : pieces_(std::move(pieces)),
        abilities_(abilities),
        tolerance_(tolerance),
        wanted_(wanted),
        should_stop_(should_stop) {}

  Result<Held> hold() {
    for (const Piece& piece : pieces_.pieces) author_frames_.push_back(piece.start);
    if (auto error = beyond_bounds(pieces_)) return fail(*std::move(error));
    if (auto held = hold_copies(); !held) return fail(held.error());
    hold_lines();
    if (auto held = hold_shapes(); !held) return fail(held.error());
    hold_jumps();
    if (auto held = hold_arms(); !held) return fail(held.error());
    if (auto error = beyond_bounds(pieces_)) return fail(*std::move(error));
    return Held{std::move(pieces_), losses_.take()};
  }

 private:
  static bool has_copies(const Beyond& side) { return side.kind != Beyond::Kind::Line; }

  /// Whether the format shows the same copies.
  bool holds_copies(const Beyond& side) const {
    const double rise = pieces_.values.back() - pieces_.values.front();
    if (side.kind == Beyond::Kind::RepeatOffset && side.offset != rise) return false;
    if (std::isinf(side.count)) return abilities_.has_copies;
    if (!abilities_.has_counted_copies) return false;
    return side.kind == Beyond::Kind::Repeat ||
           (side.kind == Beyond::Kind::Mirror && std::fmod(side.count, 2) == 0);
  }

  /// Whether a line before or after the keys needs a piece of its own. Copies on the other side
  /// would repeat it.
  bool needs_piece(bool is_before) const {
    const Beyond& side = is_before ? pieces_.before : pieces_.after;
    if (has_copies(side)) return false;
    const double value = is_before ? pieces_.values.front() : pieces_.values.back();
    if (side.anchor != value) return true;
    if (side.slope == 0) return false;
    if (!abilities_.has_lines || pieces_.pieces.empty()) return true;
    const Piece& beside = is_before ? pieces_.pieces.front() : pieces_.pieces.back();
    return abilities_.lines_need_motion && is_before && beside.kind == Piece::Kind::Constant;
  }

  Result<void> hold_copies() {
    bool writes_before = has_copies(pieces_.before) && !holds_copies(pieces_.before);
    bool writes_after = has_copies(pieces_.after) && !holds_copies(pieces_.after);
    if (needs_piece(true) || writes_before) writes_after = has_copies(pieces_.after);
    if (needs_piece(false) || writes_after) writes_before = has_copies(pieces_.before);
    if (!writes_before && !writes_after) return {};
    const Pieces own = pieces_;
    auto written = with_copies(own, writes_before ? std::optional(wanted_.first) : std::nullopt,
                               writes_after ? std::optional(wanted_.last) : std::nullopt);
    if (!written) return fail(written.error());
    pieces_ = *std::move(written);
    const auto tell = [&](bool is_before, const Beyond& side) {
      const double span = own.frames.back() - own.frames.front();
      const double reach = is_before ? own.frames.front() - pieces_.frames.front()
                                     : pieces_.frames.back() - own.frames.back();
      const auto copies = static_cast<std::size_t>(std::llround(reach / span));
      const bool are_all = static_cast<double>(copies) >= side.count;
      const std::size_t keys = copies * own.pieces.size();
      losses_.add_side(
          fmt::format(
              "the copies {} the keys became {} key{}{}", is_before ? "before" : "after", keys,
              keys == 1 ? "" : "s",
              are_all ? ""
                      : fmt::format(", {} frame {}", is_before ? "from" : "up to",
                                    is_before ? pieces_.frames.front() : pieces_.frames.back())),
          are_all);
    };
    if (writes_before) tell(true, own.before);
    if (writes_after) tell(false, own.after);
    return {};
  }

  void hold_lines() {
    for (const bool is_before : {true, false}) {
      if (!needs_piece(is_before)) continue;
      Beyond& side = is_before ? pieces_.before : pieces_.after;
      const double end = is_before ? pieces_.frames.front() : pieces_.frames.back();
      double length = 1;
      if (!abilities_.has_lines && side.slope != 0) {
        length = std::max(length, is_before ? end - wanted_.first : wanted_.last - end);
        losses_.add_side(
            fmt::format("the slope {} the keys became a key at frame {}",
                        is_before ? "before" : "after", is_before ? end - length : end + length),
            false);
      }
      Piece piece{.kind = side.slope == 0 ? Piece::Kind::Constant : Piece::Kind::Line};
      if (is_before) {
        piece.start = end - length;
        piece.end = end;
        piece.to = side.anchor;
        piece.from = side.anchor - side.slope * length;
        pieces_.frames.insert(pieces_.frames.begin(), piece.start);
        pieces_.values.insert(pieces_.values.begin(), piece.from);
        pieces_.pieces.insert(pieces_.pieces.begin(), piece);
        side.anchor = piece.from;
      } else {
        piece.start = end;
        piece.end = end + length;
        piece.key = author_frames_.size();
        piece.from = side.anchor;
        piece.to = side.anchor + side.slope * length;
        pieces_.frames.push_back(piece.end);
        pieces_.values.push_back(piece.to);
        pieces_.pieces.push_back(piece);
        side.anchor = piece.to;
      }
      if (!abilities_.has_lines) side.slope = 0;
    }
  }

  double gap_at(double frame, double length) const {
    // Programs keep frames in single precision.
    return std::min(std::max(abilities_.gap, std::fabs(frame) * 0x1p-20), length / 8);
  }

  bool jumps_left(std::size_t k) const {
    if (abilities_.has_left_values) return false;
    const Piece& before = pieces_.pieces[k - 1];
    if (before.to == pieces_.values[k]) return false;
    return !(abilities_.has_steps && before.kind == Piece::Kind::Constant);
  }

  bool jumps_right(std::size_t k) const {
    const Piece& after = pieces_.pieces[k];
    if (after.from == pieces_.values[k]) return false;
    return !(abilities_.has_step_next && after.kind == Piece::Kind::Constant &&
             after.to == pieces_.values[k + 1]);
  }

  /// The part of a piece from its start or up to its end without `gap` frames at the other end.
  static Piece without(const Piece& piece, double gap, bool at_start) {
    PLIANT_EXPECTS(piece.kind != Piece::Kind::Easing);
    return at_start ? cut(piece, piece.start + gap).right : cut(piece, piece.end - gap).left;
  }

  void hold_jumps() {
    Pieces result;
    result.before = pieces_.before;
    result.after = pieces_.after;
    const auto add_key = [&](double frame, double value) {
      result.frames.push_back(frame);
      result.values.push_back(value);
    };
    const auto add_step = [&](double start, double end, double from, double to, std::size_t key) {
      Piece step{.start = start, .end = end, .from = from, .to = to, .key = key};
      if (abilities_.has_steps) {
        step.kind = Piece::Kind::Constant;
        step.to = step.from;
      }
      result.pieces.push_back(step);
    };
    const std::string became = fmt::format("became a step of {} frames", abilities_.gap);
    add_key(pieces_.frames[0], pieces_.values[0]);
    for (std::size_t k = 0; k < pieces_.pieces.size(); ++k) {
      Piece piece = pieces_.pieces[k];
      if (jumps_right(k)) {
        const double gap = gap_at(piece.start, piece.length());
        const double start = piece.start;
        piece = without(piece, gap, true);
        add_step(start, piece.start, pieces_.values[k], piece.from, piece.key);
        add_key(piece.start, piece.from);
        losses_.add("jump", became, start, 0, 0, false);
      }
      const bool jumps = jumps_left(k + 1);
      const double end = piece.end;
      if (jumps) piece = without(piece, gap_at(end, piece.length()), false);
      if (!abilities_.has_steps && piece.kind == Piece::Kind::Constant)
        piece.kind = Piece::Kind::Line;
      result.pieces.push_back(piece);
      if (jumps) {
        add_key(piece.end, piece.to);
        add_step(piece.end, end, piece.to, pieces_.values[k + 1], piece.key);
        losses_.add("jump", became, end, 0, 0, false);
      }
      add_key(pieces_.frames[k + 1], pieces_.values[k + 1]);
    }
    pieces_ = std::move(result);
  }

  /// Replaces each piece by the parts that `parts_of` makes of it. Errors: they are too many;
  /// Interrupted.
  template <class PartsOf>
  Result<void> divide(const PartsOf& parts_of) {
    Pieces result;
    result.before = pieces_.before;
    result.after = pieces_.after;
    result.frames.push_back(pieces_.frames[0]);
    result.values.push_back(pieces_.values[0]);
    for (std::size_t k = 0; k < pieces_.pieces.size(); ++k) {
      if (is_stopped(should_stop_)) return interrupted();
      for (const Piece& part : parts_of(pieces_.pieces[k], k)) {
        result.pieces.push_back(part);
        result.frames.push_back(part.end);
        result.values.push_back(part.to);
      }
      if (result.pieces.size() > most_pieces)
        return invalid(fmt::format("would become more than {} keys", most_pieces));
      // The curve has this value there, whatever the parts arrive with.
      result.frames.back() = pieces_.frames[k + 1];
      result.values.back() = pieces_.values[k + 1];
    }
    pieces_ = std::move(result);
    return {};
  }

  static Piece level_of(Piece piece) {
    piece.kind = Piece::Kind::Line;
    return piece;
  }

  Result<void> hold_shapes() {
    return divide([this](const Piece& piece, std::size_t k) -> std::vector<Piece> {
      if (piece.kind == Piece::Kind::Bezier && !piece.is_cubic_in_time &&
          !abilities_.has_long_arms) {
        const bool is_level = piece.from == piece.to && piece.out.value == 0 && piece.in.value == 0;
        return is_level ? std::vector{level_of(piece)} : fitted(piece, "Bézier segment");
      }
      if (piece.kind == Piece::Kind::Easing)
        return parts_of_easing(piece, jumps_right(k) || jumps_left(k + 1));
      return {piece};
    });
  }

  Result<void> hold_arms() {
    return divide([this](const Piece& piece, std::size_t) -> std::vector<Piece> {
      if (piece.kind != Piece::Kind::Bezier) return {piece};
      std::vector<Piece> parts = with_short_arms(piece);
      if (parts.size() > 1) {
        losses_.add("overlong Bézier segment", "became", frame_of(piece), parts.size(), 0, true);
      }
      if (abilities_.least_arm > 0)
        for (Piece& part : parts) part = with_arms(part);
      return parts;
    });
  }

  /// One that is cut for a jump is no easing any more.
  std::vector<Piece> parts_of_easing(const Piece& piece, bool is_cut) {
    if (!is_cut && abilities_.has_easing && abilities_.has_easing(piece)) return {piece};
    if (piece.from == piece.to) return {level_of(piece)};
    const std::string name = fmt::format("{} easing", name_of(piece.easing.ease));
    if (auto parts = cubics_of(piece)) {
      if (parts->size() > 1) losses_.add(name, "became", frame_of(piece), parts->size(), 0, true);
      return *std::move(parts);
    }
    if (piece.easing.ease == Ease::Circ && abilities_.has_long_arms) return arcs_of(piece, name);
    return fitted(piece, name);
  }

  double frame_of(const Piece& piece) const {
    return piece.key < author_frames_.size() ? author_frames_[piece.key] : piece.start;
  }

  /// The exact cubics of an easing that consists of some.
  static std::optional<std::vector<Piece>> cubics_of(const Piece& piece) {
    const Curve<1> curve = curve_of(piece);
    const Piece whole = cubic_piece(piece.start, piece.end, piece.from, piece.to,
                                    slope_at_start(piece), slope_at_end(piece));
    const bool is_cubic = piece.easing.side != EaseSide::InOut &&
                          (piece.easing.ease == Ease::Quad || piece.easing.ease == Ease::Cubic ||
                           piece.easing.ease == Ease::Back);
    if (is_cubic) {
      std::vector<Piece> one = {whole};
      one[0].key = piece.key;
      return one;
    }
    const auto inserted = insert_key(curve, piece.start + piece.length() / 2);
    if (!inserted) return {};
    std::vector<Piece> parts = pieces_of(*inserted).pieces;
    for (Piece& part : parts) part.key = piece.key;
    return parts;
  }

  /// A quarter of an ellipse as Bézier arcs. Source: Riškus, Approximation of a cubic Bézier curve
  /// by circular arcs and vice versa: handles of 4/3·tan(angle/4).
  std::vector<Piece> arcs_of(const Piece& piece, const std::string& name) {
    std::vector<Piece> best;
    double deviation = 0;
    for (int count = 2; count <= 64; count *= 2) {
      best = arcs(piece, count);
      deviation = deviation_of(best, piece);
      if (deviation <= 0.8 * tolerance_) break;
    }
    losses_.add(name, "became", frame_of(piece), best.size(), deviation, false);
    return best;
  }

  static std::vector<Piece> arcs(const Piece& piece, int count) {
    if (piece.easing.side == EaseSide::InOut) {
      const double middle = piece.start + piece.length() / 2;
      const double half = piece.from + (piece.to - piece.from) / 2;
      std::vector<Piece> parts = quarter(piece, piece.start, middle, piece.from, half, count, true);
      for (Piece& part : quarter(piece, middle, piece.end, half, piece.to, count, false))
        parts.push_back(part);
      return parts;
    }
    return quarter(piece, piece.start, piece.end, piece.from, piece.to, count,
                   piece.easing.side == EaseSide::In);
  }

  /// In: time = sin a, value = 1 - cos a; Out is the same turned by half a turn.
  static std::vector<Piece> quarter(const Piece& piece, double start, double end, double from,
                                    double to, int count, bool is_in) {
    const double step = std::numbers::pi / 2 / count;
    const double reach = 4.0 / 3 * std::tan(step / 4);
    const double length = end - start;
    const double rise = to - from;
    std::vector<Piece> parts;
    for (int k = 0; k < count; ++k) {
      const int n = is_in ? k : count - k - 1;  // counted from the level end
      const auto at = [&](int place) {
        const double angle = place * step;
        return std::pair(place == count ? 1.0 : sin_of(angle),
                         place == count ? 0.0 : cos_of(angle));
      };
      const auto [near_sine, near_cosine] = at(n);
      const auto [far_sine, far_cosine] = at(n + 1);
      const Arm near{reach * near_cosine * length, reach * near_sine * rise};
      const Arm far{reach * far_cosine * length, -reach * far_sine * rise};
      Piece part{.kind = Piece::Kind::Bezier, .key = piece.key};
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

  std::vector<Piece> with_short_arms(const Piece& piece) {
    const double most = piece.length() * (1 + 1e-15);
    if (abilities_.has_bold_arms || (piece.out.frames <= most && piece.in.frames <= most))
      return {piece};
    const Cut parts = cut_where_slowest(piece);
    const double least = std::max(1e-5 * piece.length(), 4 * shortest_held_piece);
    if (parts.left.length() > least && parts.right.length() > least)
      return {parts.left, parts.right};
    // Almost at an end: as Blender itself does.
    Piece result = piece;
    for (Arm* const arm : {&result.out, &result.in}) {
      if (arm->frames <= piece.length()) continue;
      arm->value *= piece.length() / arm->frames;
      arm->frames = piece.length();
    }
    losses_.add("overlong handle", "was shortened", frame_of(piece), 0,
                deviation_of({result}, piece), false);
    return {result};
  }

  /// Handles of no length are lengthened along the way that the curve takes from there.
  Piece with_arms(const Piece& piece) {
    const double least = abilities_.least_arm * piece.length();
    const auto is_short = [&](const Arm& arm) { return arm.frames == 0 && arm.value == 0; };
    if (!is_short(piece.out) && !is_short(piece.in)) return piece;
    Piece result = piece;
    result.is_cubic_in_time = false;
    const double slope = (piece.to - piece.from) / piece.length();
    if (is_short(piece.out)) result.out = {least, slope * least};
    if (is_short(piece.in)) result.in = {least, -slope * least};
    losses_.add("empty handle", "was lengthened", frame_of(piece), 0, deviation_of({result}, piece),
                false);
    return result;
  }

  std::vector<Piece> fitted(const Piece& piece, const std::string& name) {
    const Curve<1> curve = curve_of(piece);
    // An elastic jumps at its quiet end, by up to a thousandth of its change.
    const auto limit = [&](double end, double step, double value) {
      const double beside = curve.value(end + step)[0];
      const bool jumps = piece.kind == Piece::Kind::Easing && piece.easing.ease == Ease::Elastic &&
                         std::fabs(beside - value) > 0.1 * tolerance_;
      return Value<1>{jumps ? beside : value};
    };
    const Value<1> from = limit(piece.start, 1e-8 * piece.length(), piece.from);
    const Value<1> to = limit(piece.end, -1e-8 * piece.length(), piece.to);
    const SmoothFunction<1> function{[&](double frame) {
                                       if (frame == piece.start) return from;
                                       return frame == piece.end ? to : curve.value(frame);
                                     },
                                     [&](double frame) { return curve.velocity(frame); },
                                     [&](double frame) { return curve.left_velocity(frame); }};
    const double shortest = std::min(1.0 / 1024, piece.length() / 1024);
    const Fit<1> fit =
        Fitter<1>(function, tolerance_, shortest, most_cubics(piece.length()), should_stop_)
            .fit(piece.start, piece.end);
    if (fit.is_stopped) return {piece};
    std::vector<Piece> parts;
    for (const FittedCubic<1>& cubic : fit.cubics) {
      parts.push_back(cubic_piece(cubic.start, cubic.end, cubic.from[0], cubic.to[0],
                                  cubic.from_slope[0], cubic.to_slope[0]));
      parts.back().key = piece.key;
    }
    losses_.add(name, fit.is_close ? "became" : "changed too fast and became", frame_of(piece),
                parts.size(), fit.deviation, false);
    return parts;
  }

  static double deviation_of(const std::vector<Piece>& parts, const Piece& piece) {
    const Curve<1> exact = curve_of(piece);
    double largest = 0;
    for (const Piece& part : parts) {
      const Curve<1> curve = curve_of(part);
      constexpr int steps = 48;
      for (int k = 1; k < steps; ++k) {
        const double frame = part.start + part.length() * k / steps;
        largest = std::max(largest, std::fabs(curve.value(frame)[0] - exact.value(frame)[0]));
      }
    }
    return largest;
  }

  Pieces pieces_;
  const Abilities& abilities_;
  double tolerance_;
  WantedFrames wanted_;
  const StopRequest& should_stop_;
  std::vector<double> author_frames_;
  LossLog losses_;
};

}  // namespace

Result<Held> hold(Pieces pieces, const Abilities& abilities, double tolerance, WantedFrames wanted,
                  const StopRequest& should_stop) {
  auto held = Holder(std::move(pieces), abilities, tolerance, wanted, should_stop).hold();
  if (held && is_stopped(should_stop)) return interrupted();
  return held;
}

}  // namespace pliant::exchange
