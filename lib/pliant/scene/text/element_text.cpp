#include "pliant/scene/text/element_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include <fmt/format.h>

namespace pliant::xml {
namespace {

/// The number of characters; bytes 10xxxxxx continue one.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

void append_utf8(std::uint32_t code_point, std::string& text) {
  const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code_point < 0x80) return add(code_point);
  const auto trail = [&](unsigned shift) { add(0x80U | ((code_point >> shift) & 0x3FU)); };
  if (code_point < 0x800) {
    add(0xC0U | (code_point >> 6U));
  } else if (code_point < 0x10000) {
    add(0xE0U | (code_point >> 12U));
    trail(6);
  } else {
    add(0xF0U | (code_point >> 18U));
    trail(12);
    trail(6);
  }
  trail(0);
}

/// Appends the character of `&name;`.
void append_reference(std::string_view name, std::string& text) {
  if (name == "amp") {
    text += '&';
  } else if (name == "lt") {
    text += '<';
  } else if (name == "gt") {
    text += '>';
  } else if (name == "quot") {
    text += '"';
  } else if (name == "apos") {
    text += '\'';
  } else {
    const bool is_hex = name.starts_with("#x");
    const std::string_view digits = name.substr(is_hex ? 2 : 1);
    std::uint32_t code_point = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), code_point, is_hex ? 16 : 10);
    append_utf8(code_point, text);
  }
}

void append(const ElementText& element, const Layout& layout, const std::string& margin,
            StopPoll& poll, std::string& text) {
  std::vector<std::string> attributes;
  for (const auto& [name, value] : element.attributes)
    attributes.push_back(
        fmt::format("{}={}{}{}", name, layout.quote, encoded(value, layout.quote), layout.quote));
  const bool is_empty = element.children.empty() && element.text.empty();
  text += opening_tag(element.name, attributes, is_empty ? "/>" : ">", margin, layout);
  if (is_empty) return;
  text += element.text;
  const std::string inner = margin + layout.indent;
  for (const ElementText& child : element.children) {
    constexpr std::size_t parts_of_element = 512;  // of work, see StopPoll
    if (poll.after(parts_of_element)) return;
    text += layout.line_end + inner;
    append(child, layout, inner, poll, text);
  }
  if (!element.children.empty()) text += layout.line_end + margin;
  text += fmt::format("</{}>", element.name);
}

}  // namespace

std::string decoded(std::string_view written) {
  std::string text;
  for (std::size_t at = 0; at < written.size();) {
    const std::size_t end = std::min(written.find_first_of("&\r\n", at), written.size());
    text += written.substr(at, end - at);
    at = end;
    if (at == written.size()) break;
    if (written[at] == '&') {
      const std::size_t stop = std::min(written.find(';', at), written.size() - 1);
      append_reference(written.substr(at + 1, stop - at - 1), text);
      at = stop + 1;
    } else {
      const std::string_view pair = written.substr(at, 2);  // as tinyxml2 takes them
      text += '\n';
      at += pair == "\r\n" || pair == "\n\r" ? 2 : 1;
    }
  }
  return text;
}

std::string encoded(std::string_view value, char quote) {
  std::string text;
  for (const char c : value) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      // XML reads these as blanks or, after a carriage return, not at all.
      case '\t':
      case '\n':
      case '\r':
        text += fmt::format("&#{};", static_cast<int>(c));
        break;
      default:
        if (c == quote)
          text += quote == '"' ? "&quot;" : "&apos;";
        else
          text += c;
    }
  }
  return text;
}

std::string opening_tag(std::string_view name, std::span<const std::string> attributes,
                        std::string_view closing, std::string_view margin, const Layout& layout) {
  std::string text = fmt::format("<{}", name);
  std::size_t column = margin.size() + width_of(text);
  bool is_first = true;  // of its line
  for (std::size_t k = 0; k < attributes.size(); ++k) {
    const bool is_last = k + 1 == attributes.size();
    const std::size_t width = width_of(attributes[k]) + (is_last ? closing.size() : 0);
    if (!is_first && column + 1 + width > layout.columns) {
      text += fmt::format("{}{}{}{}", layout.line_end, margin, layout.indent, layout.indent);
      column = margin.size() + 2 * layout.indent.size();
    } else {
      text += ' ';
      ++column;
    }
    text += attributes[k];
    column += width;
    is_first = false;
  }
  return text += closing;
}

std::string text_of(const ElementText& element, const Layout& layout, const std::string& margin,
                    const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  std::string text;
  append(element, layout, margin, poll, text);
  return text;
}

}  // namespace pliant::xml
