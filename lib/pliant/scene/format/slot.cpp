#include "pliant/scene/format/slot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <unordered_set>

#include <fmt/format.h>

#include "pliant/scene/format/nearest.hpp"

namespace pliant::xml {
namespace {

std::string to_text(std::span<const double> numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

/// The type of a value in the tables of docs/scene-format.md.
struct TypeName {
  const Attribute& attribute;

  std::string_view operator()(std::monostate) const {
    if (attribute.syntax == Syntax::Version) return "integer";
    return attribute.need == Need::Later ? "" : "word";
  }
  std::string_view operator()(const double*) const {
    return attribute.syntax == Syntax::Rate ? "rate" : "number";
  }
  std::string_view operator()(const int*) const { return "integer"; }
  std::string_view operator()(const std::uint64_t*) const { return "integer"; }
  std::string_view operator()(const bool*) const { return "boolean"; }
  std::string_view operator()(const Choice&) const { return "word"; }
  std::string_view operator()(const std::string*) const {
    if (attribute.syntax == Syntax::Name) return "name";
    return attribute.syntax == Syntax::Path ? "path" : "text";
  }
  std::string_view operator()(const std::vector<std::string>*) const { return "names"; }
  std::string_view operator()(const std::vector<int>*) const { return "integers"; }
  std::string_view operator()(const Value<2>*) const { return "one or two numbers"; }
  std::string_view operator()(const Value<3>*) const { return "vector"; }
  std::string_view operator()(const Channel<1>*) const { return "number"; }
  std::string_view operator()(const Channel<3>*) const { return "vector"; }
  std::string_view operator()(const PositionChannel*) const { return "vector"; }
  std::string_view operator()(const TangentChannel*) const { return "number or vector"; }
  std::string_view operator()(const Switch*) const { return "boolean"; }
  std::string_view operator()(const Edges*) const { return "one or four words"; }
  template <class T>
  std::string_view operator()(const std::optional<T>*) const {
    return (*this)(static_cast<const T*>(nullptr));
  }
};

/// The numbers that a value may be, in the tables of docs/scene-format.md.
struct RangeText {
  const Attribute& attribute;

  std::string operator()(std::monostate) const {
    if (attribute.syntax == Syntax::Version) return "1";
    if (attribute.syntax == Syntax::Position) return "a position of its element";
    return listed(attribute.words);
  }
  std::string operator()(const std::uint64_t*) const {
    return fmt::format("0 to {}", std::numeric_limits<std::uint64_t>::max());
  }
  std::string operator()(const Choice&) const { return listed(attribute.words); }
  std::string operator()(const Edges*) const { return listed(attribute.words); }
  std::string operator()(const std::string*) const {
    return attribute.syntax == Syntax::Name ? "unique" : "";
  }
  template <class T>
  std::string operator()(const std::optional<T>*) const {
    return (*this)(static_cast<const T*>(nullptr));
  }
  template <class T>
  std::string operator()(const T*) const {
    return attribute.range.to_text();
  }
};

/// The text of a constant value; empty: none.
struct ValueText {
  const Attribute& attribute;

  std::string operator()(std::monostate) const {
    if (attribute.syntax == Syntax::Version) return "1";
    return attribute.words.empty() ? "" : std::string(attribute.words.front());
  }
  std::string operator()(const double* place) const { return to_text({place, 1}); }
  std::string operator()(const int* place) const { return std::to_string(*place); }
  std::string operator()(const std::uint64_t* place) const { return std::to_string(*place); }
  std::string operator()(const bool* place) const { return *place ? "true" : "false"; }
  std::string operator()(const Choice& choice) const {
    const int value = choice.get(choice.place);
    return value < 0 ? "" : std::string(attribute.words[static_cast<std::size_t>(value)]);
  }
  std::string operator()(const std::string* place) const { return *place; }
  std::string operator()(const std::vector<std::string>* place) const {
    return fmt::format("{}", fmt::join(*place, " "));
  }
  std::string operator()(const std::vector<int>* place) const {
    return fmt::format("{}", fmt::join(*place, " "));
  }
  std::string operator()(const Value<2>* place) const {
    return to_text(std::span(*place).first((*place)[0] == (*place)[1] ? 1 : 2));
  }
  std::string operator()(const Value<3>* place) const { return to_text(*place); }
  std::string operator()(const PositionChannel* place) const {
    return place->channel() ? (*this)(place->channel()) : std::string();
  }
  std::string operator()(const TangentChannel* place) const {
    return std::visit([this](const auto& channel) { return (*this)(&channel); }, *place);
  }
  std::string operator()(const Switch* place) const {
    if (place->channel().is_animated()) return "";
    return place->at(0) ? "true" : "false";
  }
  std::string operator()(const Edges* place) const {
    const auto& [u0, u1, v0, v1] = *place;
    const auto word = [this](Edge edge) { return attribute.words[static_cast<std::size_t>(edge)]; };
    if (u0 == u1 && u1 == v0 && v0 == v1) return std::string(word(u0));
    return fmt::format("{} {} {} {}", word(u0), word(u1), word(v0), word(v1));
  }
  template <int D>
  std::string operator()(const Channel<D>* place) const {
    return place->is_animated() ? std::string() : to_text(place->at(0));
  }
  template <class T>
  std::string operator()(const std::optional<T>* place) const {
    return *place ? (*this)(&**place) : std::string();
  }
};

Checked<void> broken(const Range& range, std::span<const double> numbers) {
  if (auto rule = range.broken_rule(numbers)) return refused(*std::move(rule));
  return {};
}

/// Stores the value of a text in the place, or complains.
struct ReadValue {
  const Attribute& attribute;
  std::string_view text;

  Checked<void> operator()(std::monostate) const {
    if (attribute.syntax == Syntax::Version) return read_version();
    if (attribute.words.empty()) return {};
    const Checked<int> chosen = read_word(trimmed(text));
    return chosen ? Checked<void>() : tl::unexpected(chosen.error());
  }
  Checked<void> operator()(double* place) const {
    const Checked<double> number =
        attribute.syntax == Syntax::Rate ? parse_rate(text) : parse_number(text);
    if (!number) return tl::unexpected(number.error());
    return store(*number, *place);
  }
  Checked<void> operator()(int* place) const {
    constexpr auto least = std::int64_t{std::numeric_limits<int>::min()};
    constexpr auto most = std::int64_t{std::numeric_limits<int>::max()};
    const Range& range = attribute.range;
    const auto bound = [](double wanted, std::int64_t otherwise) {
      return std::isfinite(wanted) ? static_cast<std::int64_t>(wanted) : otherwise;
    };
    const Checked<std::int64_t> number =
        parse_integer(text, bound(range.least, least), bound(range.most, most));
    if (!number) return tl::unexpected(number.error());
    *place = static_cast<int>(*number);
    return {};
  }
  Checked<void> operator()(std::uint64_t* place) const {
    const Checked<std::uint64_t> number = parse_natural(text);
    if (!number) return tl::unexpected(number.error());
    *place = *number;
    return {};
  }
  Checked<void> operator()(bool* place) const {
    const Checked<bool> value = parse_boolean(text);
    if (!value) return tl::unexpected(value.error());
    *place = *value;
    return {};
  }
  Checked<void> operator()(const Choice& choice) const {
    const Checked<int> chosen = read_word(trimmed(text));
    if (!chosen) return tl::unexpected(chosen.error());
    choice.set(choice.place, *chosen);
    return {};
  }
  Checked<void> operator()(std::string* place) const {
    if (attribute.syntax == Syntax::Name && text.size() > longest_object_name)
      return refused(fmt::format("is longer than {} characters", longest_object_name));
    if (attribute.syntax == Syntax::Name && !is_name(text))
      return refused("must be a letter or _ followed by letters, digits, _ and -");
    if (attribute.syntax == Syntax::Path && trimmed(text).empty())
      return refused("is empty; the name of a file is required");
    if (text.empty())
      return refused(fmt::format("is empty; leave the attribute out for {}", attribute.absent));
    *place = text;
    return {};
  }
  Checked<void> operator()(std::vector<std::string>* place) const {
    const std::vector<std::string_view> words = words_of(text);
    if (words.empty())
      return refused(fmt::format("is empty; leave the attribute out for {}", attribute.absent));
    std::unordered_set<std::string_view> seen;
    for (const std::string_view word : words) {
      if (!is_name(word))
        return refused(in_quotes(word) + " is not a name (names are separated by spaces)");
      if (!seen.insert(word).second) return refused(in_quotes(word) + " is given twice");
    }
    place->assign(words.begin(), words.end());
    return {};
  }
  Checked<void> operator()(std::vector<int>* place) const {
    std::vector<int> numbers;
    for (const std::string_view word : words_of(text)) {
      if (Checked<void> read = ReadValue{attribute, word}(&numbers.emplace_back()); !read)
        return refused(fmt::format("{}: {}", in_quotes(word), read.error().message));
    }
    if (numbers.empty())
      return refused(fmt::format("is empty; leave the attribute out for {}", attribute.absent));
    *place = std::move(numbers);
    return {};
  }
  /// One number for both, or two.
  Checked<void> operator()(Value<2>* place) const {
    const std::size_t count = words_of(text).size();
    if (count != 1 && count != 2) return refused("one or two numbers are required");
    Value<1> one{};
    Checked<void> read = count == 1 ? parse_numbers(text, one) : parse_numbers(text, *place);
    if (!read) return read;
    if (count == 1) place->fill(one[0]);
    return broken(attribute.range, *place);
  }
  Checked<void> operator()(Value<3>* place) const { return read_numbers(*place); }
  Checked<void> operator()(Channel<1>* place) const { return read_numbers<1>(*place); }
  Checked<void> operator()(Channel<3>* place) const { return read_numbers<3>(*place); }
  Checked<void> operator()(PositionChannel* place) const { return read_numbers<3>(*place); }
  /// One number for all of x, y, z, or three numbers.
  Checked<void> operator()(TangentChannel* place) const {
    const std::size_t count = words_of(text).size();
    if (count != 1 && count != 3) return refused("one or three numbers are required");
    return count == 1 ? read_numbers<1>(*place) : read_numbers<3>(*place);
  }
  /// One word for all edges, or four.
  Checked<void> operator()(Edges* place) const {
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() != 1 && words.size() != 4) return refused("one or four words are required");
    Edges edges;
    Edge* const all[] = {&edges.u0, &edges.u1, &edges.v0, &edges.v1};
    for (std::size_t k = 0; k < 4; ++k) {
      const Checked<int> chosen = read_word(words[words.size() == 1 ? 0 : k]);
      if (!chosen) return tl::unexpected(chosen.error());
      *all[k] = static_cast<Edge>(*chosen);
    }
    *place = edges;
    return {};
  }
  Checked<void> operator()(Switch* place) const {
    bool value = false;
    if (Checked<void> read = (*this)(&value); !read) return read;
    *place = value;
    return {};
  }
  template <class T>
  Checked<void> operator()(std::optional<T>* place) const {
    T value{};
    if (Checked<void> read = (*this)(&value); !read) return read;
    *place = std::move(value);
    return {};
  }

 private:
  /// The format has one version so far; any other is a problem, not read as this one.
  Checked<void> read_version() const {
    const Checked<std::int64_t> number = parse_integer(text, 1, std::numeric_limits<int>::max());
    if (!number) return tl::unexpected(number.error());
    if (*number != 1) return refused(not_supported() + ", which reads version 1");
    return {};
  }

  Checked<int> read_word(std::string_view chosen) const {
    const auto words = attribute.words;
    if (const auto found = std::find(words.begin(), words.end(), chosen); found != words.end())
      return static_cast<int>(found - words.begin());
    const auto later = attribute.later;
    if (std::find(later.begin(), later.end(), chosen) != later.end())
      return refused(not_supported(attribute.instead) + "; allowed: " + listed(words));
    return refused("unknown word" + hint(chosen, words));
  }

  Checked<void> store(double number, double& place) const {
    if (Checked<void> checked = broken(attribute.range, {&number, 1}); !checked) return checked;
    place = number;
    return {};
  }

  /// D numbers within the range, stored as a `Value<D>` in a place that takes one.
  template <int D>
  Checked<void> read_numbers(auto& place) const {
    Value<D> value{};
    if (Checked<void> read = parse_numbers(text, value); !read) return read;
    if (Checked<void> checked = broken(attribute.range, value); !checked) return checked;
    place = Channel<D>(value);
    return {};
  }
  Checked<void> read_numbers(Value<3>& place) const {
    Value<3> value{};
    if (Checked<void> read = parse_numbers(text, value); !read) return read;
    place = value;
    return {};
  }
};

}  // namespace

bool is_channel(const Place& place) {
  return std::holds_alternative<Channel<1>*>(place) || std::holds_alternative<Channel<3>*>(place) ||
         std::holds_alternative<std::optional<Channel<1>>*>(place) ||
         std::holds_alternative<std::optional<Channel<3>>*>(place) ||
         std::holds_alternative<PositionChannel*>(place) ||
         std::holds_alternative<TangentChannel*>(place) || std::holds_alternative<Switch*>(place);
}

Slot slot(const Attribute& attribute, Place place) {
  return {.attribute = attribute,
          .type = std::string(std::visit(TypeName{attribute}, place)),
          .range = std::visit(RangeText{attribute}, place),
          .text = std::visit(ValueText{attribute}, place),
          .read =
              [attribute, place](std::string_view text) {
                return std::visit(ReadValue{attribute, text}, place);
              },
          .place = place};
}

Slot custom(const Attribute& attribute, std::string_view type, std::string_view range,
            std::function<Checked<void>(std::string_view)> read, std::string text) {
  return {.attribute = attribute,
          .type = std::string(type),
          .range = std::string(range),
          .text = std::move(text),
          .read = std::move(read)};
}

Slot* find(std::span<Slot> table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Slot& row) { return row.attribute.name == name; });
  return found != table.end() ? &*found : nullptr;
}

AttributeFormat format_of(const Slot& slot) {
  const Attribute& attribute = slot.attribute;
  std::string standard =
      attribute.absent.empty() ? slot.text : fmt::format("({})", attribute.absent);
  if (attribute.need == Need::Required) standard.clear();
  return {.name = attribute.name,
          .type = slot.type,
          .unit = std::string(attribute.unit),
          .standard = std::move(standard),
          .text = slot.text,
          .range = slot.range,
          .meaning = std::string(attribute.meaning),
          .need = attribute.need,
          .is_keyable = is_channel(slot.place),
          .is_position = std::holds_alternative<PositionChannel*>(slot.place),
          .names_surfaces = attribute.syntax == Syntax::Surface,
          .limits = attribute.range,
          .words = attribute.words};
}

std::string not_supported(std::string_view instead) {
  return fmt::format("is not supported by this version of pliant{}{}", instead.empty() ? "" : "; ",
                     instead);
}

}  // namespace pliant::xml
