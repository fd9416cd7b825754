#include "cli/commands/problem_places.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/terminal/interrupt.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/text/markup.hpp"

namespace pliant::cli {
namespace {

constexpr std::string_view blanks = " \t\r\n";

// Attributes and elements of a line with a problem on it, and of all lines with all problems.
constexpr int most_compared = 10'000;
constexpr int most_compared_in_all = 100'000;

// The bytes of a text from `begin` up to `end`.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Stretch stretch_of(const xml::TextRange& range) { return {range.begin, range.end}; }

std::size_t utf16_units(std::string_view text) {
  std::size_t units = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0U) != 0x80U) units += byte >= 0xF0U ? 2 : 1;
  }
  return units;
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace

struct ProblemPlaces::Text {
  explicit Text(std::string given) : text(std::move(given)) {
    line_starts.push_back(0);
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) {
      line_starts.push_back(at + 1);
    }
    for (std::size_t at = 0; at <= text.size(); at += block_size) {
      const std::size_t before = units_before_blocks.empty() ? 0 : units_before_blocks.back();
      const std::size_t size = at == 0 ? 0 : block_size;
      units_before_blocks.push_back(before +
                                    utf16_units(std::string_view(text).substr(at - size, size)));
    }
    xml::Findings ignored("", &was_interrupted);
    if (auto scanned = xml::scan_markup(text, ignored)) markup = *std::move(scanned);
  }

  Stretch line(int number) const {
    const auto k = static_cast<std::size_t>(number - 1);
    const std::size_t end = k + 1 < line_starts.size() ? line_starts[k + 1] : text.size();
    return {line_starts[k], end};
  }

  int line_of(std::size_t at) const {
    const auto next = std::upper_bound(line_starts.begin(), line_starts.end(), at);
    return static_cast<int>(next - line_starts.begin());
  }

  int column_of(std::size_t at) const {
    std::size_t begin = line(line_of(at)).begin;
    if (begin == 0 && text.starts_with(xml::byte_order_mark)) begin = xml::byte_order_mark.size();
    return static_cast<int>(at > begin ? units_before(at) - units_before(begin) : 0) + 1;
  }

  /// UTF-16 units of the text before a place that begins a character.
  std::size_t units_before(std::size_t at) const {
    const std::size_t block = at / block_size;
    return units_before_blocks[block] +
           utf16_units(std::string_view(text).substr(block * block_size, at % block_size));
  }

  std::optional<Stretch> attribute(const Stretch& in, std::string_view message) const;
  std::optional<Stretch> element(const Stretch& in, std::string_view message) const;
  std::optional<Stretch> content(const Stretch& in, std::string_view message) const;
  std::size_t owner_of(std::uint32_t attribute) const;
  std::string_view object_around(std::size_t element) const;
  Stretch without_blanks(const Stretch& in) const;
  bool may_compare(int compared) const {
    return compared <= most_compared && ++compared_ <= most_compared_in_all;
  }

  std::string text;
  static constexpr std::size_t block_size = 4096;  // bytes
  std::vector<std::size_t> units_before_blocks;    // UTF-16 units before each
  std::vector<std::size_t> line_starts;
  xml::Markup markup;
  mutable int compared_ = 0;  // of all lines
};

// The attribute that the message names, in the ways in which the reader names one: best with its
// value, its element and its object.
std::optional<Stretch> ProblemPlaces::Text::attribute(const Stretch& in,
                                                      std::string_view message) const {
  const auto first = std::lower_bound(
      markup.attributes.begin(), markup.attributes.end(), in.begin,
      [](const xml::AttributePlace& place, std::size_t at) { return place.name.begin < at; });
  if (has(message, "needs the attribute")) return {};
  // `NAME.attribute …`: of the object of that name.
  const std::string_view object = message.substr(0, message.find_first_of(". "));
  const bool names_object =
      object.size() < message.size() && message[object.size()] == '.' && !object.empty();
  // What was there already is the earlier one.
  const bool is_later = has(message, "already") || has(message, "twice");
  std::optional<Stretch> best;
  std::size_t best_way = 24;
  int compared = 0;
  for (auto each = first;
       each != markup.attributes.end() && each->name.begin < in.end && may_compare(++compared);
       ++each) {
    const std::string_view name = each->name.of(text);
    const Stretch value = stretch_of(each->value), whole = stretch_of(each->whole());
    const bool is_animated = name == "attribute";  // its value is a name
    const std::string_view written = each->value.of(text);
    const std::string_view channel = is_animated ? written : name;
    const std::string_view quoted = written.substr(0, message.size());  // it is no longer than that
    if (!has(message, name) && !has(message, channel)) continue;
    const std::array<std::pair<std::string, Stretch>, 6> ways = {
        {{fmt::format(" {}=\"{}\"", name, quoted), value},
         {fmt::format(" {}=\"", name), value},
         {fmt::format("\"{}\"", name), stretch_of(each->name)},
         {fmt::format(".{}:", channel), value},
         {fmt::format(".{} ", channel), value},
         {fmt::format("> {}", name), whole}}};
    const std::size_t owner =
        owner_of(static_cast<std::uint32_t>(each - markup.attributes.begin()));
    const std::string_view tag = markup.elements[owner].name.of(text);
    const std::size_t is_other = has(message, fmt::format("<{}>", tag)) ? 0 : 1;
    const std::size_t is_of_other = names_object && object_around(owner) != object ? 2 : 0;
    for (std::size_t way = 0; way < ways.size(); ++way) {
      const std::size_t own = 4 * way + is_of_other + is_other;
      if (own > best_way || (own == best_way && !is_later) || !has(message, ways[way].first))
        continue;
      best = ways[way].second;
      best_way = own;
    }
  }
  return best;
}

