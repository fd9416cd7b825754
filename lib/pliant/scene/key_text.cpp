#include "pliant/scene/key_text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/nearest.hpp"

namespace pliant::xml {
namespace {

/// The word for an enumerator.
template <class E>
using Word = std::pair<std::string_view, E>;

constexpr Word<Interpolation::Kind> interpolations[] = {
    {"step", Interpolation::Kind::Step},
    {"stepNext", Interpolation::Kind::StepNext},
    {"linear", Interpolation::Kind::Linear},
    {"bezier", Interpolation::Kind::Bezier},
    {"cubicBezier", Interpolation::Kind::CubicBezier},
};

constexpr Word<Ease> eases[] = {
    {"sine", Ease::Sine},       {"quad", Ease::Quad},   {"cubic", Ease::Cubic},
    {"quart", Ease::Quart},     {"quint", Ease::Quint}, {"expo", Ease::Expo},
    {"circ", Ease::Circ},       {"back", Ease::Back},   {"bounce", Ease::Bounce},
    {"elastic", Ease::Elastic},
};

constexpr Word<EaseSide> sides[] = {
    {"In", EaseSide::In}, {"Out", EaseSide::Out}, {"InOut", EaseSide::InOut}};

/// The kinds of tangents that have a name; slopes and handles are numbers.
template <int D>
constexpr Word<typename Tangent<D>::Kind> tangents[] = {
    {"auto", Tangent<D>::Kind::Auto},       {"spline", Tangent<D>::Kind::Spline},
    {"linear", Tangent<D>::Kind::Linear},   {"flat", Tangent<D>::Kind::Flat},
    {"clamped", Tangent<D>::Kind::Clamped}, {"plateau", Tangent<D>::Kind::Plateau},
    {"smooth", Tangent<D>::Kind::Smooth},   {"free", Tangent<D>::Kind::Free},
};

template <int D>
constexpr Word<typename Extrapolation<D>::Kind> extrapolations[] = {
    {"hold", Extrapolation<D>::Kind::Hold},
    {"linear", Extrapolation<D>::Kind::Linear},
    {"linearOuter", Extrapolation<D>::Kind::LinearOuter},
    {"slope", Extrapolation<D>::Kind::Slope},
    {"repeat", Extrapolation<D>::Kind::Repeat},
    {"repeatOffset", Extrapolation<D>::Kind::RepeatOffset},
    {"mirror", Extrapolation<D>::Kind::Mirror},
};

template <class Words>
auto find_word(const Words& words, std::string_view text) {
  return std::find_if(std::begin(words), std::end(words),
                      [&](const auto& word) { return word.first == text; });
}

template <class Words>
std::vector<std::string_view> texts_of(const Words& words) {
  std::vector<std::string_view> texts;
  for (const auto& word : words) texts.push_back(word.first);
  return texts;
}

/// Whether the author probably meant a number.
bool looks_like_number(std::string_view text) {
  return !text.empty() && text.find_first_of("+-.0123456789") == 0;
}

std::string unknown_interpolation(std::string_view text) {
  std::vector<std::string_view> candidates = texts_of(interpolations);
  std::vector<std::string> easings;
  for (const auto& ease : eases)
    for (const auto& side : sides) easings.push_back(fmt::format("{}{}", ease.first, side.first));
  candidates.insert(candidates.end(), easings.begin(), easings.end());
  const auto near = nearest_word(text, candidates);
  return fmt::format("unknown word; {}allowed: {}, or one of {} followed by In, Out or InOut",
                     near ? fmt::format("did you mean \"{}\"? ", *near) : "",
                     listed(texts_of(interpolations)), listed(texts_of(eases)));
}

Reading<Interpolation> parse_interpolation(std::string_view text) {
  const std::string_view chosen = trimmed(text);
  if (const auto* found = find_word(interpolations, chosen); found != std::end(interpolations))
    return Interpolation{.kind = found->second};
  for (const auto& ease : eases) {
    if (!chosen.starts_with(ease.first)) continue;
    const auto* side = find_word(sides, chosen.substr(ease.first.size()));
    if (side == std::end(sides)) continue;
    return Interpolation{
        .kind = Interpolation::Kind::Easing, .ease = ease.second, .side = side->second};
  }
  return tl::unexpected(unknown_interpolation(chosen));
}

/// The name of a kind, or a slope.
template <int D>
Reading<Tangent<D>> parse_tangent(std::string_view text, ValueKind kind) {
  const std::string_view chosen = trimmed(text);
  if (const auto* found = find_word(tangents<D>, chosen); found != std::end(tangents<D>))
    return Tangent<D>{.kind = found->second};
  const Reading<Value<D>> slope = parse_value<D>(chosen, kind);
  if (slope) return Tangent<D>{.kind = Tangent<D>::Kind::Slope, .slope = *slope};
  if (looks_like_number(chosen)) return tl::unexpected("as a slope: " + slope.error());
  return tl::unexpected("unknown word" + hint(chosen, texts_of(tangents<D>)) + ", or a slope");
}

/// `hold`, `slope k`, `repeat`, `repeat 3`.
template <int D>
Reading<Extrapolation<D>> parse_extrapolation(std::string_view text, ValueKind kind) {
  using Kind = typename Extrapolation<D>::Kind;
  const std::string_view whole = trimmed(text);
  const std::string_view word = whole.substr(0, whole.find_first_of(blanks));
  const std::string_view rest = trimmed(whole.substr(word.size()));
  const auto* found = find_word(extrapolations<D>, word);
  if (found == std::end(extrapolations<D>))
    return tl::unexpected("unknown word" + hint(word, texts_of(extrapolations<D>)));
  Extrapolation<D> result{.kind = found->second};
  const bool is_loop = result.kind == Kind::Repeat || result.kind == Kind::RepeatOffset ||
                       result.kind == Kind::Mirror;
  if (kind == ValueKind::Boolean && result.kind != Kind::Hold && result.kind != Kind::Repeat &&
      result.kind != Kind::Mirror)
    return tl::unexpected(std::string("a boolean channel allows only hold, repeat and mirror"));
  if (result.kind == Kind::Slope) {
    const Reading<Value<D>> slope = parse_value<D>(rest, kind);
    if (!slope) return tl::unexpected("the slope: " + slope.error());
    result.slope = *slope;
  } else if (is_loop && !rest.empty()) {
    constexpr std::int64_t most = 1LL << 53;  // above it, a double cannot represent every count
    const Reading<std::int64_t> count = parse_integer(rest, 1, most);
    if (!count) return tl::unexpected("the count: " + count.error());
    result.count = static_cast<double>(*count);
  } else if (!rest.empty()) {
    return tl::unexpected(
        fmt::format("{} follows {}, which has no parameter", in_quotes(rest), word));
  }
  return result;
}

template <int D>
Reading<Handle<D>> parse_handle(std::string_view text, ValueKind kind) {
  const std::string_view whole = trimmed(text);
  const std::string_view first = whole.substr(0, whole.find_first_of(blanks));
  const Reading<double> frames = parse_number(first);
  if (!frames) return tl::unexpected("the handle's frames: " + frames.error());
  const Reading<Value<D>> value = parse_value<D>(whole.substr(first.size()), kind);
  if (!value) return tl::unexpected("the handle's value, after its frames: " + value.error());
  return Handle<D>{*frames, *value};
}

/// Four numbers; the two times must be within the segment.
Reading<std::array<double, 4>> parse_control(std::string_view text) {
  std::array<double, 4> control{};
  if (Reading<void> read = parse_numbers(text, control); !read)
    return tl::unexpected("x1 y1 x2 y2: " + read.error());
  for (const double x : {control[0], control[2]})
    if (x < 0 || x > 1) return tl::unexpected(std::string("x1 and x2 must be from 0 to 1"));
  return control;
}

/// A row that stores the result of `parse(text)` in `place`.
template <class Place, class Parse>
Attribute parsed(std::string_view name, Place& place, std::string_view type, std::string_view unit,
                 std::string standard, std::string range, Parse parse) {
  return custom(name, type, unit, std::move(standard), std::move(range),
                [&place, parse](std::string_view text) -> Reading<void> {
                  auto read = parse(text);
                  if (!read) return tl::unexpected(read.error());
                  place = *read;
                  return {};
                });
}

template <int D, class Place>
Attribute value_row(std::string_view name, Place& place, ValueKind kind, std::string standard) {
  return parsed(name, place, "value", "channel's", std::move(standard), "",
                [kind](std::string_view text) { return parse_value<D>(text, kind); });
}

template <int D, class Place>
Attribute tangent_row(std::string_view name, Place& place, ValueKind kind, std::string standard) {
  return parsed(name, place, "tangent", "channel's/frame", std::move(standard), "",
                [kind](std::string_view text) { return parse_tangent<D>(text, kind); });
}

template <int D>
Attribute handle_row(std::string_view name, std::optional<Handle<D>>& place, ValueKind kind) {
  return parsed(name, place, "handle", "frames, channel's", "", "",
                [kind](std::string_view text) { return parse_handle<D>(text, kind); });
}

template <int D>
Attribute extrapolation_row(std::string_view name, Extrapolation<D>& place, ValueKind kind) {
  return parsed(name, place, "extrapolation", "", "hold", "",
                [kind](std::string_view text) { return parse_extrapolation<D>(text, kind); });
}

}  // namespace

template <int D>
Reading<Value<D>> parse_value(std::string_view text, ValueKind kind) {
  Value<D> value{};
  if (kind == ValueKind::Boolean) {
    const Reading<bool> read = parse_boolean(text);
    if (!read) return tl::unexpected(read.error());
    value.fill(*read ? 1 : 0);
    return value;
  }
  if (kind == ValueKind::Widened && words_of(text).size() == 1) {
    const Reading<double> read = parse_number(text);
    if (!read) return tl::unexpected(read.error());
    value.fill(*read);
    return value;
  }
  if (Reading<void> read = parse_numbers(text, value); !read) return tl::unexpected(read.error());
  return value;
}

template <int D>
Table attributes_of(KeyText<D>& key, KeyAxis axis, ValueKind kind) {
  const std::string_view inherited = "its animate's";
  const std::string_view third = "a third of the segment";
  const auto interpolation =
      parsed("interpolation", key.interpolation, "interpolation", "", "", "", parse_interpolation);
  const auto control =
      parsed("control", key.control, "four numbers", "1", "", "x1, x2: 0 to 1", parse_control);
  return {
      required(axis == KeyAxis::Frame ? number("frame", key.frame, "frame")
                                      : number("at", key.frame, "1", a_share)),
      required(value_row<D>("value", key.value, kind, "")),
      if_absent(interpolation, inherited),
      if_absent(number("amplitude", key.amplitude, "channel's", not_negative), "the change"),
      if_absent(number("period", key.period, "frames", not_negative), "0.3 of the segment"),
      if_absent(number("back", key.back, "1"), "1.70158"),
      if_absent(control, "none"),
      if_absent(tangent_row<D>("tangent", key.tangent, kind, ""), inherited),
      if_absent(tangent_row<D>("in", key.in, kind, ""), inherited),
      if_absent(tangent_row<D>("out", key.out, kind, ""), inherited),
      if_absent(number("inLength", key.in_length, "frames"), third),
      if_absent(number("outLength", key.out_length, "frames"), third),
      if_absent(handle_row<D>("inHandle", key.in_handle, kind), "none"),
      if_absent(handle_row<D>("outHandle", key.out_handle, kind), "none"),
      if_absent(value_row<D>("left", key.left, kind, ""), "no jump"),
  };
}

template <int D>
Table attributes_of(AnimateText<D>& animate, KeyAxis axis, ValueKind kind) {
  Table table;
  if (axis == KeyAxis::Frame)  // a <falloff> keeps its end values outside its keys
    table = {
        required(custom("attribute", "word", "", "", "a channel of its element",
                        [](std::string_view) { return Reading<void>(); })),
        extrapolation_row<D>("before", animate.before, kind),
        extrapolation_row<D>("after", animate.after, kind),
    };
  const Table shared = {
      tangent_row<D>("tangent", animate.tangent, kind, "auto"),
      parsed("interpolation", animate.interpolation, "interpolation", "", "bezier", "",
             parse_interpolation),
      choice("overshoot", animate.overshoot,
             {{"limit", Overshoot::Limit},
              {"keepStart", Overshoot::KeepStart},
              {"contain", Overshoot::Contain},
              {"error", Overshoot::Error}}),
  };
  table.insert(table.end(), shared.begin(), shared.end());
  return table;
}

template <int D>
Table attributes_of(Loop<D>& loop, ValueKind kind) {
  constexpr int most_copies = 1'000'000;
  return {
      required(number("from", loop.from, "frame")),
      required(number("to", loop.to, "frame")),
      integer("before", loop.before, "copies", 0, most_copies),
      integer("after", loop.after, "copies", 0, most_copies),
      value_row<D>("offset", loop.offset, kind, "0"),
  };
}

template Reading<Value<1>> parse_value<1>(std::string_view, ValueKind);
template Reading<Value<3>> parse_value<3>(std::string_view, ValueKind);
template Table attributes_of<1>(KeyText<1>&, KeyAxis, ValueKind);
template Table attributes_of<3>(KeyText<3>&, KeyAxis, ValueKind);
template Table attributes_of<1>(AnimateText<1>&, KeyAxis, ValueKind);
template Table attributes_of<3>(AnimateText<3>&, KeyAxis, ValueKind);
template Table attributes_of<1>(Loop<1>&, ValueKind);
template Table attributes_of<3>(Loop<3>&, ValueKind);

}  // namespace pliant::xml
