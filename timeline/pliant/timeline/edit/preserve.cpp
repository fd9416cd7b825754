#include "pliant/timeline/edit/preserve.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "pliant/timeline/checks.hpp"
#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/loop.hpp"
#include "pliant/timeline/overshoot.hpp"
#include "pliant/timeline/segment_handle.hpp"
#include "pliant/timeline/tangents.hpp"

namespace pliant::timeline {

namespace {

template <int D>
bool is_bezier(const std::vector<Key<D>>& keys, std::size_t segment) {
  return keys[segment].next.kind == Interpolation::Kind::Bezier;
}

template <int D>
bool is_kind(const Extrapolation<D>& outside, typename Extrapolation<D>::Kind kind) {
  return outside.kind == kind;
}

template <int D>
std::vector<KeySlopes<D>> slopes_in_use(const CurveKeys<D>& author) {
  using Outer = typename Extrapolation<D>::Kind;
  const std::vector<Key<D>>& keys = author.keys;
  const std::size_t last = keys.size() - 1;
  std::vector<KeySlopes<D>> result(keys.size());
  for (int c = 0; c < D; ++c) {
    const Slopes slopes = tangent_slopes(keys, author.before, author.after, c);
    for (std::size_t k = 0; k <= last; ++k) {
      const bool reads_in =
          k > 0 ? is_bezier(keys, k - 1) : is_kind(author.before, Outer::LinearOuter);
      const bool reads_out =
          k < last ? is_bezier(keys, k) : is_kind(author.after, Outer::LinearOuter);
      if (reads_in && c == 0) result[k].in = Value<D>{};
      if (reads_out && c == 0) result[k].out = Value<D>{};
      if (reads_in) (*result[k].in)[c] = slopes.in[k];
      if (reads_out) (*result[k].out)[c] = slopes.out[k];
    }
  }
  return result;
}

template <int D>
bool is_automatic(const Tangent<D>& tangent) {
  using Kind = typename Tangent<D>::Kind;
  return tangent.kind != Kind::Slope && tangent.kind != Kind::Handle && tangent.kind != Kind::Flat;
}

/// Whether a slope equals the wanted one, as far as it affects a segment of `span` frames.
template <int D>
bool agrees(const Value<D>& slope, const Value<D>& wanted, double span, const Slack& slack) {
  for (int c = 0; c < D; ++c) {
    if (slope[c] == wanted[c]) continue;
    const double change = std::fabs(slope[c] - wanted[c]) * span;
    if (!(change <= slack.value + std::fabs(wanted[c]) * slack.frame)) return false;
  }
  return true;
}

/// Returns whether the tangent had to be written as a number.
template <int D>
bool keep_slope(Tangent<D>& tangent, const std::optional<Value<D>>& slope,
                const std::optional<Value<D>>& wanted, double span, const Slack& slack) {
  if (!wanted || !slope || !is_automatic(tangent)) return false;
  if (agrees<D>(*slope, *wanted, span, slack)) return false;
  tangent.kind = Tangent<D>::Kind::Slope;
  tangent.slope = *wanted;
  return true;
}

template <int D>
bool keep_slopes(CurveKeys<D>& author, const Shape<D>& shape, const Slack& slack) {
  std::vector<Key<D>>& keys = author.keys;
  const std::vector<KeySlopes<D>> slopes = slopes_in_use(author);
  bool has_changed = false;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    // The outer side of an end key uses the span of the inner side.
    const double before = k > 0 ? keys[k].frame - keys[k - 1].frame : 1;
    const double after = k + 1 < keys.size() ? keys[k + 1].frame - keys[k].frame : 1;
    const bool in =
        keep_slope<D>(keys[k].in, slopes[k].in, shape.keys[k].in, k > 0 ? before : after, slack);
    const bool out = keep_slope<D>(keys[k].out, slopes[k].out, shape.keys[k].out,
                                   k + 1 < keys.size() ? after : before, slack);
    has_changed = has_changed || in || out;
  }
  return has_changed;
}

template <int D>
bool keep_line(Extrapolation<D>& outside, const Value<D>& slope,
               const std::optional<Value<D>>& wanted, double span, const Slack& slack) {
  if (!wanted || outside.kind != Extrapolation<D>::Kind::Linear) return false;
  // Slopes that differ by rounding alone are equal.
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  if (agrees<D>(slope, *wanted, 1, {0, 4 * epsilon})) return false;
  if (agrees<D>(slope, *wanted, span, slack)) return false;
  outside.kind = Extrapolation<D>::Kind::Slope;
  outside.slope = *wanted;
  return true;
}

template <int D>
double largest_change(const Value<D>& a, const Value<D>& b) {
  double change = 0;
  for (int c = 0; c < D; ++c) change = std::max(change, std::fabs(a[c] - b[c]));
  return change;
}

template <int D>
bool are_close(const Key<D>& a, const Key<D>& b, const Slack& slack) {
  return std::fabs(a.frame - b.frame) <= slack.frame &&
         largest_change<D>(a.value, b.value) <= slack.value &&
         a.left.has_value() == b.left.has_value() &&
         (!a.left || largest_change<D>(*a.left, *b.left) <= slack.value) && a.next == b.next &&
         a.in == b.in && a.out == b.out;
}

template <int D>
void set_length(Tangent<D>& tangent, SegmentHandle<D> handle, double length, bool is_out) {
  if (!handle.is_vector) {
    tangent.length = length;
    return;
  }
  const double direction = is_out ? 1 : -1;
  handle = handle.with_length(length);
  tangent.handle_frames = direction * length;
  for (int c = 0; c < D; ++c) tangent.handle_value[c] = direction * handle.rise[c];
}

}  // namespace

