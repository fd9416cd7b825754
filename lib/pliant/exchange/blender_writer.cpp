#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/exchange/blender.hpp"
#include "pliant/exchange/blender_words.hpp"
#include "pliant/exchange/held_channel.hpp"

namespace pliant::exchange {
namespace {

Abilities blender_abilities() {
  return {.lines_need_motion = true,
          .has_counted_copies = true,
          .has_easing =
              [](const Piece& piece) {
                return has_blender_easing(piece.easing, piece.to - piece.from);
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
  FCurveText(const Pieces& pieces, double factor)
      : pieces_(pieces),
        factor_(factor),
        is_linear_(is_sloped(pieces.before) || is_sloped(pieces.after)) {}

  /// A part of it, if it is stopped.
  void append_to(std::string& text, const StopRequest& should_stop) const {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "      \"extrapolation\": \"{}\",\n", is_linear_ ? "LINEAR" : "CONSTANT");
    if (cycle_mode(pieces_.before) + cycle_mode(pieces_.after) > 0) {
      fmt::format_to(out,
                     "      \"cycles\": {{\"before\": \"{}\", \"before_count\": {}, \"after\": "
                     "\"{}\", \"after_count\": {}}},\n",
                     blender_cycles[cycle_mode(pieces_.before)], cycle_count(pieces_.before),
                     blender_cycles[cycle_mode(pieces_.after)], cycle_count(pieces_.after));
    }
    text += "      \"keys\": [\n";
    for (std::size_t k = 0; k < pieces_.frames.size(); ++k) {
      if (is_stopped(should_stop, k)) return;
      append_key(text, k);
      text += k + 1 < pieces_.frames.size() ? ",\n" : "\n";
    }
    text += "      ]";
  }

 private:
  void append_key(std::string& text, std::size_t k) const {
    const double frame = pieces_.frames[k], value = pieces_.values[k];
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
    const bool is_last = k == pieces_.pieces.size();
    const Piece* const piece = is_last ? nullptr : &pieces_.pieces[k];
    if (piece && piece->kind == Piece::Kind::Easing) {
      const Interpolation& easing = piece->easing;
      fmt::format_to(out, "\"interpolation\": \"{}\", \"easing\": \"{}\"",
                     blender_eases[static_cast<std::size_t>(easing.ease)],
                     blender_sides[static_cast<std::size_t>(easing.side)]);
      if (easing.ease == Ease::Back)
        fmt::format_to(out, ", \"back\": {}", easing.back.value_or(1.70158));
      if (easing.ease == Ease::Elastic) {
        fmt::format_to(out, ", \"amplitude\": {}, \"period\": {}",
                       factor_ * easing.amplitude.value_or(std::fabs(piece->to - piece->from)),
                       easing.period.value_or(0));
      }
      return;
    }
    // The straight line beyond a key follows its handle unless the key is LINEAR.
    const bool is_line = piece && piece->kind == Piece::Kind::Line && !(is_linear_ && k == 0);
    const bool is_step = piece && piece->kind == Piece::Kind::Constant;
    fmt::format_to(out, "\"interpolation\": \"{}\", \"easing\": \"AUTO\"",
                   is_step ? "CONSTANT" : (is_line ? "LINEAR" : "BEZIER"));
  }

  /// Handles, with `frames` >= 0.
  Arm left_of(std::size_t k) const {
    if (k == 0) return {1, is_sloped(pieces_.before) ? -pieces_.before.slope : 0};
    const Piece& piece = pieces_.pieces[k - 1];
    return piece.kind == Piece::Kind::Bezier ? piece.in : straight(piece, -1);
  }

  Arm right_of(std::size_t k) const {
    if (k == pieces_.pieces.size()) return {1, is_sloped(pieces_.after) ? pieces_.after.slope : 0};
    const Piece& piece = pieces_.pieces[k];
    return piece.kind == Piece::Kind::Bezier ? piece.out : straight(piece, 1);
  }

  static Arm straight(const Piece& piece, double direction) {
    const bool is_line = piece.kind == Piece::Kind::Line;
    return {piece.length() / 3, is_line ? direction * (piece.to - piece.from) / 3 : 0};
  }

  const Pieces& pieces_;
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
    const auto channel = held_channel(curve, blender_abilities(), writing, result.losses);
    if (!channel) return fail(channel.error());
    const double factor = curve.unit == CurveUnit::Degrees ? std::numbers::pi / 180 : 1;
    for (const HeldComponent& part : channel->components) {
      const std::string index = part.component < 0 ? "null" : fmt::format("{}", part.component);
      fmt::format_to(std::back_inserter(text),
                     "{}\n    {{\n      \"owner\": {}, \"data_path\": {}, \"index\": {}, \"unit\": "
                     "\"{}\",\n",
                     is_first ? "" : ",", json_text(channel->thing), json_text(channel->attribute),
                     index, unit_word(curve.unit));
      FCurveText(part.pieces, factor).append_to(text, writing.should_stop);
      if (is_stopped(writing.should_stop)) return interrupted();
      text += "\n    }";
      is_first = false;
    }
  }
  text += "\n  ]\n}\n";
  return result;
}

}  // namespace pliant::exchange
