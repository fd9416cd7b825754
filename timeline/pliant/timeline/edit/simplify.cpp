#include "pliant/timeline/edit/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/edit/bernstein.hpp"
#include "pliant/timeline/edit/frames.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/edit/split.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

constexpr std::size_t parts_of_segment = 512;

/// A cubic in time that replaces the segments between two keys.
template <int D>
struct Fit {
  std::size_t end = 0;  ///< the key where it ends
  Value<D> start_slope = {};
  Value<D> end_slope = {};
  double error = 0;
};

template <int D>
class Fitter {
 public:
  Fitter(const Track<D>& track, double max_error, StopPoll& poll)
      : track_(track), max_error_(max_error), poll_(poll) {}

  /// The longest row of two or more segments from a key to at most `last` that one cubic can
  /// replace; found by doubling, then by bisection.
  std::optional<Fit<D>> longest(std::size_t start, std::size_t last) const {
    const std::size_t reach = reach_of(start, last);
    std::optional<Fit<D>> best;
    std::size_t good = start + 1;
    std::size_t bad = reach + 1;
    for (std::size_t row = 2; good < reach; row *= 2) {
      const std::size_t end = std::min(start + row, reach);
      const auto fit = fit_between(start, end);
      if (!fit) {
        bad = end;
        break;
      }
      best = fit;
      good = end;
    }
    while (bad > good + 1) {
      const std::size_t middle = good + (bad - good) / 2;
      const auto fit = fit_between(start, middle);
      if (fit) best = fit;
      (fit ? good : bad) = middle;
    }
    return best;
  }

 private:
  /// The last key up to which the curve is one row of polynomials without a jump.
  std::size_t reach_of(std::size_t start, std::size_t last) const {
    std::size_t end = start;
    while (end < last && track_.segments[end].kind != Segment<D>::Kind::Easing &&
           leaves_smoothly(end) && (end == start || track_.arrivals[end] == track_.values[end])) {
      ++end;
    }
    return end;
  }

  bool leaves_smoothly(std::size_t key) const {
    const Segment<D>& segment = track_.segments[key];
    if (segment.kind != Segment<D>::Kind::Jump) return true;
    return track_.values[key] == track_.arrivals[key + 1];
  }

  std::optional<Fit<D>> fit_between(std::size_t start, std::size_t end) const {
    Fit<D> fit;
    fit.end = end;
    fit.start_slope = track_.velocity(track_.frames[start], Limit::Right, start);
    fit.end_slope = track_.velocity(track_.frames[end], Limit::Left, end - 1);
    for (int c = 0; c < D; ++c) {
      const double span = track_.frames[end] - track_.frames[start];
      if (!std::isfinite(fit.start_slope[c] * span) || !std::isfinite(fit.end_slope[c] * span)) {
        return std::nullopt;
      }
    }
    for (std::size_t k = start; k < end; ++k) {
      if (poll_.after(parts_of_segment)) return std::nullopt;
      const Handles<D> handles = handles_of(track_, k);
      const Bernstein share = share_of_time(handles, k, start, end);
      for (int c = 0; c < D; ++c) {
        const Bernstein deviation =
            difference(composed(cubic(fit, start, c), share), values(handles, k, start, c));
        fit.error = std::max(fit.error, size_bound(deviation, max_error_));
        if (!(fit.error <= max_error_)) return std::nullopt;
      }
    }
    return fit;
  }

  /// The fit over its own time from 0 to 1, minus its first value.
  Bernstein cubic(const Fit<D>& fit, std::size_t start, int c) const {
    const double third = (track_.frames[fit.end] - track_.frames[start]) / 3;
    const double change = track_.arrivals[fit.end][c] - track_.values[start][c];
    return {0, fit.start_slope[c] * third, change - fit.end_slope[c] * third, change};
  }

  /// Segment k over its parameter, minus the first value of the fit.
  Bernstein values(const Handles<D>& handles, std::size_t k, std::size_t start, int c) const {
    const double origin = track_.values[start][c];
    const double from = track_.segments[k].ends[0][c].c0 - origin;
    const double to = track_.segments[k].ends[1][c].c0 - origin;
    return {from, from + handles.start.value[c], to + handles.end.value[c], to};
  }

