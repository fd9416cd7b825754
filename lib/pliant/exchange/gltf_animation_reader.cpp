#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/exchange/rotations.hpp"
#include "pliant/exchange/single.hpp"
#include "pliant/files/gltf/gltf_accessor.hpp"
#include "pliant/files/gltf/gltf_buffers.hpp"
#include "pliant/files/gltf/gltf_container.hpp"
#include "pliant/files/gltf/gltf_document.hpp"

namespace pliant::exchange {
namespace {

using gltf::KeyedInterpolation;
using Kind = Tangent<1>::Kind;

constexpr double largest_gltf_frame = 1e7;
constexpr double largest_gltf_value = 1e30;
constexpr std::size_t most_curves = 20'000;

/// The numbers of a sampler: rows of `width`.
struct KeyedValues {
  std::vector<double> frames = {};
  std::vector<double> numbers = {};
  std::size_t width = 1;
  KeyedInterpolation interpolation = KeyedInterpolation::Linear;

  bool is_cubic() const { return interpolation == KeyedInterpolation::CubicSpline; }
  /// Part 0 to 2 of a key of a CUBICSPLINE: tangent in, value, tangent out [unit/s].
  double part(std::size_t key, std::size_t which, std::size_t component) const {
    return numbers[(is_cubic() ? 3 * key + which : key) * width + component];
  }
  double value(std::size_t key, std::size_t component) const { return part(key, 1, component); }
};

class GltfCurveReader {
 public:
  GltfCurveReader(const gltf::Document& document, gltf::AccessorReader& accessors,
                  const CurveReading& reading)
      : document_(document), accessors_(accessors), reading_(reading) {}

  Result<CurveFile> read() {
    const bool are_several = document_.animations.size() > 1;
    for (const gltf::Animation& animation : document_.animations) {
      frame_at_zero_ = animation.first_frame.value_or(reading_.frame_at_zero);
      if (!(std::fabs(frame_at_zero_) <= largest_gltf_frame))
        frame_at_zero_ = reading_.frame_at_zero;
      const std::string prefix = are_several ? animation.name + '/' : "";
      for (const gltf::AnimationChannel& channel : animation.channels) {
        if (is_stopped(reading_.should_stop)) return interrupted();
        if (auto read = read_channel(animation, channel, prefix); !read) return fail(read.error());
      }
    }
    return std::move(file_);
  }

 private:
  Result<void> read_channel(const gltf::Animation& animation, const gltf::AnimationChannel& channel,
                            const std::string& prefix) {
    const std::string node = channel.node ? document_.nodes[*channel.node].name : "";
    const std::string name = prefix + node + '.' + channel.path;
    const bool is_weights = channel.path == "weights";
    const bool is_rotation = channel.path == "rotation";
    if (!channel.node ||
        (!is_weights && !is_rotation && channel.path != "translation" && channel.path != "scale")) {
      file_.losses.push_back({name, "is animated by an extension: left out"});
      return {};
    }
    auto values = read_values(animation.samplers[channel.sampler],
                              is_weights ? 0U : (is_rotation ? 4U : 3U), name);
    if (!values) return fail(values.error());
    if (values->frames.empty()) {
      file_.losses.push_back({name, "has no keys: left out"});
      return {};
    }
    if (is_rotation) return add_rotation(*values, name);
    for (std::size_t c = 0; c < values->width; ++c) {
      FileCurve curve{.group = name};
      if (is_weights) {
        curve.group = fmt::format("{}[{}]", name, c);
      } else {
        curve.component = static_cast<int>(c);
        if (channel.path == "translation") curve.unit = CurveUnit::Length;
      }
      curve.keys = keys_of(*values, c);
      if (auto added = add(std::move(curve)); !added) return added;
    }
    return {};
  }

  Result<void> count_keys(std::size_t more) {
    key_count_ += more;
    if (key_count_ <= most_file_keys) return {};
    return invalid(fmt::format("the file has more than {} keys", most_file_keys));
  }

