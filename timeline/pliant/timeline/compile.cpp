#include "pliant/timeline/compile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "pliant/timeline/checks.hpp"
#include "pliant/timeline/key_polyline.hpp"
#include "pliant/timeline/loop.hpp"
#include "pliant/timeline/number_text.hpp"
#include "pliant/timeline/segment_handle.hpp"
#include "pliant/timeline/tangents.hpp"

namespace pliant::timeline {

namespace {

// Rates of change beyond this could overflow when a segment is evaluated.
constexpr double largest_rate = 1e305;

// Segments shorter than this, in frames, keep their time linear: their handles would be subnormal,
// and so rounded to a few of the least numbers.
constexpr double shortest_bent = 0x1p-900;

/// The subject of a note. Copies of a key by the loop repeat its notes; only one of each is kept.
enum class Subject { Left, InTangent, OutTangent, InOvershoot, OutOvershoot, Count };

template <int D>
class Compiler {
 public:
  Compiler(const CurveKeys<D>& author, WrittenKeys<D> written, const StopRequest& should_stop)
      : author_(author),
        written_(std::move(written)),
        should_stop_(should_stop),
        noted_(author.keys.size()),
        notes_(std::move(written_.notes)) {}

  Checked<Compiled<D>> compile() {
    for (int c = 0; c < D; ++c) {
      if (!find_slopes(c) || is_stopped(should_stop_)) return interruption();
    }
    add_keys();
    track().segments.reserve(keys().size() - 1);
    for (std::size_t k = 0; k + 1 < keys().size(); ++k) {
      if (is_stopped(should_stop_, k)) return interruption();
      add_segment(k);
    }
    note_ends();
    if (error_) return tl::unexpected(*error_);
    compiled_.curve.before = outside(author_.before, true);
    compiled_.curve.after = outside(author_.after, false);
    std::stable_sort(notes_.begin(), notes_.end(),
                     [](const CurveNote& a, const CurveNote& b) { return a.key < b.key; });
    compiled_.notes = std::move(notes_);
    return std::move(compiled_);
  }

 private:
  using Kind = typename Segment<D>::Kind;

  const std::vector<Key<D>>& keys() const { return written_.keys_of(author_); }
  Track<D>& track() { return compiled_.curve.track; }

  void note(std::size_t key, Subject subject, std::string message) {
    const std::size_t origin = written_.origin_of(key);
    bool& is_noted = noted_[origin][static_cast<std::size_t>(subject)];
    if (!std::exchange(is_noted, true)) notes_.push_back({origin, std::move(message)});
  }

  void fail(std::size_t key, std::string message) {
    if (!error_) error_ = Complaint{written_.origin_of(key), std::move(message)};
  }

  bool find_slopes(int c) {  // false: it is stopped
    in_.resize(keys().size());
    out_.resize(keys().size());
    const Slopes slopes = tangent_slopes(keys(), author_.before, author_.after, c, should_stop_);
    for (std::size_t k = 0; k < keys().size(); ++k) {
      in_[k][c] = slopes.in[k];
      out_[k][c] = slopes.out[k];
    }
    return !slopes.is_stopped;
  }

  void add_keys() {
    track().frames.reserve(keys().size());
    track().values.reserve(keys().size());
    track().arrivals.reserve(keys().size());
    for (std::size_t k = 0; k < keys().size(); ++k) {
      const Key<D>& key = keys()[k];
      track().frames.push_back(key.frame);
      track().values.push_back(key.value);
      const bool jumps = has_jump(keys(), k);
      const bool follows_step = k > 0 && keys()[k - 1].next.kind == Interpolation::Kind::Step;
      if (key.left && !jumps) {
        note(k, Subject::Left,
             "left has no effect: the segment before is a step, which keeps its value");
      }
      if (follows_step) {
        track().arrivals.push_back(keys()[k - 1].value);
      } else {
        track().arrivals.push_back(jumps ? *key.left : key.value);
      }
    }
    track().search = KeySearch(track().frames);
  }

  void add_segment(std::size_t k) {
    const Interpolation& next = keys()[k].next;
    Segment<D> segment;
    segment.start = keys()[k].frame;
    segment.end = keys()[k + 1].frame;
    segment.length = segment.end - segment.start;
    const Value<D>& start = track().values[k];
    const Value<D>& end = track().arrivals[k + 1];
    // Handles are computed even if no Bézier segment reads them, for their notes.
    const SegmentHandle<D> out = handle(k, true, segment.length);
    const SegmentHandle<D> in = handle(k + 1, false, segment.length);
    switch (next.kind) {
      case Interpolation::Kind::Step:
        segment.ends = value_cubics<D>(start, start, {}, {});
        break;
      case Interpolation::Kind::StepNext:
        segment.kind = Kind::Jump;
        segment.ends = value_cubics<D>(end, end, {}, {});
        break;
      case Interpolation::Kind::Linear:
        segment.ends = value_cubics<D>(start, end, change(start, end), change(start, end));
        break;
      case Interpolation::Kind::Bezier:
        shape_by_arms(k, out, in, segment);
        break;
      case Interpolation::Kind::CubicBezier:
        shape_by_control(next, start, end, segment);
        break;
      case Interpolation::Kind::Easing:
        ease(next, start, end, segment);
        break;
    }
    track().segments.push_back(segment);
  }