  /// The time of segment k over its parameter, as a fraction of the time of the fit.
  Bernstein share_of_time(const Handles<D>& handles, std::size_t k, std::size_t start,
                          std::size_t end) const {
    const double origin = track_.frames[start];
    const double span = track_.frames[end] - origin;
    const double from = track_.frames[k] - origin;
    const double to = track_.frames[k + 1] - origin;
    if (track_.segments[k].kind != Segment<D>::Kind::Bezier) return {from / span, to / span};
    return {from / span, (from + handles.start.frames) / span, (to - handles.end.frames) / span,
            to / span};
  }

  const Track<D>& track_;
  double max_error_;
  StopPoll& poll_;
};

std::optional<Complaint> fault_of(double first, double last, double max_error) {
  if (auto fault = fault_of_frames(first, last)) return fault;
  if (!std::isfinite(max_error) || max_error < 0) {
    return Complaint{0, "greatest error is " + number_text(max_error) +
                            "; it must be a finite number of at least 0"};
  }
  return std::nullopt;
}

/// Keys without a loop, with fits in place of the rows of segments in [from, to] that allow one.
template <int D>
Checked<Simplified<D>> simplified(const CurveKeys<D>& keys, const Shape<D>& shape,
                                  const Track<D>& track, std::size_t from, std::size_t to,
                                  double max_error, const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  const Fitter<D> fitter(track, max_error, poll);
  Simplified<D> result;
  CurveKeys<D> fewer = keys;
  fewer.keys.clear();
  Shape<D> shape_of_fewer = shape;
  shape_of_fewer.keys.clear();
  const auto take = [&](std::size_t k) {
    fewer.keys.push_back(keys.keys[k]);
    shape_of_fewer.keys.push_back(shape.keys[k]);
  };
  for (std::size_t k = 0; k <= from; ++k) take(k);
  for (std::size_t k = from; k < to;) {
    const auto fit = fitter.longest(k, to);
    if (poll.after(parts_of_segment)) return interruption();
    if (!fit) {
      take(++k);
      continue;
    }
    fewer.keys.back().next = {};
    fewer.keys.back().out = slope_tangent<D>(fit->start_slope);
    take(fit->end);
    Key<D>& end = fewer.keys.back();
    end.in = slope_tangent<D>(fit->end_slope);
    // There may have been a step, after which no `left` is used.
    end.left.reset();
    if (track.arrivals[fit->end] != end.value) end.left = track.arrivals[fit->end];
    result.error = std::max(result.error, fit->error);
    k = fit->end;
  }
  for (std::size_t k = to + 1; k < keys.keys.size(); ++k) take(k);
  const auto curve = preserved(std::move(fewer), shape_of_fewer, rounding_of(keys), should_stop);
  if (!curve) return tl::unexpected(curve.error());
  result.keys = curve->keys();
  return result;
}

}  // namespace

}  // namespace timeline

template <int D>
Checked<Simplified<D>> simplify(const Curve<D>& curve, double first, double last, double max_error,
                                const StopRequest& should_stop) {
  using namespace timeline;
  if (const auto error = fault_of(first, last, max_error)) return tl::unexpected(*error);
  const auto keys = without_loop(curve.keys());
  if (!keys) return tl::unexpected(keys.error());
  const auto compiled = compile(*keys, should_stop);
  if (!compiled) return tl::unexpected(compiled.error());
  const std::vector<double>& frames = compiled->curve.track.frames;
  const auto from = std::lower_bound(frames.begin(), frames.end(), first) - frames.begin();
  const auto beyond = std::upper_bound(frames.begin(), frames.end(), last) - frames.begin();
  if (max_error == 0 || beyond - from < 3) return Simplified<D>{curve.keys(), 0};
  const auto shape = shape_of(*keys, should_stop);
  if (!shape) return tl::unexpected(shape.error());
  return simplified(*keys, *shape, compiled->curve.track, static_cast<std::size_t>(from),
                    static_cast<std::size_t>(beyond - 1), max_error, should_stop);
}

template Checked<Simplified<1>> simplify(const Curve<1>&, double, double, double,
                                         const StopRequest&);
template Checked<Simplified<3>> simplify(const Curve<3>&, double, double, double,
                                         const StopRequest&);

}  // namespace pliant
