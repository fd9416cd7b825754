#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/exchange/converted_channel.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/exchange/maya_units.hpp"

namespace pliant::exchange {
namespace {

// Maya before 2020 counts 6000 times in a second.
constexpr double maya_gap = 1.0 / 128;
constexpr double least_maya_arm = 1e-6;  // one of no length would be a step

Abilities maya_abilities() {
  return {.has_step_next = true, .least_arm = least_maya_arm, .gap = maya_gap};
}

/// One side of a key.
struct MayaTangent {
  std::string_view word = "flat";
  double frames = 0;  // fixed: the handle, both >= 0 in time
  double value = 0;
};

std::string_view infinity_word(const Beyond& side) {
  switch (side.kind) {
    case Beyond::Kind::Line:
      return side.slope == 0 ? "constant" : "linear";
    case Beyond::Kind::Repeat:
      return "cycle";
    case Beyond::Kind::RepeatOffset:
      return "cycleRelative";
    case Beyond::Kind::Mirror:
      return "oscillate";
  }
  return "constant";
}

class MayaCurve {
 public:
  explicit MayaCurve(const Segments& segments) : segments_(segments) {
    for (const Segment& segment : segments.segments)
      is_weighted_ =
          is_weighted_ || (segment.kind == Segment::Kind::Bezier && !segment.is_cubic_in_time);
  }

  /// The largest slope that is written as an angle [unit/frame].
  double steepest() const {
    double steepest = 0;
    for (std::size_t k = 0; k < segments_.frames.size(); ++k)
      for (const MayaTangent& tangent : {in_of(k), out_of(k)})
        if (tangent.word == "fixed" && tangent.frames > 0)
          steepest = std::max(steepest, std::fabs(tangent.value) / tangent.frames);
    return steepest;
  }

  /// A part of it, if it is stopped.
  void append_to(std::string& text, std::string_view output, const StopRequest& should_stop) const {
    fmt::format_to(std::back_inserter(text),
                   "animData {{\n  input time;\n  output {};\n  weighted {};\n  preInfinity {};\n"
                   "  postInfinity {};\n  keys {{\n",
                   output, is_weighted_ ? 1 : 0, infinity_word(segments_.before),
                   infinity_word(segments_.after));
    for (std::size_t k = 0; k < segments_.frames.size() && !is_stopped(should_stop, k); ++k)
      append_key(text, k);
    text += "  }\n}\n";
  }

 private:
  void append_key(std::string& text, std::size_t k) const {
    const MayaTangent in = in_of(k), out = out_of(k);
    // Locked tangents would turn together.
    const bool are_locked = in.word != "fixed" && out.word != "fixed";
    fmt::format_to(std::back_inserter(text), "    {} {} {} {} {} 0 0", segments_.frames[k],
                   segments_.values[k], in.word, out.word, are_locked ? 1 : 0);
    for (const MayaTangent& tangent : {in, out}) {
      if (tangent.word != "fixed") continue;
      const double angle = std::atan2(tangent.value, tangent.frames) * 180 / std::numbers::pi;
      const double weight = is_weighted_ ? std::hypot(tangent.frames, tangent.value) : 1;
      fmt::format_to(std::back_inserter(text), " {} {}", angle, weight);
    }
    text += ";\n";
  }

  MayaTangent in_of(std::size_t k) const {
    if (k == 0) return outer_of(segments_.before);
    const Segment& segment = segments_.segments[k - 1];
    if (segment.kind == Segment::Kind::Line) return {"linear"};
    if (segment.kind != Segment::Kind::Bezier) return {};
    return fixed(segment, {segment.in.frames, -segment.in.value});
  }

  MayaTangent out_of(std::size_t k) const {
    if (k == segments_.segments.size()) return outer_of(segments_.after);
    const Segment& segment = segments_.segments[k];
    switch (segment.kind) {
      case Segment::Kind::Constant:
        return {segment.from == segments_.values[k] ? "step" : "stepnext"};
      case Segment::Kind::Line:
        return {"linear"};
      default:
        return fixed(segment, segment.out);
    }
  }

  static MayaTangent fixed(const Segment& segment, const Arm& arm) {
    if (segment.is_cubic_in_time && arm.value == 0) return {};  // flat, a third
    return {"fixed", arm.frames, arm.value};
  }

  static MayaTangent outer_of(const Beyond& side) {
    if (side.kind != Beyond::Kind::Line || side.slope == 0) return {};
    return {"fixed", 1, side.slope};
  }

  const Segments& segments_;
  bool is_weighted_ = false;
};

bool jumps_at_joints(const Segments& segments) {
  const bool repeats =
      segments.before.kind == Beyond::Kind::Repeat || segments.after.kind == Beyond::Kind::Repeat;
  return repeats && segments.values.front() != segments.values.back();
}

std::string_view output_word(CurveUnit unit) {
  if (unit == CurveUnit::Length) return "linear";
  return unit == CurveUnit::Degrees ? "angular" : "unitless";
}

}  // namespace

Result<CurveText> write_maya(const std::vector<ChannelCurve>& curves, const CurveWriting& writing) {
  CurveText result;
  auto unit = unit_of_rate(writing.fps);
  if (!unit) {
    result.losses.push_back(
        {"timeUnit",
         fmt::format("Maya has no rate of {} frames/s: the frames are those of film, 24",
                     writing.fps),
         true});
    unit = "film";
  }
  std::string& text = result.bytes;
  text = fmt::format(
      "animVersion 1.1;\nmayaVersion 2022;\ntimeUnit {};\nlinearUnit cm;\nangularUnit deg;\n"
      "startTime {};\nendTime {};\n",
      *unit, writing.first, writing.last);
  for (const ChannelCurve& curve : curves) {
    const auto channel = converted_channel(curve, maya_abilities(), writing, result.losses);
    if (!channel) return fail(channel.error());
    for (const ConvertedComponent& part : channel->components) {
      const std::string& attribute = channel->attribute;
      if (part.component < 0) {
        fmt::format_to(std::back_inserter(text), "anim {} {} {} 0 0 0;\n", attribute, attribute,
                       channel->thing);
      } else {
        const char letter = "XYZ"[part.component];
        fmt::format_to(std::back_inserter(text), "anim {}.{}{} {}{} {} 0 0 {};\n", attribute,
                       attribute, letter, attribute, letter, channel->thing, part.component);
      }
      if (jumps_at_joints(part.segments)) {
        result.losses.push_back({curve.channel + component_suffix(part.component),
                                 "where its copies meet, pliant has the last value of the one "
                                 "before, Maya the first of the next"});
      }
      const MayaCurve maya(part.segments);
      // An angle near 90 degrees leaves few digits of its slope.
      constexpr double digits = 2e-16, least_told = 1e9;
      if (const double steepest = maya.steepest(); steepest > least_told) {
        result.losses.push_back(
            {curve.channel + component_suffix(part.component),
             fmt::format("slopes of up to {:.2g} a frame became angles: off by up to {:.1g} of "
                         "the slope",
                         steepest, std::min(1.0, digits * steepest))});
      }
      maya.append_to(text, output_word(curve.unit), writing.should_stop);
      if (is_stopped(writing.should_stop)) return interrupted();
    }
  }
  return result;
}

}  // namespace pliant::exchange
