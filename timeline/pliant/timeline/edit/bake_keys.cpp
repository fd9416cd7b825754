#include "pliant/timeline/edit/bake_keys.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/extrapolated_evaluation.hpp"
#include "pliant/timeline/loop.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

std::optional<Complaint> fault_of(double first, double last, double step,
                                  Interpolation::Kind next) {
  if (next != Interpolation::Kind::Linear && next != Interpolation::Kind::Bezier) {
    return Complaint{0, "baked keys must be linear or bezier"};
  }
  for (const auto& [name, number] :
       {std::pair{"first", first}, std::pair{"last", last}, std::pair{"step", step}}) {
    if (std::isfinite(number)) continue;
    return Complaint{0, std::string(name) + " is " + number_text(number) +
                            "; it must be a finite number of frames"};
  }
  if (!(step > 0)) return Complaint{0, "step is " + number_text(step) + "; it must be positive"};
  if (last < first) {
    return Complaint{0, "last is frame " + number_text(last) +
                            "; it must not come before first, frame " + number_text(first)};
  }
  if ((last - first) / step > most_written_keys - 2) {
    return Complaint{0, "a key every " + number_text(step) + " frames from " + number_text(first) +
                            " to " + number_text(last) + " makes more than " +
                            number_text(most_written_keys) + " keys"};
  }
  return std::nullopt;
}

std::vector<double> frames_of(double first, double last, double step) {
  // The last step ends at `last` even if rounding makes it a little short or long.
  constexpr double tolerance = 1e-9;
  std::vector<double> frames;
  for (double i = 0; first + i * step < last - tolerance * step; ++i) {
    frames.push_back(first + i * step);
  }
  frames.push_back(last);
  return frames;
}

/// A curve's slope as a tangent, replaced by that of the straight line if it is infinite.
template <int D>
Tangent<D> tangent_of(const Value<D>& slope, const Value<D>& start, const Value<D>& end,
                      double span) {
  Value<D> finite;
  for (int c = 0; c < D; ++c)
    finite[c] = std::isfinite(slope[c]) ? slope[c] : (end[c] - start[c]) / span;
  return slope_tangent<D>(finite);
}

}  // namespace

}  // namespace timeline

template <int D>
Checked<CurveKeys<D>> bake_keys(const Curve<D>& curve, double first, double last, double step,
                                Interpolation::Kind next, const StopRequest& should_stop) {
  using namespace timeline;
  if (const auto error = fault_of(first, last, step, next)) return tl::unexpected(*error);
  const auto compiled = compile(curve.keys(), should_stop);
  if (!compiled) return tl::unexpected(compiled.error());
  const Extrapolated<D>& source = compiled->curve;
  const auto locate = [&](double frame) { return source.track.segment_at(frame); };

  CurveKeys<D> result;
  for (const double frame : frames_of(first, last, step)) {
    if (is_stopped(should_stop, result.keys.size())) return interruption();
    Key<D> key;
    key.frame = frame;
    key.value = curve.value(frame);
    key.next.kind = next;
    const Value<D> arrival = curve.left_value(frame);
    if (arrival != key.value && !result.keys.empty()) key.left = arrival;
    result.keys.push_back(key);
  }
  for (std::size_t k = 0; k + 1 < result.keys.size(); ++k) {
    if (is_stopped(should_stop, k)) return interruption();
    Key<D>& left = result.keys[k];
    Key<D>& right = result.keys[k + 1];
    const double span = right.frame - left.frame;
    const Value<D> arrival = right.left.value_or(right.value);
    const Value<D> departure = source.value(left.frame, Limit::Right, locate);
    if (departure != left.value && departure == arrival) {
      left.next.kind = Interpolation::Kind::StepNext;
    } else if (next == Interpolation::Kind::Bezier) {
      left.out = tangent_of<D>(curve.velocity(left.frame), left.value, arrival, span);
      right.in = tangent_of<D>(curve.left_velocity(right.frame), left.value, arrival, span);
    }
  }
  const auto made = Curve<D>::make(result, should_stop);
  if (!made) return tl::unexpected(made.error());
  return result;
}

template Checked<CurveKeys<1>> bake_keys(const Curve<1>&, double, double, double,
                                         Interpolation::Kind, const StopRequest&);
template Checked<CurveKeys<3>> bake_keys(const Curve<3>&, double, double, double,
                                         Interpolation::Kind, const StopRequest&);

}  // namespace pliant
