#include "pliant/scene/format/schema_types.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/scene/format/key_text.hpp"

namespace pliant::xml {
namespace {

// Regular expressions of the values that the reader accepts.
constexpr std::string_view number_text = R"(-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?)";
constexpr std::string_view positive_text =
    R"((0*[1-9][0-9]*(\.[0-9]*)?|0*\.0*[1-9][0-9]*)([eE][+\-]?[0-9]+)?)";
constexpr std::string_view name_text = R"([A-Za-z_][A-Za-z0-9_\-]*)";

std::string restriction(std::string_view base, std::string_view facets) {
  return facets.empty()
             ? fmt::format("<xs:restriction base=\"{}\"/>", base)
             : fmt::format("<xs:restriction base=\"{}\">{}</xs:restriction>", base, facets);
}

std::string pattern(std::string_view expression) {
  return fmt::format("<xs:pattern value=\"{}\"/>", xml_text(expression));
}

std::string inner(std::string_view body) {
  return fmt::format("<xs:simpleType>{}</xs:simpleType>", body);
}

std::string list_of(std::string_view item, std::string_view facets) {
  return fmt::format("<xs:restriction>{}{}</xs:restriction>",
                     inner(fmt::format("<xs:list>{}</xs:list>", inner(item))), facets);
}

std::string length(int count) { return fmt::format("<xs:length value=\"{}\"/>", count); }

std::string one_of(std::initializer_list<std::string> bodies) {
  std::string members;
  for (const std::string& body : bodies) members += inner(body);
  return fmt::format("<xs:union>{}</xs:union>", members);
}

template <class Words>
std::string words_body(const Words& words) {
  std::string facets;
  for (const auto& word : words)
    facets += fmt::format("<xs:enumeration value=\"{}\"/>", xml_text(word));
  return restriction("xs:token", facets);
}

const std::string boolean_body = words_body(std::vector<std::string>{"true", "false"});

std::string bound(std::string_view facet, double value) {
  return fmt::format("<xs:{} value=\"{}\"/>", facet, value);
}

std::string number_body(const Range& range) {
  std::string facets;
  if (range.excludes_zero) facets += pattern("[^eE]*[1-9].*");
  if (std::isfinite(range.least))
    facets += bound(range.excludes_least ? "minExclusive" : "minInclusive", range.least);
  if (std::isfinite(range.most)) facets += bound("maxInclusive", range.most);
  return restriction("plain.number", facets);
}

std::string integer_body(const AttributeFormat& attribute) {
  const bool is_natural = attribute.range.starts_with("0 to 18446744073709551615");
  const auto whole = [](std::string_view facet, double value) {
    return fmt::format("<xs:{} value=\"{:.0f}\"/>", facet, value);
  };
  std::string facets = pattern(is_natural ? "[0-9]+" : "-?[0-9]+");
  if (std::isfinite(attribute.limits.least))
    facets += whole("minInclusive", attribute.limits.least);
  if (std::isfinite(attribute.limits.most)) facets += whole("maxInclusive", attribute.limits.most);
  if (attribute.range == "1") facets += whole("minInclusive", 1) + whole("maxInclusive", 1);
  return restriction(is_natural ? "xs:unsignedLong" : "xs:int", facets);
}

std::string vector_body(const Range& range) { return list_of(number_body(range), length(3)); }

std::string value_body(KeyValues values) {
  if (values == KeyValues::Numbers) return number_body({});
  if (values == KeyValues::Vectors) return vector_body({});
  return one_of({number_body({}), vector_body({}), boolean_body});
}

std::string slope_body(KeyValues values) {
  if (values != KeyValues::Any) return value_body(values);
  return one_of({number_body({}), vector_body({})});
}

/// A word with what follows it.
std::string extrapolation_body(KeyValues values) {
  const ExtrapolationWords words = extrapolation_words();
  const std::string slope = values == KeyValues::Numbers ? std::string(number_text)
                            : values == KeyValues::Vectors
                                ? fmt::format("{0} {0} {0}", number_text)
                                : fmt::format("{0}( {0} {0})?", number_text);
  return one_of(
      {words_body(words.plain), words_body(words.loops),
       restriction("xs:token",
                   pattern(fmt::format("({}) 0*[1-9][0-9]{{0,15}}", fmt::join(words.loops, "|")))),
       restriction("xs:token",
                   pattern(fmt::format("({}) {}", fmt::join(words.slopes, "|"), slope)))});
}

std::string handle_body(KeyValues values) {
  if (values == KeyValues::Numbers) return list_of(number_body({}), length(2));
  if (values == KeyValues::Vectors) return list_of(number_body({}), length(4));
  return one_of({handle_body(KeyValues::Numbers), handle_body(KeyValues::Vectors)});
}

std::string not_blank_body() { return restriction("xs:string", pattern(R"([\s\S]*\S[\s\S]*)")); }

std::string name_body() { return restriction("xs:string", pattern(name_text)); }

std::string rate_body() {
  return one_of({number_body(positive),
                 restriction("xs:token", pattern(fmt::format("{0}/{0}", positive_text)))});
}

/// Whether the type depends on the channel whose keys they are.
bool is_of_keys(std::string_view type) {
  return type == "value" || type == "tangent" || type == "extrapolation" || type == "handle";
}

std::string body_of(const AttributeFormat& attribute, KeyValues values) {
  const std::string& type = attribute.type;
  const auto words = attribute.words;
  if (type == "number") return number_body(attribute.limits);
  if (type == "integer") return integer_body(attribute);
  if (type == "integers") return list_of(integer_body(attribute), "<xs:minLength value=\"1\"/>");
  if (type == "boolean") return boolean_body;
  if (type == "word") return words_body(words);
  if (type == "vector") return vector_body(attribute.limits);
  if (type == "number or vector")
    return one_of({number_body(attribute.limits), vector_body(attribute.limits)});
  if (type == "one or two numbers")
    return list_of(number_body(attribute.limits),
                   "<xs:minLength value=\"1\"/><xs:maxLength value=\"2\"/>");
  if (type == "one or four words")
    return one_of({words_body(words), list_of(words_body(words), length(4))});
  if (type == "four numbers") return list_of(number_body({}), length(4));
  if (type == "rate") return rate_body();
  if (type == "name") return name_body();
  if (type == "definition name")
    return restriction("xs:string", pattern("[A-Za-z_][A-Za-z0-9_]{0,99}"));
  if (type == "names") return list_of(name_body(), "<xs:minLength value=\"1\"/>");
  if (type == "path") return not_blank_body();
  if (type == "text") return restriction("xs:string", "<xs:minLength value=\"1\"/>");
  if (type == "value") return value_body(values);
  if (type == "tangent") return one_of({words_body(tangent_words()), slope_body(values)});
  if (type == "interpolation") return words_body(interpolation_words());
  if (type == "extrapolation") return extrapolation_body(values);
  if (type == "handle") return handle_body(values);
  return restriction("xs:string", "");
}

/// Or a text with a `$`.
std::string or_computed(std::string_view body) {
  return fmt::format("<xs:union memberTypes=\"computed\">{}</xs:union>", inner(body));
}

/// A part of a name: without blanks and signs.
std::string in_name(std::string_view text) {
  std::string name(text);
  constexpr std::pair<std::string_view, std::string_view> words[] = {
      {">", "above"},   {"≥", "from"}, {"≤", "upTo"}, {"≠", "not"}, {" to ", "-to-"},
      {" or ", "-or-"}, {", ", "-"},   {"+", ""},     {" ", "-"},   {":", ""}};
  for (const auto& [from, to] : words) {
    for (std::size_t at = 0; (at = name.find(from, at)) != std::string::npos; at += to.size())
      name.replace(at, from.size(), to);
  }
  return name;
}

}  // namespace

std::string_view name_of(KeyValues values) {
  constexpr std::string_view names[] = {"numbers", "vectors", "any"};
  return names[static_cast<std::size_t>(values)];
}

std::string xml_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

std::string documentation_of(const AttributeFormat& attribute) {
  std::string text = attribute.meaning + ".";
  const auto add = [&](std::string_view what, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {}: {}.", what, value);
  };
  add("Type", attribute.type);
  add("Unit", attribute.unit);
  add("Range", attribute.range);
  add("Default", attribute.standard);
  if (attribute.is_keyable) text += " May be animated.";
  return text;
}

std::string SchemaTypes::define(const std::string& name, const std::string& body) {
  bodies_.emplace(name, body);
  return name;
}

/// A name that begins with `stem`, the same for the same body.
std::string SchemaTypes::define_once(const std::string& stem, const std::string& body) {
  std::string name = stem;
  for (int k = 2; bodies_.contains(name) && bodies_[name] != body; ++k)
    name = fmt::format("{}.{}", stem, k);
  return define(name, body);
}

std::string SchemaTypes::of(const AttributeFormat& attribute, KeyValues values) {
  const std::string body = or_computed(body_of(attribute, values));
  if (attribute.type == "word") return define_once(std::string(attribute.name) + ".word", body);
  std::string name = in_name(attribute.type);
  if (is_of_keys(attribute.type)) {
    name += fmt::format(".{}", name_of(values));
  } else if (!attribute.range.empty() && attribute.type != "four numbers" &&
             attribute.type != "name") {
    name += "." + in_name(attribute.range);
  }
  return define_once(name, body);
}

std::string SchemaTypes::of_words(const std::string& name, std::span<const std::string> words) {
  return define(name, or_computed(words_body(words)));
}

std::string SchemaTypes::numbers_in(std::string_view element, const Numbers& numbers) {
  const std::size_t least = std::max<std::size_t>(numbers.together, 1);
  return define_once(
      fmt::format("numbers.{}", element),
      list_of(number_body(numbers.range), fmt::format("<xs:minLength value=\"{}\"/>", least)));
}

std::string SchemaTypes::definitions() const {
  constexpr double largest = std::numeric_limits<double>::max();
  std::string text;
  const auto add = [&](std::string_view name, std::string_view body) {
    text += fmt::format("  <xs:simpleType name=\"{}\">\n    {}\n  </xs:simpleType>\n", name, body);
  };
  add("computed", restriction("xs:string", pattern(R"([\s\S]*$[\s\S]*)")));
  add("plain.number",
      restriction("xs:double", pattern(number_text) + bound("minInclusive", -largest) +
                                   bound("maxInclusive", largest)));
  for (const auto& [name, body] : bodies_) add(name, body);
  return text;
}

}  // namespace pliant::xml
