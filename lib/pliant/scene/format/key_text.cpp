#include "pliant/scene/format/key_text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/format/nearest.hpp"

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

template <int D>
constexpr bool repeats(typename Extrapolation<D>::Kind kind) {
  using Kind = typename Extrapolation<D>::Kind;
  return kind == Kind::Repeat || kind == Kind::RepeatOffset || kind == Kind::Mirror;
}

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
  const std::vector<std::string> words = interpolation_words();
  const std::vector<std::string_view> candidates(words.begin(), words.end());
  const auto near = nearest_word(text, candidates);
  return fmt::format("unknown word; {}allowed: {}, or one of {} followed by In, Out or InOut",
                     near ? fmt::format("did you mean \"{}\"? ", *near) : "",
                     listed(texts_of(interpolations)), listed(texts_of(eases)));
}

Checked<Interpolation> parse_interpolation(std::string_view text) {
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
  return refused(unknown_interpolation(chosen));
}

/// The name of a kind, or a slope.
template <int D>
Checked<Tangent<D>> parse_tangent(std::string_view text, ValueKind kind) {
  const std::string_view chosen = trimmed(text);
  if (const auto* found = find_word(tangents<D>, chosen); found != std::end(tangents<D>))
    return Tangent<D>{.kind = found->second};
  const Checked<Value<D>> slope = parse_value<D>(chosen, kind);
  if (slope) return Tangent<D>{.kind = Tangent<D>::Kind::Slope, .slope = *slope};
  if (looks_like_number(chosen)) return refused("as a slope: " + slope.error().message);
  return refused("unknown word" + hint(chosen, texts_of(tangents<D>)) + ", or a slope");
}

/// `hold`, `slope k`, `repeat`, `repeat 3`.
template <int D>
Checked<Extrapolation<D>> parse_extrapolation(std::string_view text, ValueKind kind) {
  using Kind = typename Extrapolation<D>::Kind;
  const std::string_view whole = trimmed(text);
  const std::string_view word = whole.substr(0, whole.find_first_of(blanks));
  const std::string_view rest = trimmed(whole.substr(word.size()));
  const auto* found = find_word(extrapolations<D>, word);
  if (found == std::end(extrapolations<D>))
    return refused("unknown word" + hint(word, texts_of(extrapolations<D>)));
  Extrapolation<D> result{.kind = found->second};
  const bool is_loop = repeats<D>(result.kind);
  if (kind == ValueKind::Boolean && result.kind != Kind::Hold && result.kind != Kind::Repeat &&
      result.kind != Kind::Mirror)
    return refused("a boolean channel allows only hold, repeat and mirror");
  if (result.kind == Kind::Slope) {
    const Checked<Value<D>> slope = parse_value<D>(rest, kind);
    if (!slope) return refused("the slope: " + slope.error().message);
    result.slope = *slope;
  } else if (is_loop && !rest.empty()) {
    constexpr std::int64_t most = 1LL << 53;  // above it, a double cannot represent every count
    const Checked<std::int64_t> count = parse_integer(rest, 1, most);
    if (!count) return refused("the count: " + count.error().message);
    result.count = static_cast<double>(*count);
  } else if (!rest.empty()) {
    return refused(fmt::format("{} follows {}, which has no parameter", in_quotes(rest), word));
  }
  return result;
}

template <int D>
Checked<Handle<D>> parse_handle(std::string_view text, ValueKind kind) {
  const std::string_view whole = trimmed(text);
  const std::string_view first = whole.substr(0, whole.find_first_of(blanks));
  const Checked<double> frames = parse_number(first);
  if (!frames) return refused("the handle's frames: " + frames.error().message);
  const Checked<Value<D>> value = parse_value<D>(whole.substr(first.size()), kind);
  if (!value) return refused("the handle's value, after its frames: " + value.error().message);
  return Handle<D>{*frames, *value};
}

/// Four numbers; the two times must be within the segment.
Checked<std::array<double, 4>> parse_control(std::string_view text) {
  std::array<double, 4> control{};
  if (Checked<void> read = parse_numbers(text, control); !read)
    return refused("x1 y1 x2 y2: " + read.error().message);
  for (const double x : {control[0], control[2]})
    if (x < 0 || x > 1) return refused("x1 and x2 must be from 0 to 1");
  return control;
}