template <int D>
Checked<CurveKeys<D>> without_loop(const CurveKeys<D>& keys) {
  auto written = written_out(keys);
  if (!written) return tl::unexpected(written.error());
  CurveKeys<D> result = keys;
  if (!written->keys.empty()) result.keys = std::move(written->keys);
  result.loop.reset();
  return result;
}

template <int D>
Checked<Shape<D>> shape_of(const CurveKeys<D>& keys, const StopRequest& should_stop) {
  const auto compiled = compile(keys, should_stop);
  if (!compiled) return tl::unexpected(compiled.error());
  return Shape<D>{slopes_in_use(keys), compiled->curve.before.slope, compiled->curve.after.slope};
}

template <int D>
Checked<Curve<D>> preserved(CurveKeys<D> keys, const Shape<D>& shape, const Slack& slack,
                            const StopRequest& should_stop) {
  // A tangent that becomes a number may change its smooth neighbours, at least by rounding, and an
  // end that no longer extends its line may change the automatic ones there; each round fixes one
  // or more.
  for (;;) {
    if (const auto valid = compile(keys, should_stop); !valid) return tl::unexpected(valid.error());
    while (keep_slopes(keys, shape, slack)) {
      if (is_stopped(should_stop)) return interruption();
    }
    const auto compiled = compile(keys, should_stop);
    if (!compiled) return tl::unexpected(compiled.error());
    const std::size_t count = keys.keys.size();
    const auto span = [&](std::size_t segment) {
      return count > 1 ? keys.keys[segment + 1].frame - keys.keys[segment].frame : 1.0;
    };
    const bool before =
        keep_line<D>(keys.before, compiled->curve.before.slope, shape.before, span(0), slack);
    const bool after = keep_line<D>(keys.after, compiled->curve.after.slope, shape.after,
                                    span(count > 1 ? count - 2 : 0), slack);
    if (!before && !after) return Curve<D>::make(std::move(keys), should_stop);
  }
}

template <int D>
Slack rounding_of(const CurveKeys<D>& keys) {
  constexpr double unit = 64 * std::numeric_limits<double>::epsilon();
  Slack slack;
  for (const Key<D>& key : keys.keys) {
    slack.frame = std::max(slack.frame, unit * std::fabs(key.frame));
    for (int c = 0; c < D; ++c) {
      slack.value = std::max(slack.value, unit * std::fabs(key.value[c]));
      if (key.left) slack.value = std::max(slack.value, unit * std::fabs((*key.left)[c]));
    }
  }
  return slack;
}

template <int D>
bool stands_for(const CurveKeys<D>& author, const CurveKeys<D>& written, const Shape<D>& shape,
                const Slack& slack) {
  if (broken_rule(author)) return false;  // rounding may leave nothing of the loop
  const auto keys = without_loop(author);
  if (!keys || keys->keys.size() != written.keys.size()) return false;
  const auto same = [&](const Key<D>& a, const Key<D>& b) { return are_close(a, b, slack); };
  if (!std::equal(keys->keys.begin(), keys->keys.end(), written.keys.begin(), same)) return false;
  const auto result = preserved(*keys, shape, slack);
  return result && result->keys() == *keys;
}

template <int D>
void write_corrections(CurveKeys<D>& author, Overshoot policy) {
  std::vector<Key<D>>& keys = author.keys;
  std::vector<std::string> ignored;
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    if (!is_bezier(keys, k)) continue;
    const double span = keys[k + 1].frame - keys[k].frame;
    const SegmentHandle<D> out = segment_handle_of<D>(keys[k].out, {}, span, true, ignored);
    const SegmentHandle<D> in = segment_handle_of<D>(keys[k + 1].in, {}, span, false, ignored);
    const Lengths legal = corrected({out.length, in.length}, span, policy);
    if (legal.start != out.length) set_length(keys[k].out, out, legal.start, true);
    if (legal.end != in.length) set_length(keys[k + 1].in, in, legal.end, false);
  }
}

template Checked<CurveKeys<1>> without_loop(const CurveKeys<1>&);
template Checked<CurveKeys<3>> without_loop(const CurveKeys<3>&);
template Checked<Shape<1>> shape_of(const CurveKeys<1>&, const StopRequest&);
template Checked<Shape<3>> shape_of(const CurveKeys<3>&, const StopRequest&);
template Checked<Curve<1>> preserved(CurveKeys<1>, const Shape<1>&, const Slack&,
                                     const StopRequest&);
template Checked<Curve<3>> preserved(CurveKeys<3>, const Shape<3>&, const Slack&,
                                     const StopRequest&);
template Slack rounding_of(const CurveKeys<1>&);
template Slack rounding_of(const CurveKeys<3>&);
template bool stands_for(const CurveKeys<1>&, const CurveKeys<1>&, const Shape<1>&, const Slack&);
template bool stands_for(const CurveKeys<3>&, const CurveKeys<3>&, const Shape<3>&, const Slack&);
template void write_corrections(CurveKeys<1>&, Overshoot);
template void write_corrections(CurveKeys<3>&, Overshoot);

}  // namespace pliant::timeline
