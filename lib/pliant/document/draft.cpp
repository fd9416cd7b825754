#include "pliant/document/draft.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/text/text.hpp"

namespace pliant::edit {

using xml::AttributePlace;
using xml::blanks;
using xml::ElementPlace;

namespace {

constexpr std::string_view space = " \t";  // blanks within a line

bool has_line_end(std::string_view text) { return text.find('\n') != std::string_view::npos; }

/// The line end at a line feed.
std::string line_end_at(std::string_view text, std::size_t feed) {
  return feed > 0 && text[feed - 1] == '\r' ? "\r\n" : "\n";
}

/// The blanks after the last line end.
std::string last_line_of(std::string_view text) {
  return std::string(text.substr(text.rfind('\n') + 1));
}

}  // namespace

Result<Draft> Draft::make(std::string text, const std::string& name,
                          const StopRequest& should_stop) {
  Draft draft(name, should_stop);
  draft.text_ = std::move(text);
  if (auto scanned = draft.scan(); !scanned) return fail(scanned.error());
  return draft;
}

Result<void> Draft::scan() {
  auto markup = xml::markup_of(text_, file_, should_stop_);
  if (!markup) return fail(markup.error());
  markup_ = *std::move(markup);
  return {};
}

int Draft::line_of(ElementIndex element) const {
  return SourceText::of(text_)->span_of(place(element).name).line;
}

std::vector<ElementIndex> Draft::children(ElementIndex element) const {
  std::vector<ElementIndex> found;
  const std::size_t end = markup_.after(element);
  for (std::size_t child = element + std::size_t{1}; child < end; child = markup_.after(child))
    found.push_back(static_cast<ElementIndex>(child));
  return found;
}

std::optional<ElementIndex> Draft::first_child(ElementIndex element) const {
  const ElementIndex next = element + 1;
  const bool has_next = next < markup_.elements.size() && place(next).parent == element;
  return has_next ? std::optional(next) : std::nullopt;
}

std::vector<ElementIndex> Draft::children(ElementIndex element, std::string_view name) const {
  std::vector<ElementIndex> found = children(element);
  std::erase_if(found, [&](ElementIndex child) { return this->name(child) != name; });
  return found;
}

const AttributePlace* Draft::attribute(ElementIndex element, std::string_view name) const {
  return markup_.attribute_of(element, name, text_);
}

std::optional<std::string> Draft::value(ElementIndex element, std::string_view name) const {
  const AttributePlace* const given = attribute(element, name);
  if (!given) return std::nullopt;
  return xml::decoded(given->value.of(text_));
}

void Draft::replace(TextRange range, std::string text) {
  noted_.push_back(
      {.at = range.begin, .removed = std::string(range.of(text_)), .inserted = std::move(text)});
}

void Draft::set(ElementIndex element, std::string_view attribute, std::string_view value) {
  const auto given = markup_.attributes_of(element);
  if (const AttributePlace* const own = this->attribute(element, attribute)) {
    if (xml::decoded(own->value.of(text_)) == value) return;
    return replace(own->value, xml::encoded(value, text_[own->value.begin - 1]));
  }
  const char quote =
      given.empty() ? inside({element}).layout.quote : text_[given.back().value.begin - 1];
  // One line for each, or all on the lines that there are.
  std::string separator = " ";
  const auto blanks_of = [&](const AttributePlace& one) {
    return text_.substr(blanks_begin(one.name.begin),
                        one.name.begin - blanks_begin(one.name.begin));
  };
  const bool has_lines = given.size() > 1 &&
                         std::all_of(given.begin() + 1, given.end(),
                                     [&](const auto& one) { return has_line_end(blanks_of(one)); });
  if (has_lines) separator = blanks_of(given.back());
  insert(
      given.empty() ? place(element).name.end : given.back().whole().end,
      fmt::format("{}{}={}{}{}", separator, attribute, quote, xml::encoded(value, quote), quote));
}

void Draft::remove_attribute(ElementIndex element, std::string_view attribute) {
  const AttributePlace* const given = this->attribute(element, attribute);
  if (!given) return;
  replace({blanks_begin(given->name.begin), given->whole().end}, "");
}

void Draft::remove(ElementIndex element) {
  TextRange range = with_blanks_before(element);
  const std::uint32_t end = place(element).end;
  if (end_with_comments(end) != end) {
    // Comments behind it stay in its place.
    range = {place(element).whole().begin,
             static_cast<std::uint32_t>(text_.find_first_not_of(space, end))};
  }
  replace(range, "");
}

void Draft::replace_element(ElementIndex element, const xml::ElementText& by) {
  const Surroundings around = inside({.parent = place(element).parent, .after = element});
  replace(place(element).whole(),
          xml::text_of(by, around.layout, around.is_inline ? "" : around.margin));
}

void Draft::set_comment(ElementIndex element, std::string_view lines) {
  const auto margin = margin_of(element);
  const std::uint32_t begin = place(element).whole().begin;
  const std::string line_end = line_end_near(begin);
  std::string comment = "<!-- ";
  for (const char c : lines) {
    if (c == '\n')
      comment += margin ? fmt::format("{}{}     ", line_end, *margin) : " ";
    else
      comment += c;
  }
  comment += " -->";
  const std::uint32_t end = blanks_begin(begin);
  const std::string_view before = std::string_view(text_).substr(0, end);
  if (before.ends_with("-->")) {
    const auto old = static_cast<std::uint32_t>(before.rfind("<!--"));
    // One behind another element, at the end of its line, belongs to that.
    const std::size_t last = before.substr(0, old).find_last_not_of(space);
    const bool is_first = last == std::string_view::npos || before[last] == '\n';
    if (is_first || !margin) return replace({old, end}, std::move(comment));
  }
  insert(begin, comment + (margin ? line_end + *margin : " "));
}

std::uint32_t Draft::blanks_begin(std::uint32_t at) const {
  const std::size_t before = std::string_view(text_).substr(0, at).find_last_not_of(blanks);
  return before == std::string_view::npos ? 0 : static_cast<std::uint32_t>(before + 1);
}

std::string Draft::blanks_before(ElementIndex element) const {
  const std::uint32_t begin = place(element).whole().begin;
  return text_.substr(blanks_begin(begin), begin - blanks_begin(begin));
}

TextRange Draft::with_blanks_before(ElementIndex element) const {
  const TextRange range = place(element).whole();
  return {blanks_begin(range.begin), range.end};
}

std::uint32_t Draft::end_with_comments(std::uint32_t end) const {
  const std::string_view text = text_;
  for (std::size_t at = end, found = end;;) {
    at = std::min(text.find_first_not_of(space, at), text.size());
    const std::string_view rest = text.substr(at);
    if (!rest.starts_with("<!--")) {
      // Comments before another element on the line may belong to that.
      const bool ends_line = rest.empty() || rest[0] == '\n' || rest[0] == '\r';
      return static_cast<std::uint32_t>(ends_line || rest.starts_with("</") ? found : end);
    }
    at = found = text.find("-->", at + 4) + 3;
  }
}

std::optional<std::string> Draft::margin_of(ElementIndex element) const {
  const std::string_view before = std::string_view(text_).substr(0, place(element).whole().begin);
  const std::size_t last = before.find_last_not_of(space);
  if (last == std::string_view::npos) return std::string(before);
  if (before[last] != '\n') return std::nullopt;
  return std::string(before.substr(last + 1));
}

std::string Draft::line_end_near(std::size_t at) const {
  std::size_t feed = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
  if (feed == std::string::npos) feed = text_.find('\n', at);
  return feed == std::string::npos ? "\n" : line_end_at(text_, feed);
}

std::string Draft::indent() const {
  if (indent_) return *indent_;
  for (ElementIndex child = 1; child < markup_.elements.size(); ++child) {
    const auto outer = margin_of(place(child).parent);
    const auto inner = margin_of(child);
    if (outer && inner && inner->size() > outer->size() && inner->starts_with(*outer))
      return inner->substr(outer->size());
  }
  return "  ";
}

Draft::Surroundings Draft::inside(const Place& place) const {
  Surroundings result;
  const std::uint32_t begin = this->place(place.parent).whole().begin;
  std::optional<ElementIndex> neighbour = place.after;
  if (!neighbour) neighbour = first_child(place.parent);
  if (neighbour) {
    const std::string before = blanks_before(*neighbour);
    result.is_inline = !has_line_end(before);
    result.margin = last_line_of(before);
  } else {
    const auto margin = margin_of(place.parent);
    result.is_inline = !margin || !has_line_end(text_);
    result.margin = margin.value_or("") + indent();
  }
  if (!result.is_inline) {
    result.layout.line_end =
        line_end_near(neighbour ? this->place(*neighbour).whole().begin : begin);
    result.layout.indent = indent();
  } else {
    result.layout.line_end.clear();
    result.layout.indent.clear();
    result.layout.columns = std::numeric_limits<std::size_t>::max();
    result.margin = neighbour ? blanks_before(*neighbour) : "";
  }
  // The quotes of the nearest attribute.
  for (const ElementIndex near : {neighbour.value_or(place.parent), place.parent, root}) {
    const auto given = markup_.attributes_of(near);
    if (given.empty()) continue;
    result.layout.quote = text_[given.front().value.begin - 1];
    break;
  }
  return result;
}

void Draft::insert(const xml::ElementText& element, const Place& place) {
  const Surroundings around = inside(place);
  insert(std::vector{xml::text_of(element, around.layout, around.is_inline ? "" : around.margin)},
         place);
}

void Draft::insert(const std::vector<std::string>& elements, const Place& place) {
  if (elements.empty()) return;
  const ElementPlace& parent = this->place(place.parent);
  const Surroundings around = inside(place);
  std::string separator = around.layout.line_end + around.margin;
  if (place.keeps_blank_line && place.after && !around.is_inline)
    separator = blanks_before(*place.after);
  std::string text;
  for (const std::string& element : elements) text += separator + element;
  const std::string closing =
      around.is_inline ? "" : around.layout.line_end + margin_of(place.parent).value_or("");

  if (parent.closes_itself()) {
    const std::uint32_t begin = blanks_begin(parent.tag_end - 2);
    const bool is_own_line = has_line_end(TextRange{begin, parent.tag_end}.of(text_));  // of the />
    return replace({is_own_line ? parent.tag_end - 2 : begin, parent.tag_end},
                   fmt::format(">{}{}</{}>", text, closing, parent.name.of(text_)));
  }
  const std::uint32_t at =
      end_with_comments(place.after ? this->place(*place.after).end : parent.tag_end);
  if (!place.after && !first_child(place.parent)) {
    const auto end = static_cast<std::uint32_t>(text_.rfind("</", parent.end - 1));
    if (!has_line_end(TextRange{at, end}.of(text_))) text += closing;
  }
  insert(at, std::move(text));
}

std::string Draft::reindented(ElementIndex element, std::string_view from,
                              std::string_view to) const {
  return reindented(place(element).whole(), from, to);
}

std::string Draft::reindented(TextRange range, std::string_view from, std::string_view to) const {
  const std::string_view text = range.of(text_);
  std::string result;
  char quote = 0;  // around the present place; 0: none
  bool is_in_tag = false;
  for (std::size_t at = 0; at < text.size();) {
    if (!is_in_tag && text.substr(at).starts_with("<!--")) {
      const std::size_t end = std::min(text.find("-->", at + 4), text.size() - 3) + 3;
      result += text.substr(at, end - at);
      at = end;
      continue;
    }
    const char c = text[at++];
    result += c;
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (is_in_tag && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == '<' || c == '>') {
      is_in_tag = c == '<';
    } else if (c == '\n' && text.substr(at).starts_with(from)) {
      const bool is_blank = at + from.size() < text.size() &&
                            (text[at + from.size()] == '\n' || text[at + from.size()] == '\r');
      if (is_blank) continue;
      at += from.size();
      result += to;
    }
  }
  return result;
}

Result<void> Draft::commit() {
  if (noted_.empty()) return {};
  // What is inserted at a place comes before what replaces the text there.
  std::stable_sort(noted_.begin(), noted_.end(), [](const TextEdit& a, const TextEdit& b) {
    if (a.at != b.at) return a.at < b.at;
    return a.removed.empty() && !b.removed.empty();
  });
  text_ = made(text_, noted_);
  batches_.push_back(std::exchange(noted_, {}));
  return scan();
}

}  // namespace pliant::edit
