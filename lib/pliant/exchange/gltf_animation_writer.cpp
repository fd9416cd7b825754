#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/base64.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/exchange/converted_channel.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/exchange/rotations.hpp"
#include "pliant/exchange/single.hpp"
#include "pliant/files/gltf/glb.hpp"
#include "pliant/files/gltf/gltf_spool.hpp"

namespace pliant::exchange {
namespace {

using GltfJson = GltfBuffer::Json;

/// A row of keys as a sampler has it. `in` and `out` only if it is a CUBICSPLINE [unit/frame].
struct SampledKey {
  double frame = 0;
  std::array<double, 4> value = {};
  std::array<double, 4> in = {};
  std::array<double, 4> out = {};
};

struct SampledKeys {
  std::string_view interpolation = "LINEAR";
  int width = 3;
  std::vector<SampledKey> keys = {};
};

bool steps_only(const Segments& segments) {
  for (std::size_t k = 0; k < segments.segments.size(); ++k) {
    const Segment& segment = segments.segments[k];
    if (segment.kind != Segment::Kind::Constant || segment.from != segments.values[k]) return false;
  }
  return true;
}

/// A cursor through the segments of a component; beyond them it is constant.
class SegmentCursor {
 public:
  explicit SegmentCursor(Segments segments) : segments_(std::move(segments)) {}

  /// The segment over an interval, which contains no key of the segments. Requires: later than
  /// those before.
  Segment over(double start, double end) {
    const auto& segments = segments_.segments;
    while (next_ < segments.size() && segments[next_].end <= start) ++next_;
    if (next_ == segments.size() || end <= segments[next_].start) {
      const double value =
          next_ == segments.size() ? segments_.values.back() : segments_.values.front();
      return {.start = start, .end = end, .from = value, .to = value};
    }
    Segment segment = segments[next_];
    if (segment.start < start) segment = cut(segment, start).right;
    if (end < segment.end) segment = cut(segment, end).left;
    return segment;
  }

 private:
  Segments segments_;
  std::size_t next_ = 0;
};

std::vector<double> frames_of_all(const ConvertedChannel& channel) {
  std::vector<double> frames;
  for (const ConvertedComponent& part : channel.components)
    frames.insert(frames.end(), part.segments.frames.begin(), part.segments.frames.end());
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

double value_at_or_before(const Segments& segments, double frame) {
  const auto after = std::upper_bound(segments.frames.begin(), segments.frames.end(), frame);
  if (after == segments.frames.begin()) return segments.values.front();
  return segments.values[static_cast<std::size_t>(after - segments.frames.begin()) - 1];
}

/// Steps, whose frames may differ between the components.
SampledKeys sampled_steps(const ConvertedChannel& channel) {
  SampledKeys result{.interpolation = "STEP"};
  for (const double frame : frames_of_all(channel)) {
    SampledKey key{.frame = frame};
    for (std::size_t c = 0; c < channel.components.size(); ++c)
      key.value[c] = value_at_or_before(channel.components[c].segments, frame);
    result.keys.push_back(key);
  }
  return result;
}

SampledKeys sampled_segments(const ConvertedChannel& channel) {
  SampledKeys result;
  const std::vector<double> frames = frames_of_all(channel);
  for (const double frame : frames) result.keys.push_back({.frame = frame});
  bool are_lines = true;
  for (std::size_t c = 0; c < channel.components.size(); ++c) {
    const Segments& segments = channel.components[c].segments;
    SegmentCursor cursor(segments);
    for (const Segment& segment : segments.segments)
      are_lines = are_lines && segment.kind != Segment::Kind::Bezier;
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
      const Segment part = cursor.over(frames[k], frames[k + 1]);
      result.keys[k].value[c] = part.from;
      result.keys[k + 1].value[c] = part.to;
      result.keys[k].out[c] = slope_at_start(part);
      result.keys[k + 1].in[c] = slope_at_end(part);
    }
  }
  result.interpolation = are_lines ? "LINEAR" : "CUBICSPLINE";
  return result;
}

bool all_step(const ConvertedChannel& channel) {
  return std::all_of(channel.components.begin(), channel.components.end(),
                     [](const ConvertedComponent& part) { return steps_only(part.segments); });
}

Abilities gltf_abilities(bool has_steps) {
  return {.has_steps = has_steps, .has_long_arms = false, .has_lines = false, .has_copies = false};
}

class GltfCurveWriter {
 public:
  explicit GltfCurveWriter(const CurveWriting& writing)
      : writing_(writing), buffer_([this](std::string_view bytes) -> Result<void> {
          bytes_ += bytes;
          return {};
        }) {}

