#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/exchange/blender_words.hpp"
#include "pliant/exchange/converted_channel.hpp"
#include "pliant/exchange/formats.hpp"

namespace pliant::exchange {
namespace {

Abilities blender_abilities() {
  return {.lines_need_motion = true,
          .has_counted_copies = true,
          .has_easing =
              [](const Segment& segment) {
                return segment.from == segment.to ||
                       has_blender_easing(segment.easing, segment.to - segment.from);
              },
          .has_bold_arms = false};
}

std::string json_text(std::string_view text) { return nlohmann::json(text).dump(); }

std::size_t cycle_mode(const Beyond& side) {
  switch (side.kind) {
    case Beyond::Kind::Line:
      return 0;
    case Beyond::Kind::Repeat:
      return 1;
    case Beyond::Kind::RepeatOffset:
      return 2;
    case Beyond::Kind::Mirror:
      return 3;
  }
  return 0;
}

double cycle_count(const Beyond& side) {
  return cycle_mode(side) == 0 || std::isinf(side.count) ? 0 : side.count;
}

bool is_sloped(const Beyond& side) { return side.kind == Beyond::Kind::Line && side.slope != 0; }

class FCurveText {
 public:
  /// `factor`: of values, degrees become radians.
  FCurveText(const Segments& segments, double factor)
      : segments_(segments),
        factor_(factor),
        is_linear_(is_sloped(segments.before) || is_sloped(segments.after)) {}

  /// A part of it, if it is stopped.
  void append_to(std::string& text, const StopRequest& should_stop) const {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "      \"extrapolation\": \"{}\",\n", is_linear_ ? "LINEAR" : "CONSTANT");
    if (cycle_mode(segments_.before) + cycle_mode(segments_.after) > 0) {
      fmt::format_to(out,
                     "      \"cycles\": {{\"before\": \"{}\", \"before_count\": {}, \"after\": "
                     "\"{}\", \"after_count\": {}}},\n",
                     blender_cycles[cycle_mode(segments_.before)], cycle_count(segments_.before),
                     blender_cycles[cycle_mode(segments_.after)], cycle_count(segments_.after));
    }
    text += "      \"keys\": [\n";
    for (std::size_t k = 0; k < segments_.frames.size(); ++k) {
      if (is_stopped(should_stop, k)) return;
      append_key(text, k);
      text += k + 1 < segments_.frames.size() ? ",\n" : "\n";
    }
    text += "      ]";
  }

 private:
  void append_key(std::string& text, std::size_t k) const {
    const double frame = segments_.frames[k], value = segments_.values[k];
    const Arm left = left_of(k), right = right_of(k);
    fmt::format_to(std::back_inserter(text),
                   "        {{\"co\": [{}, {}], \"left\": [{}, {}], \"right\": [{}, {}], "
                   "\"left_type\": \"FREE\", \"right_type\": \"FREE\", ",
                   frame, factor_ * value, frame - left.frames, factor_ * (value + left.value),
                   frame + right.frames, factor_ * (value + right.value));
    append_interpolation(text, k);
    text += '}';
  }

  void append_interpolation(std::string& text, std::size_t k) const {
    const auto out = std::back_inserter(text);
    const bool is_last = k == segments_.segments.size();
    const Segment* const segment = is_last ? nullptr : &segments_.segments[k];
    if (segment && segment->kind == Segment::Kind::Easing) {
      const Interpolation& easing = segment->easing;
      fmt::format_to(out, "\"interpolation\": \"{}\", \"easing\": \"{}\"",
                     blender_eases[static_cast<std::size_t>(easing.ease)],
                     blender_sides[static_cast<std::size_t>(easing.side)]);
      if (easing.ease == Ease::Back)
        fmt::format_to(out, ", \"back\": {}", easing.back.value_or(1.70158));
      if (easing.ease == Ease::Elastic) {
        // An amplitude of 0 is the change: between equal values Blender would swing by any other.
        const double change = std::fabs(segment->to - segment->from);
        fmt::format_to(out, ", \"amplitude\": {}, \"period\": {}",
                       change == 0 ? 0 : factor_ * easing.amplitude.value_or(change),
                       easing.period.value_or(0));
      }
      return;
    }
    // The straight line beyond a key follows its handle unless the key is LINEAR.
    const bool is_line = segment && segment->kind == Segment::Kind::Line && !(is_linear_ && k == 0);
    const bool is_step = segment && segment->kind == Segment::Kind::Constant;
    fmt::format_to(out, "\"interpolation\": \"{}\", \"easing\": \"AUTO\"",
                   is_step ? "CONSTANT" : (is_line ? "LINEAR" : "BEZIER"));
  }

  /// Handles, with `frames` >= 0.
  Arm left_of(std::size_t k) const {
    if (k == 0) return {1, is_sloped(segments_.before) ? -segments_.before.slope : 0};
    const Segment& segment = segments_.segments[k - 1];
    return segment.kind == Segment::Kind::Bezier ? segment.in : straight(segment, -1);
  }

  Arm right_of(std::size_t k) const {
    if (k == segments_.segments.size())
      return {1, is_sloped(segments_.after) ? segments_.after.slope : 0};
    const Segment& segment = segments_.segments[k];
    return segment.kind == Segment::Kind::Bezier ? segment.out : straight(segment, 1);
  }

  static Arm straight(const Segment& segment, double direction) {
    const bool is_line = segment.kind == Segment::Kind::Line;
    return {segment.length() / 3, is_line ? direction * (segment.to - segment.from) / 3 : 0};
  }

  const Segments& segments_;
  double factor_;
  bool is_linear_;
};

std::string_view unit_word(CurveUnit unit) {
  if (unit == CurveUnit::Length) return "LENGTH";
  return unit == CurveUnit::Degrees ? "ROTATION" : "NONE";
}

}  // namespace

Result<CurveText> write_blender(const std::vector<ChannelCurve>& curves,
                                const CurveWriting& writing) {
  CurveText result;
  std::string& text = result.bytes;
  text = fmt::format(
      "{{\n  \"format\": \"blender-curves\",\n  \"version\": 1,\n  \"fps\": {},\n"
      "  \"curves\": [",
      writing.fps);
  bool is_first = true;
  for (const ChannelCurve& curve : curves) {
    const auto channel = converted_channel(curve, blender_abilities(), writing, result.losses);
    if (!channel) return fail(channel.error());
    const double factor = curve.unit == CurveUnit::Degrees ? std::numbers::pi / 180 : 1;
    for (const ConvertedComponent& part : channel->components) {
      const std::string index = part.component < 0 ? "null" : fmt::format("{}", part.component);
      fmt::format_to(std::back_inserter(text),
                     "{}\n    {{\n      \"owner\": {}, \"data_path\": {}, \"index\": {}, \"unit\": "
                     "\"{}\",\n",
                     is_first ? "" : ",", json_text(channel->thing), json_text(channel->attribute),
                     index, unit_word(curve.unit));
      FCurveText(part.segments, factor).append_to(text, writing.should_stop);
      if (is_stopped(writing.should_stop)) return interrupted();
      text += "\n    }";
      is_first = false;
    }
  }
  text += "\n  ]\n}\n";
  return result;
}

}  // namespace pliant::exchange