  static Value<D> change(const Value<D>& start, const Value<D>& end) {
    Value<D> change;
    for (int c = 0; c < D; ++c) change[c] = end[c] - start[c];
    return change;
  }

  SegmentHandle<D> handle(std::size_t key, bool is_out, double span) {
    std::vector<std::string> changes;
    const Key<D>& author = keys()[key];
    const SegmentHandle<D> handle = segment_handle_of<D>(
        is_out ? author.out : author.in, is_out ? out_[key] : in_[key], span, is_out, changes);
    for (std::string& each : changes) {
      note(key, is_out ? Subject::OutTangent : Subject::InTangent, std::move(each));
    }
    return handle;
  }

  /// The outer sides of the end keys, which no segment reads.
  void note_ends() {
    handle(0, false, 1);
    handle(keys().size() - 1, true, 1);
  }

  void shape_by_arms(std::size_t k, SegmentHandle<D> out, SegmentHandle<D> in,
                     Segment<D>& segment) {
    const double span = segment.length;
    const Lengths lengths{out.length, in.length};
    if (author_.overshoot == Overshoot::Error && !is_function_of_time(lengths, span)) {
      const bool blames_out = out.length > in.length;
      fail(blames_out ? k : k + 1,
           std::string(blames_out ? "out" : "in") + " tangent reaches " +
               number_text(blames_out ? out.length : in.length) + " frames into a segment of " +
               number_text(span) +
               " frames: time would run backwards, which overshoot=\"error\" does not allow");
      return;
    }
    const Lengths legal = corrected(lengths, span, author_.overshoot);
    if (legal.start != lengths.start) {
      note(k, Subject::OutOvershoot, correction("out", lengths.start, legal.start, span));
      out = out.with_length(legal.start);
    }
    if (legal.end != lengths.end) {
      note(k + 1, Subject::InOvershoot, correction("in", lengths.end, legal.end, span));
      in = in.with_length(legal.end);
    }
    const Value<D> start_rate = out.value_rate(span);
    const Value<D> end_rate = in.value_rate(span);
    check_rate(k, "out", out.slope, start_rate);
    check_rate(k + 1, "in", in.slope, end_rate);
    segment.ends =
        value_cubics<D>(track().values[k], track().arrivals[k + 1], start_rate, end_rate);
    add_handle(segment.start, track().values[k], 1, out.length, start_rate);
    add_handle(segment.end, track().arrivals[k + 1], -1, in.length, end_rate);
    // Thirds except for rounding: then time is linear in the parameter, and the curve a cubic in
    // time.
    const bool is_linear_in_time =
        (out.is_third || std::fabs(out.length - span / 3) <= 1e-15 * span) &&
        (in.is_third || std::fabs(in.length - span / 3) <= 1e-15 * span);
    if (is_linear_in_time) return;
    const Pair exact_span = exact_difference(segment.end, segment.start);
    add_time(segment, out.frame_rate(exact_span), in.frame_rate(exact_span));
  }

  /// `direction` is -1 for an `in`; `rate` is three times the rise over the length.
  void add_handle(double frame, const Value<D>& value, double direction, double length,
                  const Value<D>& rate) {
    KeyHandle<D> handle{frame, value, frame + direction * length, value};
    for (int c = 0; c < D; ++c) handle.value[c] += direction * rate[c] / 3;
    compiled_.handles.push_back(handle);
  }

  std::string correction(const std::string& side, double from, double to, double span) const {
    const std::string reason =
        author_.overshoot == Overshoot::Contain
            ? "no tangent may be longer than its segment of " + number_text(span) + " frames"
            : "time would run backwards otherwise";
    return side + " tangent " + (to < from ? "shortened" : "lengthened") + " from " +
           number_text(from) + " to " + number_text(to) + " frames: " + reason;
  }

  void check_rate(std::size_t key, const std::string& side, const Value<D>& slope,
                  const Value<D>& rate) {
    for (int c = 0; c < D; ++c) {
      if (std::fabs(rate[c]) <= largest_rate) continue;
      fail(key, side + " tangent has " +
                    (std::isfinite(slope[c]) ? "the slope " + number_text(slope[c]) : "a slope") +
                    ", which overflows within its segment; the keys are too close together for "
                    "their change of value");
    }
  }