  Result<CurveText> write(const std::vector<ChannelCurve>& curves) {
    std::vector<std::pair<const ChannelCurve*, SampledKeys>> sampled;
    for (const ChannelCurve& curve : curves) {
      auto keys = sample(curve);
      if (!keys) return fail(keys.error());
      sampled.emplace_back(&curve, *std::move(keys));
    }
    // Seconds must not be negative.
    frame_at_zero_ = writing_.first;
    for (const auto& [curve, keys] : sampled)
      frame_at_zero_ = std::min(frame_at_zero_, std::floor(keys.keys.front().frame));
    if (frame_at_zero_ < writing_.first) {
      result_.losses.push_back(
          {"time", fmt::format("second 0 is frame {}, where the first key is", frame_at_zero_),
           true});
    }
    for (const auto& [curve, keys] : sampled) {
      if (is_stopped(writing_.should_stop)) return interrupted();
      if (auto added = add(*curve, keys); !added) return fail(added.error());
    }
    result_.bytes = document();
    if (is_stopped(writing_.should_stop)) return interrupted();
    if (!writing_.is_binary) return std::move(result_);
    const auto head = glb_head(result_.bytes, bytes_.size());
    if (!head) {
      return fail(ErrorCode::Unwritable,
                  "the curves are larger than the 4 GiB that a .glb can store; .gltf can store "
                  "more");
    }
    result_.bytes = *head + bytes_;
    return std::move(result_);
  }

 private:
  Result<SampledKeys> sample(const ChannelCurve& curve) {
    // As steps first: nothing is lost if there are no others.
    std::vector<CurveLoss> losses;
    auto channel = converted_channel(curve, gltf_abilities(true), writing_, losses);
    if (!channel) return fail(channel.error());
    const bool is_rotation = path_of_attribute(channel->attribute) == "rotation";
    const bool are_steps = all_step(*channel);
    if (!are_steps) {
      losses.clear();
      channel = converted_channel(curve, gltf_abilities(false), writing_, losses);
      if (!channel) return fail(channel.error());
    }
    for (CurveLoss& loss : losses) result_.losses.push_back(std::move(loss));
    if (is_rotation) return sampled_rotation(curve, *channel, are_steps);
    return are_steps ? sampled_steps(*channel) : sampled_segments(*channel);
  }

  Result<SampledKeys> sampled_rotation(const ChannelCurve& curve, const ConvertedChannel& channel,
                                       bool are_steps) {
    const auto turn = [&](const Value<3>& degrees, const Quaternion& beside) {
      return quaternion_near(degrees, curve.rotate_order, beside);
    };
    SampledKeys result = are_steps ? sampled_steps(channel) : SampledKeys{};
    Quaternion beside{0, 0, 0, 1};
    result.width = 4;
    if (are_steps) {
      for (SampledKey& key : result.keys) {
        beside = turn({key.value[0], key.value[1], key.value[2]}, beside);
        key.value = beside;
      }
      return result;
    }
    return fitted_rotation(curve, channel, turn);
  }

  /// The widest range of an angle between two frames [degrees].
  static double turn_within(const std::vector<Curve<1>>& angles, double first, double last) {
    double widest = 0;
    for (const Curve<1>& angle : angles) {
      const ValueRange<1> range = angle.range(first, last);
      widest = std::max(widest, range.high[0] - range.low[0]);
    }
    return widest;
  }