/// The text of each value that the functions above read.
template <class Words, class E>
std::string word_of(const Words& words, E value) {
  for (const auto& word : words)
    if (word.second == value) return std::string(word.first);
  return "";
}

std::string control_text(const std::array<double, 4>& control) {
  return fmt::format("{}", fmt::join(control, " "));
}

template <int D>
std::string handle_text(const Handle<D>& handle, ValueKind kind) {
  return fmt::format("{} {}", handle.frames, value_text<D>(handle.value, kind));
}

/// A slot that reads its place by `parse(text)` and writes it by `write(value)`.
template <class T, class Parse, class Write>
Slot written(const Attribute& attribute, T& place, std::string_view type, std::string_view range,
             Parse parse, Write write) {
  return custom(
      attribute, type, range,
      [&place, parse](std::string_view text) -> Checked<void> {
        auto read = parse(text);
        if (!read) return tl::unexpected(read.error());
        place = *read;
        return {};
      },
      std::string(write(place)));
}

/// An absent value has no text.
template <class Write>
auto if_present(Write write) {
  return [write](const auto& place) { return place ? write(*place) : std::string(); };
}

/// The slots of the keys of a curve with D components.
template <int D>
struct KeySlots {
  ValueKind kind;

  Slot slot_of(const Attribute& attribute, Value<D>& place) const {
    return written(attribute, place, "value", "", parse(parse_value<D>), write(value_text<D>));
  }
  Slot slot_of(const Attribute& attribute, std::optional<Value<D>>& place) const {
    return written(attribute, place, "value", "", parse(parse_value<D>),
                   if_present(write(value_text<D>)));
  }
  Slot slot_of(const Attribute& attribute, Tangent<D>& place) const {
    return written(attribute, place, "tangent", "", parse(parse_tangent<D>), text());
  }
  Slot slot_of(const Attribute& attribute, std::optional<Tangent<D>>& place) const {
    return written(attribute, place, "tangent", "", parse(parse_tangent<D>), if_present(text()));
  }
  Slot slot_of(const Attribute& attribute, Extrapolation<D>& place) const {
    return written(attribute, place, "extrapolation", "", parse(parse_extrapolation<D>), text());
  }
  Slot slot_of(const Attribute& attribute, std::optional<Handle<D>>& place) const {
    return written(attribute, place, "handle", "", parse(parse_handle<D>),
                   if_present(write(handle_text<D>)));
  }

 private:
  template <class Parse>
  auto parse(Parse parse_text) const {
    return [parse_text, kind = kind](std::string_view text) { return parse_text(text, kind); };
  }
  template <class Write>
  auto write(Write write_value) const {
    return [write_value, kind = kind](const auto& value) { return write_value(value, kind); };
  }
  auto text() const {
    return [kind = kind](const auto& value) { return text_of(value, kind); };
  }
};

Slot interpolation_slot(const Attribute& attribute, Interpolation& place) {
  return written(attribute, place, "interpolation", "", parse_interpolation,
                 [](const Interpolation& value) { return text_of(value); });
}

Slot interpolation_slot(const Attribute& attribute, std::optional<Interpolation>& place) {
  return written(attribute, place, "interpolation", "", parse_interpolation,
                 if_present([](const Interpolation& value) { return text_of(value); }));
}

constexpr std::string_view overshoot_words[] = {"limit", "keepStart", "contain", "error"};

}  // namespace

std::vector<std::string> interpolation_words() {
  std::vector<std::string> words;
  for (const auto& word : interpolations) words.emplace_back(word.first);
  for (const auto& ease : eases)
    for (const auto& side : sides) words.push_back(fmt::format("{}{}", ease.first, side.first));
  return words;
}

std::vector<std::string> tangent_words() {
  const std::vector<std::string_view> words = texts_of(tangents<1>);
  return {words.begin(), words.end()};
}

ExtrapolationWords extrapolation_words() {
  ExtrapolationWords words;
  for (const auto& [word, kind] : extrapolations<1>) {
    const bool is_slope = kind == Extrapolation<1>::Kind::Slope;
    (is_slope ? words.slopes : repeats<1>(kind) ? words.loops : words.plain).emplace_back(word);
  }
  return words;
}

