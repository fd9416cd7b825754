// A curve of a few keys with any numbers: compiled, evaluated within, at and beyond its keys, and
// edited.

#include "pliant/timeline/curve.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>

#include "fuzz.hpp"
#include "pliant/timeline/edit/bake_keys.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/simplify.hpp"
#include "pliant/timeline/sampler.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

using Input = FuzzedDataProvider;

/// Mostly small ones, so that keys meet and tangents agree.
double any_number(Input& input) {
  switch (input.ConsumeIntegralInRange(0, 5)) {
    case 0:
      return 0.25 * input.ConsumeIntegralInRange(-40, 40);
    case 1:
      return input.ConsumeIntegralInRange(-1000, 1000);
    case 2:
      return input.ConsumeFloatingPointInRange(-10.0, 10.0);
    case 3:
      return input.PickValueInArray(
          {1e-9, -1e-9, 5e-324, 1e15, -1e15, 1e150, -1e150, 0x1p53, 1.0 / 3, -0.0});
    case 4:
      return std::nextafter(input.ConsumeIntegralInRange(-3, 3),
                            input.ConsumeBool() ? 1e300 : -1e300);
    default: {
      // All bits, infinities and NaN among them.
      const std::vector<std::uint8_t> bytes = input.ConsumeBytes<std::uint8_t>(sizeof(double));
      double number = 0;
      std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::uint8_t*>(&number));
      return number;
    }
  }
}

std::optional<double> maybe_number(Input& input) {
  if (input.ConsumeIntegralInRange(0, 3) > 0) return {};
  return any_number(input);
}

template <int D>
Value<D> any_value(Input& input) {
  Value<D> value;
  for (double& component : value) component = any_number(input);
  return value;
}

template <class Enum>
Enum any_of(Input& input, Enum last) {
  return static_cast<Enum>(input.ConsumeIntegralInRange(0, static_cast<int>(last)));
}

template <int D>
Tangent<D> any_tangent(Input& input) {
  using Kind = typename Tangent<D>::Kind;
  Tangent<D> tangent{.kind = any_of(input, Kind::Handle)};
  if (tangent.kind == Kind::Slope) tangent.slope = any_value<D>(input);
  tangent.length = maybe_number(input);
  if (tangent.kind != Kind::Handle) return tangent;
  tangent.handle_frames = any_number(input);
  tangent.handle_value = any_value<D>(input);
  return tangent;
}

Interpolation any_interpolation(Input& input) {
  Interpolation next{.kind = any_of(input, Interpolation::Kind::CubicBezier)};
  if (next.kind == Interpolation::Kind::Easing) {
    next.ease = any_of(input, Ease::Elastic);
    next.side = any_of(input, EaseSide::InOut);
    next.amplitude = maybe_number(input);
    next.period = maybe_number(input);
    next.back = maybe_number(input);
  }
  if (next.kind == Interpolation::Kind::CubicBezier)
    for (double& number : next.control) number = any_number(input);
  return next;
}

template <int D>
Extrapolation<D> any_side(Input& input) {
  Extrapolation<D> side{.kind = any_of(input, Extrapolation<D>::Kind::Mirror)};
  if (side.kind == Extrapolation<D>::Kind::Slope) side.slope = any_value<D>(input);
  side.count = maybe_number(input);
  return side;
}

template <int D>
CurveKeys<D> any_keys(Input& input) {
  CurveKeys<D> keys;
  const int count = input.ConsumeIntegralInRange(0, 8);
  double frame = any_number(input);
  for (int k = 0; k < count; ++k) {
    Key<D> key{.frame = frame, .value = any_value<D>(input), .next = any_interpolation(input)};
    key.in = any_tangent<D>(input);
    key.out = any_tangent<D>(input);
    if (input.ConsumeIntegralInRange(0, 5) == 0) key.left = any_value<D>(input);
    keys.keys.push_back(key);
    // Mostly later ones.
    const double step = any_number(input);
    frame += input.ConsumeIntegralInRange(0, 20) == 0 ? step : std::fabs(step);
  }
  keys.before = any_side<D>(input);
  keys.after = any_side<D>(input);
  keys.overshoot = any_of(input, Overshoot::Error);
  if (count > 1 && input.ConsumeIntegralInRange(0, 3) == 0) {
    Loop<D> loop;
    loop.from = input.ConsumeBool() ? keys.keys[0].frame : any_number(input);
    loop.to = input.ConsumeBool() ? keys.keys.back().frame : any_number(input);
    loop.before = input.ConsumeIntegralInRange(-1, 20);
    loop.after = input.ConsumeIntegralInRange(-1, 20);
    loop.offset = any_value<D>(input);
    keys.loop = loop;
  }
  return keys;
}

void check_line(const std::string& message) {
  require(!message.empty() && message.find('\n') == std::string::npos);
}

template <int D>
bool is_finite(const Value<D>& value) {
  return std::ranges::all_of(value, [](double component) { return std::isfinite(component); });
}

template <int D>
bool has_nan(const Value<D>& value) {
  return std::ranges::any_of(value, [](double component) { return std::isnan(component); });
}

/// A number that no rule reads may be NaN.
template <int D>
bool is_same(const CurveKeys<D>& a, const CurveKeys<D>& b) {
  return a == b || a != a;
}