  template <class Turn>
  Result<SampledKeys> fitted_rotation(const ChannelCurve& curve, const ConvertedChannel& channel,
                                      const Turn& turn) {
    SampledKeys result{.interpolation = "CUBICSPLINE", .width = 4};
    std::vector<Curve<1>> parts;
    double tolerance = least_rotation_tolerance;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const ConvertedComponent& part : channel.components) {
      auto made = Curve<1>::make(exchange::keys_of(part.segments));
      PLIANT_EXPECTS(made.has_value());  // segments of a curve
      tolerance = std::max(tolerance, tolerance_of(*made, writing_));
      first = std::min(first, part.segments.frames.front());
      last = std::max(last, part.segments.frames.back());
      parts.push_back(*std::move(made));
    }
    if (const double fastest = turn_within(parts, first, last); fastest > 360 * 1000) {
      return fail(ErrorCode::InvalidInput,
                  fmt::format("{}: turns by {} degrees; at most 1000 turns become quaternions",
                              curve.channel, fastest));
    }
    const auto at = [&](double frame, const Quaternion& beside) {
      return turn({parts[0].value(frame)[0], parts[1].value(frame)[0], parts[2].value(frame)[0]},
                  beside);
    };
    // A quaternion of unit length that is off by d turns by up to 2·d radians.
    constexpr double degrees_per_unit = 2 * 180 / 3.14159265358979323846;
    Quaternion beside = at(channel.components[0].segments.frames.front(), {0, 0, 0, 1});
    double deviation = 0;
    const std::vector<double> frames = frames_of_all(channel);
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
      const int steps = 64 + static_cast<int>(turn_within(parts, frames[k], frames[k + 1]) / 10);
      const RotationTrack<4> track(at, frames[k], frames[k + 1], beside, steps);
      beside = track.last();
      const SmoothFunction<4> function = track.function();
      const Fit<4> fit = Fitter<4>(function, tolerance / degrees_per_unit / 2, 1.0 / 1024,
                                   most_fitted, writing_.should_stop)
                             .fit(frames[k], frames[k + 1]);
      if (fit.is_stopped || is_stopped(writing_.should_stop)) return interrupted();
      if (!fit.is_complete || result.keys.size() + fit.cubics.size() > most_fitted) {
        return fail(ErrorCode::InvalidInput,
                    fmt::format("{}: would become more than {} keys", curve.channel, most_fitted));
      }
      deviation = std::max(deviation, fit.deviation);
      for (const FittedCubic<4>& cubic : fit.cubics) {
        if (result.keys.empty()) result.keys.push_back({.frame = cubic.start, .value = cubic.from});
        result.keys.back().out = cubic.from_slope;
        result.keys.push_back({.frame = cubic.end, .value = cubic.to, .in = cubic.to_slope});
      }
    }
    result_.losses.push_back(
        {curve.channel, fmt::format("its angles became quaternions: {} keys, within {:.2g} degrees",
                                    result.keys.size(), degrees_per_unit * deviation)});
    return result;
  }

  /// The node of a thing, or of one of its channels.
  std::size_t node_of(const std::string& name, std::optional<std::size_t> parent) {
    const auto [known, is_new] = node_numbers_.try_emplace(name, nodes_.size());
    const std::size_t node = known->second;
    if (!is_new) return node;
    nodes_.push_back({{"name", name}});
    (parent ? nodes_[*parent]["children"] : roots_).push_back(node);
    return node;
  }