  /// Width 0: as many as there are.
  Result<KeyedValues> read_values(const gltf::AnimationSampler& sampler, std::size_t width,
                                  const std::string& name) {
    KeyedValues values{.width = width, .interpolation = sampler.interpolation};
    const auto times = accessors_.scalars(sampler.times);
    if (!times) return fail(times.error());
    for (const double seconds : *times) {
      const double frame = frame_of_seconds(seconds, reading_.fps, frame_at_zero_);
      if (!(std::fabs(frame) <= largest_gltf_frame)) {
        return invalid(fmt::format("{} has the time {} s; it must be a number, at most {} frames",
                                   name, seconds, largest_gltf_frame));
      }
      if (!values.frames.empty() && !(frame > values.frames.back())) {
        return invalid(
            fmt::format("{} has a key at {} s after one at frame {}; times must increase", name,
                        seconds, values.frames.back()));
      }
      values.frames.push_back(frame);
    }
    auto numbers = width == 0 ? accessors_.scalars(sampler.values)
                              : accessors_.vectors(sampler.values, static_cast<int>(width));
    if (!numbers) return fail(numbers.error());
    values.numbers = *std::move(numbers);
    const std::size_t rows = values.frames.size() * (values.is_cubic() ? 3 : 1);
    if (width == 0) values.width = rows == 0 ? 0 : values.numbers.size() / rows;
    if (values.numbers.size() != rows * values.width || (rows > 0 && values.width == 0)) {
      return invalid(fmt::format("{} has {} numbers for {} keys", name, values.numbers.size(),
                                 values.frames.size()));
    }
    if (values.width > most_curves)
      return invalid(fmt::format("{} animates more than {} weights", name, most_curves));
    if (auto counted = count_keys(values.frames.size() * values.width); !counted)
      return fail(counted.error());
    for (double& number : values.numbers) {
      number = shortest_of_single(number);
      if (!(std::fabs(number) <= largest_gltf_value)) {
        return invalid(fmt::format("{} has the value {}; its size must not exceed {}", name, number,
                                   largest_gltf_value));
      }
    }
    return values;
  }

  CurveKeys<1> keys_of(const KeyedValues& values, std::size_t component) const {
    CurveKeys<1> keys;
    for (std::size_t k = 0; k < values.frames.size(); ++k) {
      Key<1> key{.frame = values.frames[k], .value = {values.value(k, component)}};
      if (values.interpolation == KeyedInterpolation::Step) {
        key.next.kind = Interpolation::Kind::Step;
      } else if (values.interpolation == KeyedInterpolation::Linear) {
        key.next.kind = Interpolation::Kind::Linear;
      } else {
        key.in = {.kind = Kind::Slope, .slope = {values.part(k, 0, component) / reading_.fps}};
        key.out = {.kind = Kind::Slope, .slope = {values.part(k, 2, component) / reading_.fps}};
      }
      keys.keys.push_back(key);
    }
    return keys;
  }

  Result<void> add(FileCurve curve) {
    name_curve(curve, names_);
    if (file_.curves.size() == most_curves)
      return invalid(fmt::format("the file has more than {} curves", most_curves));
    if (const auto made = Curve<1>::make(curve.keys, reading_.should_stop); !made)
      return fail(error_of(made.error(), curve.name));
    file_.curves.push_back(std::move(curve));
    return {};
  }

  static Quaternion rotation_at(const KeyedValues& values, std::size_t key) {
    Quaternion rotation{};
    for (std::size_t c = 0; c < 4; ++c) rotation[c] = values.value(key, c);
    return rotation;
  }

  Result<void> add_rotation(const KeyedValues& values, const std::string& name) {
    for (std::size_t k = 0; k < values.frames.size(); ++k) {
      double squared = 0;
      for (const double each : rotation_at(values, k)) squared += each * each;
      if (!(squared > 1e-12)) {
        return invalid(
            fmt::format("{} has a quaternion of length 0 at frame {}", name, values.frames[k]));
      }
    }
    std::array<CurveKeys<1>, 3> keys;
    const Value<3> first =
        euler_near(rotation_at(values, 0), reading_.rotate_order, Value<3>{0, 0, 0});
    if (values.interpolation == KeyedInterpolation::Step || values.frames.size() == 1) {
      Value<3> near = first;
      for (std::size_t k = 0; k < values.frames.size(); ++k) {
        near = euler_near(rotation_at(values, k), reading_.rotate_order, near);
        for (std::size_t c = 0; c < 3; ++c) {
          keys[c].keys.push_back(
              {.frame = values.frames[k], .value = {near[c]}, .next = {Interpolation::Kind::Step}});
        }
      }
    } else if (auto fitted = fit_rotation(values, first, keys, name); !fitted) {
      return fitted;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      FileCurve curve{.group = name,
                      .component = static_cast<int>(c),
                      .keys = std::move(keys[c]),
                      .unit = CurveUnit::Degrees};
      if (auto added = add(std::move(curve)); !added) return added;
    }
    return {};
  }

