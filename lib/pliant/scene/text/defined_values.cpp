#include "pliant/scene/text/defined_values.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/result.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

constexpr std::size_t most_told = 3;  // definitions
constexpr int most_compared = 100;    // values of a line, with each message about it

bool is_of_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// Whether a text names the attribute of an object, as in `sheet.density is -1`.
bool names_attribute(std::string_view text, std::string_view attribute) {
  const std::string wanted = '.' + std::string(attribute);
  for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string_view::npos; ++at) {
    const std::size_t end = at + wanted.size();
    if (end == text.size() || !is_of_name(text[end])) return true;
  }
  return false;
}

}  // namespace

std::uint32_t DefinedValues::add_definition(std::string name, int text, int line) {
  const std::size_t index = definitions_.size();
  if (index < most_kept) definitions_.push_back({std::move(name), text, line});
  return static_cast<std::uint32_t>(index);
}

void DefinedValues::add(int line, std::string_view attribute, std::string_view value,
                        std::vector<std::uint32_t> definitions) {
  if (values_.size() >= most_kept) return;
  values_.push_back({line, std::string(attribute),
                     fmt::format("{}={}", attribute, in_quotes(value)), std::move(definitions)});
}

std::string DefinedValues::sources(int line, std::string_view message, const LineMap& files) const {
  std::vector<std::uint32_t> meant;
  int compared = 0;
  for (auto value = std::ranges::lower_bound(values_, line, {}, &Value::line);
       value != values_.end() && value->line == line && meant.size() < most_told; ++value) {
    if (++compared > most_compared) break;
    if (message.find(value->quoted) == std::string_view::npos &&
        !names_attribute(message, value->attribute))
      continue;
    meant.insert(meant.end(), value->definitions.begin(), value->definitions.end());
  }
  return sources(meant, files.text_of(line), files);
}

std::string DefinedValues::sources(std::span<const std::uint32_t> definitions, int text,
                                   const LineMap& files) const {
  std::string sources;
  std::size_t count = 0;
  for (std::size_t k = 0; k < definitions.size() && count < most_told; ++k) {
    const auto before = definitions.first(k);
    if (definitions[k] >= definitions_.size()) continue;
    if (std::ranges::find(before, definitions[k]) != before.end()) continue;
    const Definition& definition = definitions_[definitions[k]];
    sources += fmt::format("; ${} is defined at {}", definition.name,
                           files.title_in(definition.text, definition.line, text));
    ++count;
  }
  return sources;
}

}  // namespace pliant::xml
