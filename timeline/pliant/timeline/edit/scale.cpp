#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

/// The maps of frames and values, and of their differences.
template <int D>
struct Mapping {
  std::function<double(double)> frame;
  std::function<double(double, int)> value;
  double time_factor = 1;  ///< > 0
  Value<D> value_factor = Scaling<D>::filled(1);

  Value<D> value_of(const Value<D>& value_before) const {
    Value<D> result;
    for (int c = 0; c < D; ++c) result[c] = value(value_before[c], c);
    return result;
  }
  Value<D> rise_of(const Value<D>& rise) const {
    Value<D> result;
    for (int c = 0; c < D; ++c) result[c] = rise[c] * value_factor[c] + 0.0;  // no -0
    return result;
  }
  Value<D> slope_of(const Value<D>& slope) const {
    Value<D> result;
    for (int c = 0; c < D; ++c) result[c] = slope[c] * value_factor[c] / time_factor + 0.0;
    return result;
  }
};

template <int D>
Mapping<D> mapping_of(const Scaling<D>& scaling) {
  Mapping<D> map;
  map.frame = [scaling](double frame) {
    if (scaling.time_factor == 1) return frame;
    return scaling.frame + scaling.time_factor * (frame - scaling.frame);
  };
  map.value = [scaling](double value, int c) {
    if (scaling.value_factor[c] == 1) return value;
    return scaling.value[c] + scaling.value_factor[c] * (value - scaling.value[c]);
  };
  map.time_factor = scaling.time_factor;
  map.value_factor = scaling.value_factor;
  return map;
}

template <int D>
Tangent<D> mapped(Tangent<D> tangent, const Mapping<D>& map) {
  tangent.slope = map.slope_of(tangent.slope);
  if (tangent.length) *tangent.length *= map.time_factor;
  tangent.handle_frames *= map.time_factor;
  tangent.handle_value = map.rise_of(tangent.handle_value);
  return tangent;
}

template <int D>
Key<D> mapped(Key<D> key, const Mapping<D>& map) {
  key.frame = map.frame(key.frame);
  key.value = map.value_of(key.value);
  if (key.left) key.left = map.value_of(*key.left);
  key.in = mapped(key.in, map);
  key.out = mapped(key.out, map);
  // One amplitude serves all components, whose factors have the same size in this case.
  if (key.next.amplitude) *key.next.amplitude *= std::fabs(map.value_factor[0]);
  if (key.next.period) *key.next.period *= map.time_factor;
  return key;
}

template <int D>
CurveKeys<D> mapped(CurveKeys<D> keys, const Mapping<D>& map) {
  for (Key<D>& key : keys.keys) key = mapped(key, map);
  keys.before.slope = map.slope_of(keys.before.slope);
  keys.after.slope = map.slope_of(keys.after.slope);
  if (keys.loop) {
    keys.loop->from = map.frame(keys.loop->from);
    keys.loop->to = map.frame(keys.loop->to);
    keys.loop->offset = map.rise_of(keys.loop->offset);
  }
  return keys;
}

template <int D>
Shape<D> mapped(Shape<D> shape, const Mapping<D>& map) {
  for (KeySlopes<D>& key : shape.keys) {
    if (key.in) key.in = map.slope_of(*key.in);
    if (key.out) key.out = map.slope_of(*key.out);
  }
  shape.before = map.slope_of(*shape.before);
  shape.after = map.slope_of(*shape.after);
  return shape;
}

/// A curve whose keys are all mapped the same way. The rules for tangents map with them, unless
/// rounding carries a number across a threshold: then the loop is written out, or a tangent is
/// written as a number.
template <int D>
Checked<Curve<D>> mapped(const Curve<D>& curve, const Mapping<D>& map) {
  const auto before = without_loop(curve.keys());
  if (!before) return tl::unexpected(before.error());
  const auto shape_before = shape_of(*before);
  if (!shape_before) return tl::unexpected(shape_before.error());
  CurveKeys<D> keys = mapped(*before, map);
  const Shape<D> shape = mapped(*shape_before, map);
  Slack slack = rounding_of(keys);
  const Slack slack_before = rounding_of(*before);
  double largest_factor = 0;
  for (const double each : map.value_factor) {
    largest_factor = std::max(largest_factor, std::fabs(each));
  }
  slack.frame += slack_before.frame * map.time_factor;
  slack.value += slack_before.value * largest_factor;
  if (curve.keys().loop) {
    CurveKeys<D> author = mapped(curve.keys(), map);
    if (stands_for(author, keys, shape, slack)) return Curve<D>::make(std::move(author));
  }
  // Tangents as long as their segments may become too long by rounding.
  if (keys.overshoot == Overshoot::Error) write_corrections(keys, Overshoot::Limit);
  return preserved(std::move(keys), shape, slack);
}

