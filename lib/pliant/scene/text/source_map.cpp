#include "pliant/scene/text/source_map.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"

namespace pliant {
namespace {

constexpr std::size_t most_told = 3;  // definitions

std::size_t utf16_units(std::string_view text) {
  std::size_t units = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0U) != 0x80U) units += byte >= 0xF0U ? 2 : 1;
  }
  return units;
}

}  // namespace

std::string ScenePlace::told(std::string message) const {
  if (!chain.empty()) message += "; " + chain;
  return message;
}

void SourceText::count() const {
  PLIANT_EXPECTS(text_.size() < UINT32_MAX);
  line_starts_.push_back(0);
  for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1))
    line_starts_.push_back(static_cast<std::uint32_t>(at + 1));
  std::size_t units = 0;
  for (std::size_t at = 0; at <= text_.size(); at += block_size) {
    units_before_blocks_.push_back(static_cast<std::uint32_t>(units));
    units += utf16_units(text_.substr(at, block_size));
  }
}

std::size_t SourceText::units_before(std::size_t at) const {
  const std::size_t block = at / block_size;
  return units_before_blocks_[block] +
         utf16_units(text_.substr(block * block_size, at % block_size));
}

int SourceText::line_at(std::size_t at) const {
  std::call_once(counted_, [this] { count(); });
  const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), at);
  return static_cast<int>(next - line_starts_.begin());
}

std::pair<int, int> SourceText::position_of(std::size_t at) const {
  const int line = line_at(at);
  std::size_t begin = line_starts_[static_cast<std::size_t>(line) - 1];
  if (begin == 0 && text_.starts_with(byte_order_mark)) begin = byte_order_mark.size();
  const std::size_t units = at > begin ? units_before(at) - units_before(begin) : 0;
  return {line, static_cast<int>(units) + 1};
}

TextSpan SourceText::span_of(const TextRange& range) const {
  const auto [line, column] = position_of(range.begin);
  const auto [end_line, end_column] = position_of(range.end);
  return {line, column, end_line, end_column};
}

int SourceMap::add(std::string file, TextPlace include) {
  sources_.push_back({std::move(file), {}, include});
  return static_cast<int>(sources_.size()) - 1;
}

std::uint32_t SourceMap::add_definition(std::string name, TextPlace place) {
  const std::size_t number = definitions_.size();
  if (number < most_kept) definitions_.push_back({std::move(name), place});
  return static_cast<std::uint32_t>(number);
}

void SourceMap::add_value(TextPlace value, std::vector<std::uint32_t> definitions) {
  if (values_.size() < most_kept)
    values_.emplace(std::pair(value.text, value.range.begin), std::move(definitions));
}

ScenePlace SourceMap::place_of(const TextPlace& place) const {
  if (!place.is_known()) return {{}, sources_.front().file};
  const Source* source = &sources_[index(place.text)];
  ScenePlace found{{}, source->file};
  if (source->text) static_cast<TextSpan&>(found) = source->text->span_of(place.range);
  while (source->include.is_known()) {
    const TextPlace& include = source->include;
    source = &sources_[index(include.text)];
    found.chain += fmt::format("{}by {}:{}", found.chain.empty() ? "included " : ", ",
                               printable(source->file), source->text->span_of(include.range).line);
  }
  return found;
}

Error SourceMap::located(Error error, const TextPlace& place) const {
  const auto value = values_.lower_bound({place.text, place.range.begin});
  const bool is_made =
      value != values_.end() && value->first.first == place.text &&
      (value->first.second < place.range.end || value->first.second == place.range.begin);
  if (is_made) error.message += told(value->second, place);
  ScenePlace found = place_of(place);
  error.message = found.told(std::move(error.message));
  error.file = std::move(found.file);
  error.line = found.line;
  error.column = found.column;
  error.end_line = found.end_line;
  error.end_column = found.end_column;
  return error;
}

std::string SourceMap::title_of(const TextPlace& place, const TextPlace& from) const {
  const ScenePlace found = place_of(place);
  if (place.text == from.text) return fmt::format("line {}", found.line);
  return fmt::format("line {} of {}{}{}", found.line, printable(found.file),
                     found.chain.empty() ? "" : ", ", found.chain);
}

std::string SourceMap::told(std::span<const std::uint32_t> definitions,
                            const TextPlace& from) const {
  std::string text;
  for (const std::uint32_t number : definitions.first(std::min(definitions.size(), most_told))) {
    if (number >= definitions_.size()) continue;
    const Definition& definition = definitions_[number];
    text +=
        fmt::format("; ${} is defined at {}", definition.name, title_of(definition.place, from));
  }
  return text;
}

bool SourceMap::is_before(const TextPlace& a, const TextPlace& b) const {
  return way_to(a) < way_to(b);
}

// Where the texts are included in each other on the way to a place, and the place.
std::vector<std::uint32_t> SourceMap::way_to(TextPlace place) const {
  std::vector<std::uint32_t> way;
  for (; place.is_known(); place = sources_[index(place.text)].include)
    way.insert(way.begin(), place.range.begin);
  return way;
}

}  // namespace pliant