template <int D>
Checked<Value<D>> parse_value(std::string_view text, ValueKind kind) {
  Value<D> value{};
  if (kind == ValueKind::Boolean) {
    const Checked<bool> read = parse_boolean(text);
    if (!read) return tl::unexpected(read.error());
    value.fill(*read ? 1 : 0);
    return value;
  }
  if (kind == ValueKind::Widened && words_of(text).size() == 1) {
    const Checked<double> read = parse_number(text);
    if (!read) return tl::unexpected(read.error());
    value.fill(*read);
    return value;
  }
  if (Checked<void> read = parse_numbers(text, value); !read) return tl::unexpected(read.error());
  return value;
}

template <int D>
std::string value_text(const Value<D>& value, ValueKind kind) {
  if (kind == ValueKind::Boolean) return value[0] != 0 ? "true" : "false";
  return fmt::format("{}", fmt::join(value, " "));
}

std::string text_of(const Interpolation& interpolation) {
  if (interpolation.kind != Interpolation::Kind::Easing)
    return word_of(interpolations, interpolation.kind);
  return word_of(eases, interpolation.ease) + word_of(sides, interpolation.side);
}

template <int D>
std::string text_of(const Tangent<D>& tangent, ValueKind kind) {
  using Kind = typename Tangent<D>::Kind;
  return tangent.kind == Kind::Slope ? value_text<D>(tangent.slope, kind)
                                     : word_of(tangents<D>, tangent.kind);
}

template <int D>
std::string text_of(const Extrapolation<D>& extrapolation, ValueKind kind) {
  std::string text = word_of(extrapolations<D>, extrapolation.kind);
  if (extrapolation.kind == Extrapolation<D>::Kind::Slope)
    text += ' ' + value_text<D>(extrapolation.slope, kind);
  if (extrapolation.count) text += fmt::format(" {:.0f}", *extrapolation.count);
  return text;
}

template <int D>
Table table_of(KeyText<D>& key, KeyAxis axis, ValueKind kind) {
  constexpr std::string_view inherited = "its animate's";
  constexpr std::string_view third = "a third of the segment";
  constexpr std::string_view slope = "channel's/frame";
  const KeySlots<D> of{kind};
  return {
      axis == KeyAxis::Frame ? slot({.name = "frame",
                                     .meaning = "later than the key before; need not be whole",
                                     .unit = "frame",
                                     .need = Need::Required},
                                    &key.frame)
                             : slot({.name = "at",
                                     .meaning = "in a `<falloff>`, instead of `frame`",
                                     .unit = "1",
                                     .range = a_share,
                                     .need = Need::Required},
                                    &key.frame),
      of.slot_of({.name = "value",
                  .meaning = "value at that frame; where the curve jumps, the value after the jump",
                  .unit = "channel's",
                  .need = Need::Required},
                 key.value),
      interpolation_slot({.name = "interpolation",
                          .meaning = "interpolation to the next key",
                          .absent = inherited},
                         key.interpolation),
      slot({.name = "amplitude",
            .meaning = "amplitude of `elastic…`",
            .unit = "channel's",
            .range = not_negative,
            .absent = "the change"},
           &key.amplitude),
      slot({.name = "period",
            .meaning = "period of `elastic…`; 0 counts as absent",
            .unit = "frames",
            .range = not_negative,
            .absent = "0.3 of the segment"},
           &key.period),
      slot({.name = "back",
            .meaning = "overshoot of `back…` beyond its ends",
            .unit = "1",
            .absent = "1.70158"},
           &key.back),
      written({.name = "control",
               .meaning = "`x1 y1 x2 y2` of `cubicBezier`, as in CSS",
               .unit = "1",
               .absent = "none"},
              key.control, "four numbers", "x1, x2: 0 to 1", parse_control,
              if_present(control_text)),
      of.slot_of({.name = "tangent",
                  .meaning = "both sides; instead of the four below",
                  .unit = slope,
                  .absent = inherited},
                 key.tangent),
      of.slot_of({.name = "in",
                  .meaning = "the tangent before the key",
                  .unit = slope,
                  .absent = inherited},
                 key.in),
      of.slot_of({.name = "out",
                  .meaning = "the tangent after the key",
                  .unit = slope,
                  .absent = inherited},
                 key.out),
      slot({.name = "inLength",
            .meaning = "length of `in`; a negative one counts as 0, with a note",
            .unit = "frames",
            .absent = third},
           &key.in_length),
      slot({.name = "outLength",
            .meaning = "length of `out`; likewise",
            .unit = "frames",
            .absent = third},
           &key.out_length),
      of.slot_of({.name = "inHandle",
                  .meaning = "instead of `in` and `inLength`: `frames value`, from the key, "
                             "frames ≤ 0",
                  .unit = "frames, channel's",
                  .absent = "none"},
                 key.in_handle),
      of.slot_of({.name = "outHandle",
                  .meaning = "instead of `out` and `outLength`: likewise, frames ≥ 0",
                  .unit = "frames, channel's",
                  .absent = "none"},
                 key.out_handle),
      of.slot_of({.name = "left",
                  .meaning = "value before the jump, if the curve jumps at this key",
                  .unit = "channel's",
                  .absent = "no jump"},
                 key.left),
  };
}

