#include "pliant/exchange/convert.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/exchange/segment_cubics.hpp"

namespace pliant::exchange {
namespace {

// Collects what became of the parts of a curve, one line for each kind of thing.
class LossLog {
 public:
  // `thing`: "jump"; `result`: "became steps of 1/1024 frame". `keys`: that the thing became, 0:
  // not told.
  void add(const std::string& thing, const std::string& result, double frame, std::size_t keys,
           double deviation, bool is_exact) {
    Entry& entry = entries_[{thing, result}];
    if (entry.count++ == 0) {
      entry.frame = frame;
      entry.order = entries_.size();
    }
    entry.keys += keys;
    entry.deviation = std::max(entry.deviation, deviation);
    entry.is_exact = entry.is_exact && is_exact;
  }

  // What happens beyond the keys: a line as it is.
  void add_side(std::string message, bool is_exact) {
    sides_.push_back({std::move(message), is_exact});
  }

  // First those beyond the keys, then all others in their order.
  std::vector<Loss> take() const {
    std::vector<std::pair<std::size_t, Loss>> ordered;
    for (const auto& [what, entry] : entries_) {
      std::string text =
          entry.count == 1
              ? fmt::format("the {} of key {} ", what.first, entry.frame)
              : fmt::format("{} {}s, the first of key {}, ", entry.count, what.first, entry.frame);
      text += entry.count > 1 && what.second.starts_with("was ") ? "were " + what.second.substr(4)
                                                                 : what.second;
      if (entry.keys > 0) text += fmt::format(" {} key{}", entry.keys, entry.keys == 1 ? "" : "s");
      if (!entry.is_exact && entry.deviation > 0)
        text += fmt::format(", within {:.2g}", entry.deviation);
      ordered.push_back({entry.order, {std::move(text), entry.is_exact}});
    }
    std::sort(ordered.begin(), ordered.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Loss> losses = sides_;
    for (auto& [order, loss] : ordered) losses.push_back(std::move(loss));
    return losses;
  }

 private:
  struct Entry {
    std::size_t count = 0;
    std::size_t order = 0;
    double frame = 0;
    std::size_t keys = 0;
    double deviation = 0;
    bool is_exact = true;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries_;
  std::vector<Loss> sides_;
};

constexpr double largest_written_frame = 1e7;
constexpr double largest_written_value = 1e30;
constexpr double shortest_written_segment = 1e-6;

std::string_view name_of(Ease ease) {
  constexpr std::string_view names[] = {"sine", "quad", "cubic", "quart",  "quint",
                                        "expo", "circ", "back",  "bounce", "elastic"};
  return names[static_cast<int>(ease)];
}

std::optional<Error> beyond_bounds(const Segments& segments) {
  const auto error = [](std::string message) {
    return Error{.code = ErrorCode::InvalidInput, .message = std::move(message)};
  };
  for (std::size_t k = 0; k < segments.frames.size(); ++k) {
    if (!(std::fabs(segments.frames[k]) <= largest_written_frame)) {
      return error(
          fmt::format("key {} is too far away: frames of other programs reach from {} to {}",
                      segments.frames[k], -largest_written_frame, largest_written_frame));
    }
    if (!(std::fabs(segments.values[k]) <= largest_written_value)) {
      return error(fmt::format("the value {} of key {} is too large: its size must not exceed {}",
                               segments.values[k], segments.frames[k], largest_written_value));
    }
  }
  for (const Segment& segment : segments.segments) {
    if (!(segment.length() >= shortest_written_segment)) {
      return error(fmt::format("key {} and key {} are too close: other programs need {} frames",
                               segment.start, segment.end, shortest_written_segment));
    }
    for (const double number : {segment.from, segment.to, segment.out.value, segment.in.value}) {
      if (std::fabs(number) <= largest_written_value) continue;
      return error(
          fmt::format("the segment of key {} has the value {}: its size must not exceed {}",
                      segment.start, number, largest_written_value));
    }
  }
  return {};
}

class Converter {
 public:
  Converter(Segments segments, const Abilities& abilities, double tolerance, WantedFrames wanted,
            const StopRequest& should_stop)
      : segments_(std::move(segments)),
        abilities_(abilities),
        tolerance_(tolerance),
        wanted_(wanted),
        should_stop_(should_stop) {}

  Result<ConvertedCurve> convert() {
    for (const Segment& segment : segments_.segments) author_frames_.push_back(segment.start);
    if (auto error = beyond_bounds(segments_)) return fail(*std::move(error));
    if (auto converted = convert_copies(); !converted) return fail(converted.error());
    convert_lines();
    if (auto converted = convert_shapes(); !converted) return fail(converted.error());
    convert_jumps();
    if (auto converted = convert_arms(); !converted) return fail(converted.error());
    if (auto error = beyond_bounds(segments_)) return fail(*std::move(error));
    return ConvertedCurve{std::move(segments_), losses_.take()};
  }

 private:
  static bool has_copies(const Beyond& side) { return side.kind != Beyond::Kind::Line; }

  /// Whether the format shows the same copies.
  bool allows_copies(const Beyond& side) const {
    const double rise = segments_.values.back() - segments_.values.front();
    if (side.kind == Beyond::Kind::RepeatOffset && side.offset != rise) return false;
    if (std::isinf(side.count)) return abilities_.has_copies;
    if (!abilities_.has_counted_copies) return false;
    return side.kind == Beyond::Kind::Repeat ||
           (side.kind == Beyond::Kind::Mirror && std::fmod(side.count, 2) == 0);
  }

  /// Whether a line before or after the keys needs a segment of its own. Copies on the other side
  /// would repeat it.
  bool needs_segment(bool is_before) const {
    const Beyond& side = is_before ? segments_.before : segments_.after;
    if (has_copies(side)) return false;
    const double value = is_before ? segments_.values.front() : segments_.values.back();
    if (side.anchor != value) return true;
    if (side.slope == 0) return false;
    if (!abilities_.has_lines || segments_.segments.empty()) return true;
    const Segment& beside = is_before ? segments_.segments.front() : segments_.segments.back();
    return abilities_.lines_need_motion && is_before && beside.kind == Segment::Kind::Constant;
  }

  Result<void> convert_copies() {
    bool writes_before = has_copies(segments_.before) && !allows_copies(segments_.before);
    bool writes_after = has_copies(segments_.after) && !allows_copies(segments_.after);
    if (needs_segment(true) || writes_before) writes_after = has_copies(segments_.after);
    if (needs_segment(false) || writes_after) writes_before = has_copies(segments_.before);
    if (!writes_before && !writes_after) return {};
    const Segments own = segments_;
    auto written = with_copies(own, writes_before ? std::optional(wanted_.first) : std::nullopt,
                               writes_after ? std::optional(wanted_.last) : std::nullopt);
    if (!written) return fail(written.error());
    segments_ = *std::move(written);
    const auto tell = [&](bool is_before, const Beyond& side) {
      const double span = own.frames.back() - own.frames.front();
      const double reach = is_before ? own.frames.front() - segments_.frames.front()
                                     : segments_.frames.back() - own.frames.back();
      const auto copies = static_cast<std::size_t>(std::llround(reach / span));
      const bool are_all = static_cast<double>(copies) >= side.count;
      const std::size_t keys = copies * own.segments.size();
      losses_.add_side(
          fmt::format("the copies {} the keys became {} key{}{}", is_before ? "before" : "after",
                      keys, keys == 1 ? "" : "s",
                      are_all ? ""
                              : fmt::format(", {} frame {}", is_before ? "from" : "up to",
                                            is_before ? segments_.frames.front()
                                                      : segments_.frames.back())),
          are_all);
    };
    if (writes_before) tell(true, own.before);
    if (writes_after) tell(false, own.after);
    return {};
  }

  void convert_lines() {
    for (const bool is_before : {true, false}) {
      if (!needs_segment(is_before)) continue;
      Beyond& side = is_before ? segments_.before : segments_.after;
      const double end = is_before ? segments_.frames.front() : segments_.frames.back();
      double length = 1;
      if (!abilities_.has_lines && side.slope != 0) {
        length = std::max(length, is_before ? end - wanted_.first : wanted_.last - end);
        losses_.add_side(
            fmt::format("the slope {} the keys became a key at frame {}",
                        is_before ? "before" : "after", is_before ? end - length : end + length),
            false);
      }
      Segment segment{.kind = side.slope == 0 ? Segment::Kind::Constant : Segment::Kind::Line};
      if (is_before) {
        segment.start = end - length;
        segment.end = end;
        segment.to = side.anchor;
        segment.from = side.anchor - side.slope * length;
        segments_.frames.insert(segments_.frames.begin(), segment.start);
        segments_.values.insert(segments_.values.begin(), segment.from);
        segments_.segments.insert(segments_.segments.begin(), segment);
        side.anchor = segment.from;
      } else {
        segment.start = end;
        segment.end = end + length;
        segment.key = author_frames_.size();
        segment.from = side.anchor;
        segment.to = side.anchor + side.slope * length;
        segments_.frames.push_back(segment.end);
        segments_.values.push_back(segment.to);
        segments_.segments.push_back(segment);
        side.anchor = segment.to;
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
    const Segment& before = segments_.segments[k - 1];
    if (before.to == segments_.values[k]) return false;
    return !(abilities_.has_steps && before.kind == Segment::Kind::Constant);
  }

  bool jumps_right(std::size_t k) const {
    const Segment& after = segments_.segments[k];
    if (after.from == segments_.values[k]) return false;
    return !(abilities_.has_step_next && after.kind == Segment::Kind::Constant &&
             after.to == segments_.values[k + 1]);
  }

  /// The part of a segment from its start or up to its end without `gap` frames at the other end.
  static Segment without(const Segment& segment, double gap, bool at_start) {
    PLIANT_EXPECTS(segment.kind != Segment::Kind::Easing);
    return at_start ? cut(segment, segment.start + gap).right
                    : cut(segment, segment.end - gap).left;
  }

  void convert_jumps() {
    Segments result;
    result.before = segments_.before;
    result.after = segments_.after;
    const auto add_key = [&](double frame, double value) {
      result.frames.push_back(frame);
      result.values.push_back(value);
    };
    const auto add_step = [&](double start, double end, double from, double to, std::size_t key) {
      Segment step{.start = start, .end = end, .from = from, .to = to, .key = key};
      if (abilities_.has_steps) {
        step.kind = Segment::Kind::Constant;
        step.to = step.from;
      }
      result.segments.push_back(step);
    };
    const std::string became = fmt::format("became a step of {} frames", abilities_.gap);
    add_key(segments_.frames[0], segments_.values[0]);
    for (std::size_t k = 0; k < segments_.segments.size(); ++k) {
      Segment segment = segments_.segments[k];
      if (jumps_right(k)) {
        const double gap = gap_at(segment.start, segment.length());
        const double start = segment.start;
        segment = without(segment, gap, true);
        add_step(start, segment.start, segments_.values[k], segment.from, segment.key);
        add_key(segment.start, segment.from);
        losses_.add("jump", became, start, 0, 0, false);
      }
      const bool jumps = jumps_left(k + 1);
      const double end = segment.end;
      if (jumps) segment = without(segment, gap_at(end, segment.length()), false);
      if (!abilities_.has_steps && segment.kind == Segment::Kind::Constant)
        segment.kind = Segment::Kind::Line;
      result.segments.push_back(segment);
      if (jumps) {
        add_key(segment.end, segment.to);
        add_step(segment.end, end, segment.to, segments_.values[k + 1], segment.key);
        losses_.add("jump", became, end, 0, 0, false);
      }
      add_key(segments_.frames[k + 1], segments_.values[k + 1]);
    }
    segments_ = std::move(result);
  }

  /// Replaces each segment by those that `divided` makes of it. Errors: they are too many;
  /// Interrupted.
  template <class Divided>
  Result<void> divide(const Divided& divided) {
    Segments result;
    result.before = segments_.before;
    result.after = segments_.after;
    result.frames.push_back(segments_.frames[0]);
    result.values.push_back(segments_.values[0]);
    for (std::size_t k = 0; k < segments_.segments.size(); ++k) {
      if (is_stopped(should_stop_)) return interrupted();
      for (const Segment& part : divided(segments_.segments[k], k)) {
        result.segments.push_back(part);
        result.frames.push_back(part.end);
        result.values.push_back(part.to);
      }
      if (result.segments.size() > most_segments)
        return invalid(fmt::format("would become more than {} keys", most_segments));
      // The curve has this value there, whatever the parts arrive with.
      result.frames.back() = segments_.frames[k + 1];
      result.values.back() = segments_.values[k + 1];
    }
    segments_ = std::move(result);
    return {};
  }

  static Segment level_of(Segment segment) {
    segment.kind = Segment::Kind::Line;
    return segment;
  }

  Result<void> convert_shapes() {
    return divide([this](const Segment& segment, std::size_t k) -> std::vector<Segment> {
      if (segment.kind == Segment::Kind::Bezier && !segment.is_cubic_in_time &&
          !abilities_.has_long_arms) {
        const bool is_level =
            segment.from == segment.to && segment.out.value == 0 && segment.in.value == 0;
        return is_level ? std::vector{level_of(segment)} : fitted(segment, "Bézier segment");
      }
      if (segment.kind == Segment::Kind::Easing)
        return parts_of_easing(segment, jumps_right(k) || jumps_left(k + 1));
      return {segment};
    });
  }

  Result<void> convert_arms() {
    return divide([this](const Segment& segment, std::size_t) -> std::vector<Segment> {
      if (segment.kind != Segment::Kind::Bezier) return {segment};
      std::vector<Segment> parts = with_short_arms(segment);
      if (parts.size() > 1) {
        losses_.add("overlong Bézier segment", "became", frame_of(segment), parts.size(), 0, true);
      }
      if (abilities_.least_arm > 0)
        for (Segment& part : parts) part = with_arms(part);
      return parts;
    });
  }

  /// One that is cut for a jump is no easing any more.
  std::vector<Segment> parts_of_easing(const Segment& segment, bool is_cut) {
    if (!is_cut && abilities_.has_easing && abilities_.has_easing(segment)) return {segment};
    if (segment.from == segment.to) return {level_of(segment)};
    const std::string name = fmt::format("{} easing", name_of(segment.easing.ease));
    if (auto parts = exact_cubics(segment)) {
      if (parts->size() > 1) losses_.add(name, "became", frame_of(segment), parts->size(), 0, true);
      return *std::move(parts);
    }
    if (segment.easing.ease == Ease::Circ && abilities_.has_long_arms)
      return with_loss(arcs_of(segment, tolerance_), segment, name);
    return fitted(segment, name);
  }

  std::vector<Segment> fitted(const Segment& segment, const std::string& name) {
    auto cubics = fitted_cubics(segment, tolerance_, should_stop_);
    return cubics ? with_loss(*std::move(cubics), segment, name) : std::vector{segment};
  }

  /// Tells what became of a segment.
  std::vector<Segment> with_loss(Cubics cubics, const Segment& segment, const std::string& name) {
    losses_.add(name, cubics.are_close ? "became" : "changed too fast and became",
                frame_of(segment), cubics.segments.size(), cubics.deviation, false);
    return std::move(cubics.segments);
  }

  double frame_of(const Segment& segment) const {
    return segment.key < author_frames_.size() ? author_frames_[segment.key] : segment.start;
  }

  std::vector<Segment> with_short_arms(const Segment& segment) {
    const double most = segment.length() * (1 + 1e-15);
    if (abilities_.has_bold_arms || (segment.out.frames <= most && segment.in.frames <= most))
      return {segment};
    const Cut parts = cut_where_slowest(segment);
    const double least = std::max(1e-5 * segment.length(), 4 * shortest_written_segment);
    if (parts.left.length() > least && parts.right.length() > least)
      return {parts.left, parts.right};
    // Almost at an end: as Blender itself does.
    Segment result = segment;
    for (Arm* const arm : {&result.out, &result.in}) {
      if (arm->frames <= segment.length()) continue;
      arm->value *= segment.length() / arm->frames;
      arm->frames = segment.length();
    }
    losses_.add("overlong handle", "was shortened", frame_of(segment), 0,
                deviation_of({result}, segment), false);
    return {result};
  }

  /// Handles of no length are lengthened along the way that the curve takes from there.
  Segment with_arms(const Segment& segment) {
    const double least = abilities_.least_arm * segment.length();
    const auto is_short = [&](const Arm& arm) { return arm.frames == 0 && arm.value == 0; };
    if (!is_short(segment.out) && !is_short(segment.in)) return segment;
    Segment result = segment;
    result.is_cubic_in_time = false;
    const double slope = (segment.to - segment.from) / segment.length();
    if (is_short(segment.out)) result.out = {least, slope * least};
    if (is_short(segment.in)) result.in = {least, -slope * least};
    losses_.add("empty handle", "was lengthened", frame_of(segment), 0,
                deviation_of({result}, segment), false);
    return result;
  }

  Segments segments_;
  const Abilities& abilities_;
  double tolerance_;
  WantedFrames wanted_;
  const StopRequest& should_stop_;
  std::vector<double> author_frames_;
  LossLog losses_;
};

}  // namespace

Result<ConvertedCurve> convert(Segments segments, const Abilities& abilities, double tolerance,
                               WantedFrames wanted, const StopRequest& should_stop) {
  auto converted =
      Converter(std::move(segments), abilities, tolerance, wanted, should_stop).convert();
  if (converted && is_stopped(should_stop)) return interrupted();
  return converted;
}

}  // namespace pliant::exchange