  Result<void> add(const ChannelCurve& curve, const SampledKeys& sampled) {
    const auto [thing, attribute] = split_channel(curve.channel);
    const std::size_t parent = node_of(thing, {});
    const std::string_view path = path_of_attribute(attribute);
    const std::size_t node = path.empty() ? node_of(curve.channel, parent) : parent;
    const std::size_t width = static_cast<std::size_t>(sampled.width);
    // One key is the same in each, and a CUBICSPLINE needs two.
    const bool is_single = sampled.keys.size() == 1;
    const bool is_cubic = !is_single && sampled.interpolation == "CUBICSPLINE";
    std::vector<float> times, numbers;
    for (const SampledKey& key : sampled.keys) {
      times.push_back(seconds_of_frame(key.frame, writing_.fps, frame_at_zero_));
      if (times.size() > 1 && !(times.back() > times[times.size() - 2])) {
        return fail(
            ErrorCode::InvalidInput,
            fmt::format("{}: the keys at and before frame {} have one time in single precision",
                        curve.channel, key.frame));
      }
      const auto put = [&](const std::array<double, 4>& row, double factor) {
        for (std::size_t c = 0; c < width; ++c)
          numbers.push_back(static_cast<float>(row[c] * factor));
      };
      if (is_cubic) put(key.in, writing_.fps);
      put(key.value, 1);
      if (is_cubic) put(key.out, writing_.fps);
    }
    for (const float number : numbers) {
      if (!(std::fabs(number) <= std::numeric_limits<float>::max()))
        return fail(ErrorCode::InvalidInput,
                    fmt::format("{}: a number is beyond single precision", curve.channel));
    }
    const auto input = buffer_.add_keys(times, 1, GltfBuffer::Bounds::Written);
    if (!input) return fail(input.error());
    const auto output = buffer_.add_keys(numbers, sampled.width, GltfBuffer::Bounds::None);
    if (!output) return fail(output.error());
    channels_.push_back(
        {{"sampler", samplers_.size()},
         {"target", {{"node", node}, {"path", path.empty() ? "translation" : path}}}});
    samplers_.push_back({{"input", *input},
                         {"output", *output},
                         {"interpolation", is_single ? "STEP" : sampled.interpolation}});
    return {};
  }

  std::string document() {
    GltfJson root = {{"asset", {{"version", "2.0"}, {"generator", "pliant"}}}, {"scene", 0}};
    root["scenes"] =
        GltfJson::array({roots_.empty() ? GltfJson::object() : GltfJson{{"nodes", roots_}}});
    if (!nodes_.empty()) root["nodes"] = nodes_;
    if (!channels_.empty()) {
      root["animations"] = GltfJson::array({{{"name", "pliant"},
                                             {"channels", channels_},
                                             {"samplers", samplers_},
                                             {"extras", {{"pliantFirstFrame", frame_at_zero_}}}}});
      root["accessors"] = buffer_.accessors();
      root["bufferViews"] = buffer_.views();
      GltfJson buffer = {{"byteLength", bytes_.size()}};
      if (!writing_.is_binary)
        buffer["uri"] = "data:application/octet-stream;base64," + base64(bytes_);
      root["buffers"] = GltfJson::array({std::move(buffer)});
    }
    return root.dump(writing_.is_binary ? -1 : 1, ' ', false, GltfJson::error_handler_t::replace);
  }

  const CurveWriting& writing_;
  std::string bytes_;
  GltfBuffer buffer_;
  double frame_at_zero_ = 0;
  std::unordered_map<std::string, std::size_t> node_numbers_;  // by their names
  GltfJson nodes_ = GltfJson::array();
  GltfJson roots_ = GltfJson::array();
  GltfJson channels_ = GltfJson::array();
  GltfJson samplers_ = GltfJson::array();
  CurveText result_;
};

}  // namespace

std::string_view path_of_attribute(std::string_view attribute) {
  if (attribute == "translate" || attribute == "center") return "translation";
  if (attribute == "rotate") return "rotation";
  if (attribute == "scale") return "scale";
  return {};
}

Result<CurveText> write_gltf_curves(const std::vector<ChannelCurve>& curves,
                                    const CurveWriting& writing) {
  return GltfCurveWriter(writing).write(curves);
}

}  // namespace pliant::exchange