template <int D>
Table table_of(AnimateText<D>& animate, KeyAxis axis, ValueKind kind) {
  const bool is_falloff = axis == KeyAxis::Falloff;
  const KeySlots<D> of{kind};
  Table table;
  if (!is_falloff)  // a <falloff> keeps its end values outside its keys
    table = {
        custom(
            {.name = "attribute", .meaning = "the channel", .need = Need::Required}, "word",
            "a channel of its element", [](std::string_view) { return Checked<void>(); }, ""),
        of.slot_of({.name = "before", .meaning = "values before the first key"}, animate.before),
        of.slot_of({.name = "after", .meaning = "values after the last key"}, animate.after),
    };
  const Table shared = {
      of.slot_of({.name = "tangent",
                  .meaning = is_falloff ? "default of its keys; slopes are per unit of s"
                                        : "default of its keys",
                  .unit = "channel's/frame"},
                 animate.tangent),
      interpolation_slot({.name = "interpolation", .meaning = "default of its keys"},
                         animate.interpolation),
      slot({.name = "overshoot",
            .meaning = is_falloff ? "correction of tangents that would make s run backwards"
                                  : "correction of tangents that would make time run backwards",
            .words = overshoot_words},
           choice(animate.overshoot)),
  };
  table.insert(table.end(), shared.begin(), shared.end());
  return table;
}

template <int D>
Table table_of(Loop<D>& loop, ValueKind kind) {
  constexpr Range copies{.least = 0, .most = 1'000'000};
  const KeySlots<D> of{kind};
  return {
      slot({.name = "from",
            .meaning = "first key of the repeated part",
            .unit = "frame",
            .need = Need::Required},
           &loop.from),
      slot({.name = "to",
            .meaning = "end of the repeated part, after `from`",
            .unit = "frame",
            .need = Need::Required},
           &loop.to),
      slot({.name = "before", .meaning = "copies before it", .unit = "copies", .range = copies},
           &loop.before),
      slot({.name = "after", .meaning = "copies after it", .unit = "copies", .range = copies},
           &loop.after),
      of.slot_of({.name = "offset",
                  .meaning = "added to each copy relative to the one before",
                  .unit = "channel's"},
                 loop.offset),
  };
}

template Checked<Value<1>> parse_value<1>(std::string_view, ValueKind);
template Checked<Value<3>> parse_value<3>(std::string_view, ValueKind);
template std::string value_text<1>(const Value<1>&, ValueKind);
template std::string value_text<3>(const Value<3>&, ValueKind);
template std::string text_of(const Tangent<1>&, ValueKind);
template std::string text_of(const Tangent<3>&, ValueKind);
template std::string text_of(const Extrapolation<1>&, ValueKind);
template std::string text_of(const Extrapolation<3>&, ValueKind);
template Table table_of<1>(KeyText<1>&, KeyAxis, ValueKind);
template Table table_of<3>(KeyText<3>&, KeyAxis, ValueKind);
template Table table_of<1>(AnimateText<1>&, KeyAxis, ValueKind);
template Table table_of<3>(AnimateText<3>&, KeyAxis, ValueKind);
template Table table_of<1>(Loop<1>&, ValueKind);
template Table table_of<3>(Loop<3>&, ValueKind);

}  // namespace pliant::xml