  Quaternion rotation_within(const KeyedValues& values, std::size_t key, double frame) const {
    const double length = values.frames[key + 1] - values.frames[key];
    const double q = (frame - values.frames[key]) / length;
    if (!values.is_cubic()) return slerp(rotation_at(values, key), rotation_at(values, key + 1), q);
    const double p = 1 - q;
    const double seconds = length / reading_.fps;
    Quaternion rotation{};
    for (std::size_t c = 0; c < 4; ++c) {
      rotation[c] = p * p * (1 + 2 * q) * values.value(key, c) +
                    q * q * (1 + 2 * p) * values.value(key + 1, c) +
                    seconds * p * q * (p * values.part(key, 2, c) - q * values.part(key + 1, 0, c));
    }
    return rotation;
  }

  Result<void> fit_rotation(const KeyedValues& values, const Value<3>& first,
                            std::array<CurveKeys<1>, 3>& keys, const std::string& name) {
    std::vector<RotationTrack<3>> tracks;
    Value<3> low = first, high = first, near = first;
    for (std::size_t k = 0; k + 1 < values.frames.size(); ++k) {
      if (is_stopped(reading_.should_stop, k)) return interrupted();
      const auto angles = [&values, k, this](double frame, const Value<3>& beside) {
        return euler_near(rotation_within(values, k, frame), reading_.rotate_order, beside);
      };
      tracks.emplace_back(angles, values.frames[k], values.frames[k + 1], near, 64);
      near = tracks.back().last();
      tracks.back().add_bounds(low, high);
    }
    double range = 0;
    for (std::size_t c = 0; c < 3; ++c) range = std::max(range, high[c] - low[c]);
    const double tolerance = std::max(reading_.tolerance * range, least_rotation_tolerance);
    double deviation = 0;
    std::size_t count = 0;
    const auto tangent = [](double slope) {
      return Tangent<1>{.kind = Kind::Slope, .slope = {slope}};
    };
    for (const RotationTrack<3>& track : tracks) {
      const SmoothFunction<3> function = track.function();
      const Fit<3> fit =
          Fitter<3>(function, tolerance, 1.0 / 1024, most_fitted, reading_.should_stop)
              .fit(track.start(), track.end());
      if (fit.is_stopped || is_stopped(reading_.should_stop)) return interrupted();
      count += fit.cubics.size();
      if (!fit.is_complete || count > most_fitted)
        return invalid(fmt::format("{} would become more than {} keys", name, most_fitted));
      if (auto counted = count_keys(3 * fit.cubics.size()); !counted) return counted;
      deviation = std::max(deviation, fit.deviation);
      for (const FittedCubic<3>& cubic : fit.cubics) {
        for (std::size_t c = 0; c < 3; ++c) {
          std::vector<Key<1>>& row = keys[c].keys;
          if (row.empty()) row.push_back({.frame = cubic.start, .value = {cubic.from[c]}});
          row.back().out = tangent(cubic.from_slope[c]);
          row.push_back(
              {.frame = cubic.end, .value = {cubic.to[c]}, .in = tangent(cubic.to_slope[c])});
        }
      }
    }
    file_.losses.push_back(
        {name, fmt::format("its quaternions became angles: {} keys, within {:.2g} degrees",
                           count + 1, deviation)});
    return {};
  }

  const gltf::Document& document_;
  gltf::AccessorReader& accessors_;
  const CurveReading& reading_;
  double frame_at_zero_ = 0;
  std::size_t key_count_ = 0;
  CurveFile file_;
  CurveNames names_;
};

}  // namespace

Result<CurveFile> parse_gltf_curves(std::string_view bytes, const CurveReading& reading,
                                    const ReadCurveReference& read_reference) {
  const auto container = gltf::open_container(bytes);
  if (!container) return fail(container.error());
  const auto document =
      gltf::read_document(container->json, gltf::Subject::Animations, reading.should_stop);
  if (!document) return fail(document.error());
  gltf::Buffers buffers(*document, container->binary, bytes.size(), read_reference);
  gltf::AccessorReader accessors(*document, buffers);
  return GltfCurveReader(*document, accessors, reading).read();
}

}  // namespace pliant::exchange