  void add_time(Segment<D>& segment, Pair start_rate, Pair end_rate) {
    if (segment.length < shortest_bent) return;
    segment.kind = Kind::Bezier;
    segment.extra = static_cast<std::uint32_t>(track().times.size());
    track().times.emplace_back(segment.start, segment.end, start_rate, end_rate);
  }

  /// A CSS timing function is a Bézier segment whose handles are shares of time and of change.
  void shape_by_control(const Interpolation& next, const Value<D>& start, const Value<D>& end,
                        Segment<D>& segment) {
    const auto& [x1, y1, x2, y2] = next.control;
    Value<D> start_rate;
    Value<D> end_rate;
    for (int c = 0; c < D; ++c) {
      start_rate[c] = 3 * (y1 * (end[c] - start[c]));
      end_rate[c] = 3 * ((1 - y2) * (end[c] - start[c]));
    }
    segment.ends = value_cubics<D>(start, end, start_rate, end_rate);
    if (std::fabs(x1 - 1.0 / 3) <= 1e-15 && std::fabs(x2 - 2.0 / 3) <= 1e-15) return;
    const Pair span = exact_difference(segment.end, segment.start);
    add_time(segment, 3.0 * (x1 * span), 3.0 * (span + -1.0 * (x2 * span)));
  }

  void ease(const Interpolation& next, const Value<D>& start, const Value<D>& end,
            Segment<D>& segment) {
    const Value<D> rise = change(start, end);
    segment.kind = Kind::Easing;
    segment.extra = static_cast<std::uint32_t>(track().easings.size());
    for (int c = 0; c < D; ++c) {
      segment.ends[0][c] = {start[c], rise[c], 0, 0};
      segment.ends[1][c] = {end[c], -rise[c], 0, 0};
    }
    const auto easing = [&](int c) { return Easing(next, segment.length, rise[c]); };
    if constexpr (D == 1) {
      track().easings.push_back({easing(0)});
    } else {
      track().easings.push_back({easing(0), easing(1), easing(2)});
    }
  }

  Outside<D> outside(const Extrapolation<D>& author, bool is_before) {
    using From = typename Extrapolation<D>::Kind;
    using Mode = typename Outside<D>::Mode;
    const std::size_t end = is_before ? 0 : keys().size() - 1;
    Outside<D> outside;
    outside.is_before = is_before;
    outside.anchor = is_before ? track().arrivals.front() : track().values.back();
    const bool is_single = keys().size() == 1;
    switch (author.kind) {
      case From::Hold:
        break;
      case From::Slope:
        outside.slope = author.slope;
        break;
      case From::LinearOuter:
        outside.slope = is_before ? in_.front() : out_.back();
        break;
      case From::Linear:
        if (is_single || keys()[end].left) break;
        outside.slope =
            is_before ? track().velocity(track().first(), Limit::Right, 0)
                      : track().velocity(track().last(), Limit::Left, track().segments.size() - 1);
        break;
      case From::RepeatOffset:
        if (!is_single) outside.offset = change(track().arrivals.front(), track().values.back());
        [[fallthrough]];
      case From::Repeat:
        if (!is_single) outside.mode = Mode::Repeat;
        break;
      case From::Mirror:
        if (!is_single) outside.mode = Mode::Mirror;
        break;
    }
    for (double& each : outside.slope) {
      each = std::fabs(each) < std::numeric_limits<double>::max() ? each : 0;
    }
    outside.count = author.count.value_or(std::numeric_limits<double>::infinity());
    return outside;
  }

  const CurveKeys<D>& author_;
  WrittenKeys<D> written_;
  const StopRequest& should_stop_;
  std::vector<std::array<bool, static_cast<std::size_t>(Subject::Count)>> noted_;
  std::vector<CurveNote> notes_;
  std::optional<Complaint> error_;
  std::vector<Value<D>> in_;   // slopes of the `in` tangents
  std::vector<Value<D>> out_;  // and of the `out` tangents
  Compiled<D> compiled_;
};

}  // namespace

template <int D>
Checked<Compiled<D>> compile(const CurveKeys<D>& keys, const StopRequest& should_stop) {
  if (const auto error = broken_rule(keys)) return tl::unexpected(*error);
  auto written = written_out(keys);
  if (!written) return tl::unexpected(written.error());
  if (is_stopped(should_stop)) return interruption();
  return Compiler<D>(keys, *std::move(written), should_stop).compile();
}

template Checked<Compiled<1>> compile(const CurveKeys<1>&, const StopRequest&);
template Checked<Compiled<3>> compile(const CurveKeys<3>&, const StopRequest&);

}  // namespace pliant::timeline