/// Keys of the same curve, or an error.
template <int D>
void check_edit(const Checked<Curve<D>>& edited) {
  if (!edited) return check_line(edited.error().message);
  const CurveKeys<D>& keys = edited->keys();
  for (std::size_t k = 1; k < keys.keys.size(); ++k)
    require(keys.keys[k].frame > keys.keys[k - 1].frame);
  const auto again = Curve<D>::make(keys);
  require(again.has_value() && is_same(again->keys(), keys));
  require(!has_nan<D>(edited->value(keys.keys.front().frame)));
}

template <int D>
void check_edits(const Curve<D>& curve, Input& input) {
  const double number = any_number(input);
  check_edit(insert_key(curve, number));
  check_edit(delete_key(curve, input.ConsumeIntegralInRange<std::size_t>(0, 8)));
  check_edit(move_key(curve, input.ConsumeIntegralInRange<std::size_t>(0, 8), number,
                      any_value<D>(input)));
  check_edit(move_keys(curve, number, any_value<D>(input)));
  check_edit(reverse(curve, number));
  Scaling<D> scaling;
  scaling.time_factor = any_number(input);
  scaling.value_factor = any_value<D>(input);
  scaling.frame = number;
  scaling.value = any_value<D>(input);
  check_edit(scale(curve, scaling));
  const double first = curve.keys().keys.front().frame, last = curve.keys().keys.back().frame;
  const double most = std::fabs(number);
  if (const auto simple = simplify(curve, first, last, most)) {
    require(simple->error <= most && Curve<D>::make(simple->keys).has_value());
  } else {
    check_line(simple.error().message);
  }
  const double step = (last - first) / input.ConsumeIntegralInRange(1, 20);
  if (const auto baked = bake_keys(curve, first, last, step)) {
    require(Curve<D>::make(*baked).has_value());
  } else {
    check_line(baked.error().message);
  }
  const auto piece = Curve<D>::make(any_keys<D>(input));
  check_edit(splice(curve, first, number, curve));
  if (!piece) return;
  const auto& keys = piece->keys().keys;
  check_edit(splice(curve, keys.front().frame, keys.back().frame, *piece));
}

/// A curve as its sampler plays it, and the limits at its keys.
template <int D>
void check_values(const Curve<D>& curve, const std::vector<double>& frames) {
  const auto& keys = curve.keys().keys;
  Sampler<D> sampler(curve);
  for (const double frame : frames) {
    const Value<D> value = curve.value(frame);
    require(!has_nan<D>(value) && !has_nan<D>(curve.left_value(frame)));
    require(!has_nan<D>(curve.velocity(frame)) && !has_nan<D>(curve.left_velocity(frame)));
    require(sampler.value(frame) == value);
    require(sampler.left_value(frame) == curve.left_value(frame));
    require(sampler.velocity(frame) == curve.velocity(frame));
    require(sampler.left_velocity(frame) == curve.left_velocity(frame));
    if (frame >= keys.front().frame && frame <= keys.back().frame)
      require(is_finite<D>(value) && is_finite<D>(curve.left_value(frame)));
  }
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const ValueRange<D> range = curve.range(frames[k - 1], frames[k]);
    require(curve.range(frames[k], frames[k - 1]) == range);
    for (const double frame : {frames[k - 1], frames[k]}) {
      const Value<D> value = curve.value(frame);
      for (int c = 0; c < D; ++c) {
        // Values beyond the keys may be infinite.
        const double most = std::max(std::fabs(range.low[c]), std::fabs(range.high[c]));
        const double slack = 1e-12 * std::min(most, std::numeric_limits<double>::max());
        require(range.low[c] <= range.high[c]);
        require(value[c] >= range.low[c] - slack && value[c] <= range.high[c] + slack);
      }
    }
  }
}

template <int D>
void check(Input& input) {
  const CurveKeys<D> keys = any_keys<D>(input);
  const auto curve = Curve<D>::make(keys);
  if (!curve) {
    require(curve.error().index <= keys.keys.size());
    return check_line(curve.error().message);
  }
  require(is_same(curve->keys(), keys));
  for (const CurveNote& note : curve->notes()) check_line(note.message);
  std::vector<double> frames = {-std::numeric_limits<double>::max(), -1e15};
  for (const Key<D>& key : keys.keys) {
    const double next = &key == &keys.keys.back() ? key.frame + 1 : (&key + 1)->frame;
    const double share = input.ConsumeProbability<double>();
    for (const double frame :
         {std::nextafter(key.frame, -1e300), key.frame, std::nextafter(key.frame, 1e300),
          key.frame + share * (next - key.frame), key.frame + 0.5 * (next - key.frame)})
      frames.push_back(frame);
  }
  frames.insert(frames.end(), {1e15, std::numeric_limits<double>::max()});
  std::erase_if(frames, [](double frame) { return !std::isfinite(frame); });
  check_values(*curve, frames);
  for (const KeyHandle<D>& handle : curve->handles()) {
    require(std::isfinite(handle.key_frame) && std::isfinite(handle.frame));
    require(is_finite<D>(handle.key_value) && is_finite<D>(handle.value));
  }
  check_edits(*curve, input);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  Input input(bytes, size);
  if (input.ConsumeBool()) {
    check<1>(input);
  } else {
    check<3>(input);
  }
  return 0;
}
