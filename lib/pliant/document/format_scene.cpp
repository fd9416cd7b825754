#include "pliant/document/format_scene.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/document/draft.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant {

using edit::Draft;
using edit::ElementIndex;

namespace {

/// Lays out a text from its begin to its end.
class Formatter {
 public:
  explicit Formatter(const Draft& draft)
      : draft_(draft), text_(draft.text()), poll_(draft.should_stop()) {
    const std::size_t feed = text_.find('\n');
    if (feed != std::string_view::npos && feed > 0 && text_[feed - 1] == '\r')
      layout_.line_end = "\r\n";
  }

  std::string format() {
    const auto begin = text_.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
    result_ = text_.substr(0, begin);
    is_empty_ = true;
    write_content(begin, text_.size(), {Draft::root}, "");
    return std::move(result_) + layout_.line_end;
  }

 private:
  /// Whether to end: the caller wants it, or the text is too large to be read.
  bool is_over() {
    constexpr std::size_t parts_of_element = 512;  // of work, see StopPoll
    return poll_.after(parts_of_element) || result_.size() > largest_scene_file;
  }

  /// Writes what stands from `begin` to `end`: some elements, and between them blanks, comments,
  /// declarations and a doctype.
  void write_content(std::size_t begin, std::size_t end, const std::vector<ElementIndex>& elements,
                     const std::string& margin) {
    auto element = elements.begin();
    bool is_first = true;
    for (std::size_t at = begin; at < end && !is_over();) {
      const std::size_t next = std::min(text_.find_first_not_of(xml::blanks, at), end);
      const std::string_view blanks = text_.substr(at, next - at);
      if (next == end) return;
      const auto lines = std::count(blanks.begin(), blanks.end(), '\n');
      const bool is_element =
          element != elements.end() && next == draft_.place(*element).whole().begin;
      const std::string_view rest = text_.substr(next);
      const bool is_behind = lines == 0 && rest.starts_with("<!--") && !is_empty_;
      if (is_behind) {
        result_ += ' ';
      } else {
        begin_line(margin, lines > 1 && !is_first);
      }
      // A comment behind the opening tag belongs to that.
      is_first = is_first && is_behind;
      is_empty_ = false;
      if (is_element) {
        write(*element, margin);
        at = draft_.place(*element++).end;
        continue;
      }
      at = std::min(end_of_mark(next), end);
      write_lines(text_.substr(next, at - next), margin_at(next), margin);
    }
  }

  /// Where the mark that begins at a place ends: the signs of its beginning are not those of its
  /// end. Only these stand between elements.
  std::size_t end_of_mark(std::size_t begin) const {
    constexpr std::pair<std::string_view, std::string_view> marks[] = {
        {"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}, {"<!", ">"}};
    for (const auto& [opening, closing] : marks) {
      if (!text_.substr(begin).starts_with(opening)) continue;
      const std::size_t end = text_.find(closing, begin + opening.size());
      return end == std::string_view::npos ? text_.size() : end + closing.size();
    }
    return text_.size();
  }

  void begin_line(const std::string& margin, bool has_blank_line) {
    if (is_empty_) return;
    if (has_blank_line) result_ += layout_.line_end;
    result_ += layout_.line_end + margin;
  }

  void write(ElementIndex element, const std::string& margin) {
    const xml::ElementPlace& place = draft_.place(element);
    std::vector<std::string> attributes;
    for (const xml::AttributePlace& given : draft_.attributes(element))
      attributes.push_back(fmt::format("{}=\"{}\"", given.name.of(text_), in_double_quotes(given)));
    const std::string_view name = draft_.name(element);
    const std::size_t end =
        place.closes_itself() ? place.tag_end : text_.rfind("</", place.end - 1);
    const std::string_view content = text_.substr(place.tag_end, end - place.tag_end);
    const bool is_empty = xml::trimmed(content).empty();
    result_ += xml::opening_tag(name, attributes, is_empty ? "/>" : ">", margin, layout_);
    if (is_empty) return;
    const std::vector<ElementIndex> children = draft_.children(element);
    if (has_text(place.tag_end, end, children)) {
      // Text stays as it is, but for the indentation of its lines.
      write_lines(content, margin_at(place.whole().begin), margin);
    } else {
      write_content(place.tag_end, end, children, margin + layout_.indent);
      result_ += layout_.line_end + margin;
    }
    result_ += fmt::format("</{}>", name);
  }

  /// Whether there is text between the elements of a content, or a CDATA section.
  bool has_text(std::size_t begin, std::size_t end,
                const std::vector<ElementIndex>& children) const {
    auto child = children.begin();
    for (std::size_t at = begin; at < end;) {
      at = std::min(text_.find_first_not_of(xml::blanks, at), end);
      if (at == end) return false;
      if (child != children.end() && at == draft_.place(*child).whole().begin) {
        at = draft_.place(*child++).end;
      } else if (text_.substr(at).starts_with("<!--")) {
        at = end_of_mark(at);
      } else {
        return true;
      }
    }
    return false;
  }

  /// An attribute's value as written, for double quotes.
  std::string in_double_quotes(const xml::AttributePlace& given) const {
    std::string value;
    for (const char c : given.value.of(text_))
      if (c == '"')
        value += "&quot;";
      else
        value += c;
    return value;
  }

  static bool is_blank(char c) { return xml::blanks.find(c) != std::string_view::npos; }

  /// The blanks before a place on its line; empty if something else stands there.
  std::string_view margin_at(std::size_t at) const {
    std::size_t begin = at;
    while (begin > 0 && text_[begin - 1] != '\n' && is_blank(text_[begin - 1])) --begin;
    const bool is_margin = begin == 0 || text_[begin - 1] == '\n';
    return is_margin ? text_.substr(begin, at - begin) : std::string_view();
  }

  /// Writes a text whose first line began behind `from` with the others moved to `to`.
  void write_lines(std::string_view text, std::string_view from, std::string_view to) {
    for (bool is_first = true; !is_over(); is_first = false) {
      if (!is_first) {
        result_ += layout_.line_end;
        if (text.starts_with(from) && !from.empty()) {
          text.remove_prefix(from.size());
          result_ += to;
        }
      }
      const std::size_t feed = text.find('\n');
      if (feed == std::string_view::npos) {
        result_ += text;
        return;
      }
      const bool has_return = feed > 0 && text[feed - 1] == '\r';
      result_ += text.substr(0, feed - (has_return ? 1 : 0));
      text.remove_prefix(feed + 1);
    }
  }

  const Draft& draft_;
  std::string_view text_;
  xml::Layout layout_;
  std::string result_;
  StopPoll poll_;
  bool is_empty_ = true;  // nothing but a byte order mark is written
};

}  // namespace

Result<std::string> format_scene(const std::string& text, const std::string& name,
                                 const StopRequest& should_stop) {
  const auto draft = Draft::make(text, name, should_stop);
  if (!draft) return fail(draft.error());
  std::string formatted = Formatter(*draft).format();
  if (is_stopped(should_stop)) return interrupted();
  if (const auto markup = xml::markup_of(formatted, name, should_stop); !markup)
    return fail(markup.error());
  return formatted;
}

}  // namespace pliant
