#include "pliant/scene/attribute.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "pliant/scene/check.hpp"
#include "pliant/scene/nearest.hpp"

namespace pliant::xml {
namespace {

std::string to_text(std::span<const double> numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

template <int D>
std::string constant_text(const Channel<D>& channel) {
  return to_text(channel.at(0));
}

/// Reads D numbers within `range` and passes them to `take`.
template <int D, class Take>
std::function<Reading<void>(std::string_view)> reading_values(Range range, Take take) {
  return [range, take](std::string_view text) -> Reading<void> {
    Value<D> value{};
    if (Reading<void> read = parse_numbers(text, value); !read) return read;
    if (Reading<void> accepted = range.accept(value); !accepted) return accepted;
    take(value);
    return {};
  };
}

template <int D>
constexpr std::string_view type_of = D == 1 ? "number" : "vector";

/// Makes the row a channel, so that an <animate> may name it.
Attribute keyable(Attribute row, ChannelPlace place) {
  row.format.is_keyable = true;
  row.channel = place;
  return row;
}

template <int D, class Place>
Attribute channel_row(std::string_view name, Place& place, std::string_view unit, Range range,
                      std::string standard) {
  const auto take = [&place](Value<D> value) { place = Channel<D>(value); };
  return keyable(custom(name, type_of<D>, unit, std::move(standard), range.to_text(),
                        reading_values<D>(range, take)),
                 &place);
}

/// A tangent: one number for all of x, y, z, or three numbers.
Reading<void> read_tangent(std::string_view text, TangentChannel& place) {
  if (words_of(text).size() == 1) {
    const Reading<double> number = parse_number(text);
    if (!number) return tl::unexpected(number.error());
    place = Channel<1>(*number);
    return {};
  }
  Value<3> vector{};
  if (Reading<void> read = parse_numbers(text, vector); !read)
    return words_of(text).size() == 3
               ? read
               : tl::unexpected(std::string("one or three numbers are required"));
  place = Channel<3>(vector);
  return {};
}

template <class Place>
Attribute boolean_row(std::string_view name, Place& place, bool standard) {
  return custom(name, "boolean", "", standard ? "true" : "false", "",
                [&place](std::string_view text) -> Reading<void> {
                  const Reading<bool> value = parse_boolean(text);
                  if (!value) return tl::unexpected(value.error());
                  place = *value;
                  return {};
                });
}

template <class Place>
Attribute integer_row(std::string_view name, Place& place, std::string_view unit,
                      std::int64_t least, std::int64_t most, std::string standard) {
  return custom(name, "integer", unit, std::move(standard), fmt::format("{} to {}", least, most),
                [&place, least, most](std::string_view text) -> Reading<void> {
                  const Reading<std::int64_t> number = parse_integer(text, least, most);
                  if (!number) return tl::unexpected(number.error());
                  place = static_cast<int>(*number);
                  return {};
                });
}

}  // namespace

Reading<void> Range::accept(std::span<const double> numbers) const {
  const std::string_view each = numbers.size() > 1 ? "each number must" : "must";
  const auto any = [&](auto&& fails) { return std::any_of(numbers.begin(), numbers.end(), fails); };
  if (any([&](double x) { return excludes_least ? x <= least : x < least; }))
    return tl::unexpected(
        fmt::format("{} be {} {}", each, excludes_least ? "greater than" : "at least", least));
  if (any([&](double x) { return x > most; }))
    return tl::unexpected(fmt::format("{} be at most {}", each, most));
  if (excludes_zero && any([](double x) { return x == 0; }))
    return tl::unexpected(fmt::format("{} differ from 0", each));
  return {};
}

std::string Range::to_text() const {
  const bool is_bounded_below = least > -std::numeric_limits<double>::infinity();
  const bool is_bounded_above = most < std::numeric_limits<double>::infinity();
  if (is_bounded_below && is_bounded_above) return fmt::format("{} to {}", least, most);
  if (is_bounded_below) return fmt::format("{} {}", excludes_least ? ">" : "≥", least);
  return excludes_zero ? "≠ 0" : "";
}

Attribute channel(std::string_view name, Channel<1>& place, std::string_view unit, Range range) {
  return channel_row<1>(name, place, unit, range, constant_text(place));
}

Attribute channel(std::string_view name, Channel<3>& place, std::string_view unit, Range range) {
  return channel_row<3>(name, place, unit, range, constant_text(place));
}

Attribute channel(std::string_view name, std::optional<Channel<3>>& place, std::string_view unit) {
  return channel_row<3>(name, place, unit, any_number, place ? constant_text(*place) : "");
}

Attribute channel(std::string_view name, PositionChannel& place, std::string_view unit) {
  return channel_row<3>(name, place, unit, any_number, constant_text(*place.channel()));
}

Attribute channel(std::string_view name, TangentChannel& place, std::string_view unit) {
  std::string standard = std::visit([](const auto& held) { return constant_text(held); }, place);
  return keyable(custom(name, "number or vector", unit, std::move(standard), "",
                        [&place](std::string_view text) { return read_tangent(text, place); }),
                 &place);
}

Attribute channel(std::string_view name, Switch& place) {
  return keyable(boolean_row(name, place, place.at(0)), &place);
}

Attribute number(std::string_view name, double& place, std::string_view unit, Range range) {
  return custom(name, "number", unit, to_text({&place, 1}), range.to_text(),
                reading_values<1>(range, [&place](Value<1> value) { place = value[0]; }));
}

Attribute number(std::string_view name, std::optional<double>& place, std::string_view unit,
                 Range range) {
  return custom(name, "number", unit, place ? to_text({&*place, 1}) : "", range.to_text(),
                reading_values<1>(range, [&place](Value<1> value) { place = value[0]; }));
}

Attribute integer(std::string_view name, int& place, std::string_view unit, std::int64_t least,
                  std::int64_t most) {
  return integer_row(name, place, unit, least, most, std::to_string(place));
}

Attribute integer(std::string_view name, std::optional<int>& place, std::string_view unit,
                  std::int64_t least, std::int64_t most) {
  return integer_row(name, place, unit, least, most, place ? std::to_string(*place) : "");
}

Attribute boolean(std::string_view name, bool& place) { return boolean_row(name, place, place); }

Attribute name_of(std::string& place) {
  return required(custom("name", "name", "", "", "unique", [&place](std::string_view text) {
    if (!is_name(text))
      return Reading<void>(tl::unexpected(
          std::string("must be a letter or _ followed by letters, digits, _ and -")));
    place = text;
    return Reading<void>();
  }));
}

Attribute names(std::string_view name, std::vector<std::string>& place) {
  return custom(name, "names", "", "", "", [&place](std::string_view text) -> Reading<void> {
    const std::vector<std::string_view> words = words_of(text);
    if (words.empty())
      return tl::unexpected(std::string("is empty; leave the attribute out for all"));
    for (auto word = words.begin(); word != words.end(); ++word) {
      if (!is_name(*word))
        return tl::unexpected(in_quotes(*word) + " is not a name (names are separated by spaces)");
      if (std::find(words.begin(), word, *word) != word)
        return tl::unexpected(in_quotes(*word) + " is given twice");
    }
    place.assign(words.begin(), words.end());
    return {};
  });
}

Attribute custom(std::string_view name, std::string_view type, std::string_view unit,
                 std::string standard, std::string range,
                 std::function<Reading<void>(std::string_view)> read) {
  return {.format = {.name = name,
                     .type = type,
                     .unit = std::string(unit),
                     .standard = std::move(standard),
                     .range = std::move(range)},
          .read = std::move(read)};
}

Attribute word(std::string_view name, std::vector<std::string_view> words,
               std::vector<std::string_view> later, std::string_view standard,
               std::function<void(std::size_t)> take) {
  std::string range = listed(words);
  return custom(name, "word", "", std::string(standard), std::move(range),
                [words = std::move(words), later = std::move(later),
                 take = std::move(take)](std::string_view text) -> Reading<void> {
                  const std::string_view chosen = trimmed(text);
                  if (const auto found = std::find(words.begin(), words.end(), chosen);
                      found != words.end()) {
                    take(found - words.begin());
                    return {};
                  }
                  if (std::find(later.begin(), later.end(), chosen) != later.end())
                    return tl::unexpected(not_supported() + "; allowed: " + listed(words));
                  return tl::unexpected("unknown word" + hint(chosen, words));
                });
}

Attribute fixed(std::string_view name, std::string_view only, std::vector<std::string_view> later) {
  return word(name, {only}, std::move(later), only, [](std::size_t) {});
}

Attribute later(std::string_view name) {
  return {.format = {.name = name, .type = "", .need = Need::Later},
          .read = [](std::string_view) { return Reading<void>(); }};
}

Attribute required(Attribute attribute) {
  attribute.format.need = Need::Required;
  attribute.format.standard.clear();
  return attribute;
}

Attribute if_absent(Attribute attribute, std::string_view meaning) {
  attribute.format.standard = fmt::format("({})", meaning);
  return attribute;
}

std::string not_supported() { return "is not supported by this version of pliant"; }

}  // namespace pliant::xml