// The element that has an attribute.
std::size_t ProblemPlaces::Text::owner_of(std::uint32_t attribute) const {
  const auto after = std::upper_bound(markup.elements.begin(), markup.elements.end(), attribute,
                                      [](std::uint32_t at, const xml::ElementPlace& element) {
                                        return at < element.first_attribute;
                                      });
  return static_cast<std::size_t>(after - markup.elements.begin()) - 1;
}

// The name that an element has, or the nearest one around it that has one.
std::string_view ProblemPlaces::Text::object_around(std::size_t element) const {
  for (auto at = static_cast<std::uint32_t>(element); at != xml::ElementPlace::no_parent;
       at = markup.elements[at].parent) {
    for (const xml::AttributePlace& each : markup.attributes_of(at)) {
      if (!may_compare(0)) return {};
      if (each.name.of(text) == "name") return each.value.of(text);
    }
  }
  return {};
}

// The text that the message quotes as what an element contains.
std::optional<Stretch> ProblemPlaces::Text::content(const Stretch& in,
                                                    std::string_view message) const {
  const std::size_t at = message.find('"', message.find(" contains "));
  if (at == std::string_view::npos) return {};
  const std::string_view rest = message.substr(at + 1);
  const std::string_view quoted = rest.substr(0, std::min(rest.find('"'), rest.find("\u2026")));
  constexpr std::size_t most_searched = 10'000;  // bytes of the line
  const std::size_t end = std::min(in.end, in.begin + most_searched);
  const std::size_t found = std::string_view(text).substr(0, end).find(quoted, in.begin);
  if (quoted.empty() || found == std::string_view::npos) return {};
  return Stretch{found, found + quoted.size()};
}

// The name of the first element of the line that the message names, without an attribute that it
// misses; or else of the first one.
std::optional<Stretch> ProblemPlaces::Text::element(const Stretch& in,
                                                    std::string_view message) const {
  const auto first = std::lower_bound(
      markup.elements.begin(), markup.elements.end(), in.begin,
      [](const xml::ElementPlace& place, std::size_t at) { return place.name.begin < at; });
  std::optional<Stretch> any;
  int compared = 0;
  for (auto each = first;
       each != markup.elements.end() && each->name.begin < in.end && may_compare(++compared);
       ++each) {
    const std::string name(each->name.of(text));
    if (!any) any = stretch_of(each->name);
    if (!has(message, "has no element \"" + name + '"') && !has(message, '<' + name + '>'))
      continue;
    const auto index = static_cast<std::size_t>(each - markup.elements.begin());
    const bool has_it =
        std::ranges::any_of(markup.attributes_of(index), [&](const xml::AttributePlace& attribute) {
          return has(message, fmt::format("\"{}\"", attribute.name.of(text)));
        });
    if (!has_it) return stretch_of(each->name);
  }
  return any;
}

Stretch ProblemPlaces::Text::without_blanks(const Stretch& in) const {
  const std::string_view whole = std::string_view(text).substr(in.begin, in.end - in.begin);
  const std::string_view inner = trim(whole, blanks);
  if (inner.empty()) return {in.begin, in.begin};
  const std::size_t begin = in.begin + static_cast<std::size_t>(inner.data() - whole.data());
  return {begin, begin + inner.size()};
}

ProblemPlaces::ProblemPlaces(std::vector<std::string> scenes, std::string root)
    : scenes_(std::move(scenes)), root_(std::move(root)) {}
ProblemPlaces::~ProblemPlaces() = default;

std::optional<ProblemPlace> ProblemPlaces::find(const std::string& file, int line,
                                                std::string_view message) {
  const auto [found, is_new] = texts_.try_emplace(file);
  if (is_new) {
    const bool is_scene = std::ranges::find(scenes_, file) != scenes_.end();
    const auto read = [&]() -> Result<std::string> {
      if (is_scene || root_.empty()) return read_file(file, largest_scene_file, &was_interrupted);
      const auto opened = OpenFile::open(file, root_);
      if (!opened) return fail(opened.error());
      return read_file(*opened, largest_scene_file, &was_interrupted);
    };
    if (auto text = read()) {
      const std::size_t first = text->find_first_not_of(" \t\r\n\xEF\xBB\xBF");
      const bool is_xml = first != std::string::npos && (*text)[first] == '<';
      if (is_xml) found->second = std::make_unique<Text>(*std::move(text));
    }
  }
  const Text* const text = found->second.get();
  if (!text || line < 1 || static_cast<std::size_t>(line) > text->line_starts.size()) return {};
  const Stretch in = text->line(line);
  std::optional<Stretch> place = text->content(in, message);
  if (!place) place = text->attribute(in, message);
  if (!place) place = text->element(in, message);
  if (!place) place = text->without_blanks(in);
  return ProblemPlace{text->line_of(place->begin), text->column_of(place->begin),
                      text->line_of(place->end), text->column_of(place->end)};
}

}  // namespace pliant::cli