template <int D>
std::optional<Complaint> fault_of(const Curve<D>& curve, const Scaling<D>& scaling) {
  const auto check = [](const std::string& name, double number,
                        bool is_factor) -> std::optional<Complaint> {
    if (!std::isfinite(number)) {
      return Complaint{0, name + " is " + number_text(number) + "; it must be a finite number"};
    }
    if (is_factor && number == 0) {
      return Complaint{0, name + " is 0; it must be a number other than 0"};
    }
    return std::nullopt;
  };
  if (auto error = check("frame of the scaling", scaling.frame, false)) return error;
  if (auto error = check("time factor", scaling.time_factor, true)) return error;
  bool is_even = true;
  for (int c = 0; c < D; ++c) {
    if (auto error = check("value of the scaling", scaling.value[c], false)) return error;
    if (auto error = check("value factor", scaling.value_factor[c], true)) return error;
    is_even = is_even && std::fabs(scaling.value_factor[c]) == std::fabs(scaling.value_factor[0]);
  }
  if (is_even) return std::nullopt;
  const auto& keys = curve.keys().keys;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const Interpolation& next = keys[k].next;
    if (next.kind == Interpolation::Kind::Easing && next.ease == Ease::Elastic && next.amplitude) {
      return Complaint{k,
                       "the elastic segment has one amplitude for all components; their value "
                       "factors must be of the same size"};
    }
  }
  return std::nullopt;
}

}  // namespace

}  // namespace timeline

template <int D>
Checked<Curve<D>> move_keys(const Curve<D>& curve, double frames, const Rise<D>& rise) {
  for (int c = -1; c < D; ++c) {
    const double number = c < 0 ? frames : rise[c];
    if (std::isfinite(number)) continue;
    return tl::unexpected(Complaint{0, std::string(c < 0 ? "number of frames" : "rise") + " is " +
                                           timeline::number_text(number) +
                                           "; it must be a finite number"});
  }
  timeline::Mapping<D> map;
  map.frame = [&](double frame) { return frame + frames; };
  map.value = [&](double value, int c) { return value + rise[c]; };
  return mapped(curve, map);
}

template <int D>
Checked<Curve<D>> scale(const Curve<D>& curve, const Scaling<D>& scaling) {
  if (const auto error = timeline::fault_of(curve, scaling)) return tl::unexpected(*error);
  if (scaling.time_factor < 0) {
    auto reversed = reverse(curve, scaling.frame);
    if (!reversed) return reversed;
    Scaling<D> forwards = scaling;
    forwards.time_factor = -scaling.time_factor;
    return scale(*reversed, forwards);
  }
  return mapped(curve, timeline::mapping_of(scaling));
}

template <int D>
CurveKeys<D> scaled_keys(CurveKeys<D> keys, const Scaling<D>& scaling) {
  return timeline::mapped(std::move(keys), timeline::mapping_of(scaling));
}

template Checked<Curve<1>> move_keys(const Curve<1>&, double, const Value<1>&);
template Checked<Curve<3>> move_keys(const Curve<3>&, double, const Value<3>&);
template Checked<Curve<1>> scale(const Curve<1>&, const Scaling<1>&);
template Checked<Curve<3>> scale(const Curve<3>&, const Scaling<3>&);
template CurveKeys<1> scaled_keys(CurveKeys<1>, const Scaling<1>&);
template CurveKeys<3> scaled_keys(CurveKeys<3>, const Scaling<3>&);

}  // namespace pliant
