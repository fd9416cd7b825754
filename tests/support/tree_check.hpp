#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/text/source_map.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant::testing {

inline std::optional<xml::Markup> places_of(std::string_view text) {
  xml::Findings findings("places.xml", SourceText::of(text));
  return xml::scan_markup(findings);
}

inline void append_utf8(std::string& text, unsigned long code) {
  const auto append = [&](unsigned long byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return append(code);
  if (code >= 0x10000) append(0xF0 | code >> 18U);
  if (code >= 0x800) append((code >= 0x10000 ? 0x80 : 0xE0) | (code >> 12U & 0x3F));
  append((code >= 0x800 ? 0x80 : 0xC0) | (code >> 6U & 0x3F));
  append(0x80 | (code & 0x3F));
}

/// The value of an attribute, from its text within the quotes: references are replaced, and each
/// line end is a line feed.
inline std::string decoded(std::string_view raw) {
  std::string value;
  for (std::size_t at = 0; at < raw.size(); ++at) {
    const std::string_view pair = raw.substr(at, 2);
    if (pair == "\r\n" || pair == "\n\r") ++at;
    if (raw[at] == '\r' || raw[at] == '\n') {
      value += '\n';
    } else if (raw[at] == '&') {
      const std::size_t end = raw.find(';', at);
      const std::string name(raw.substr(at + 1, end - at - 1));
      if (name[0] == '#')
        append_utf8(value, name[1] == 'x' ? std::stoul(name.substr(2), nullptr, 16)
                                          : std::stoul(name.substr(1)));
      else
        value += name == "amp"    ? '&'
                 : name == "lt"   ? '<'
                 : name == "gt"   ? '>'
                 : name == "quot" ? '"'
                                  : '\'';
      at = end;
    } else {
      value += raw[at];
    }
  }
  return value;
}

/// Holds the places of a text, and its tree, against what tinyxml2 makes of it.
class PlaceCheck {
 public:
  explicit PlaceCheck(const std::string& text)
      : text_(text), places_(places_of(text)), source_(SourceText::of(text)) {}

  /// The first disagreement; empty if there is none.
  std::string find() {
    if (!places_) return "the scan finds a problem";
    tinyxml2::XMLDocument document;
    if (document.Parse(text_.data(), text_.size()) != tinyxml2::XML_SUCCESS)
      return document.ErrorStr();
    visit(*document.RootElement(), xml::ElementPlace::no_parent);
    expect(element_ == places_->elements.size() && attribute_ == places_->attributes.size(),
           "there are more places than tinyxml2 has elements and attributes");
    xml::Tree tree(text_, *places_);
    compare(*document.RootElement(), tree.root());
    return complaint_;
  }

 private:
  void expect(bool is_so, std::string_view what) {
    if (!is_so && complaint_.empty())
      complaint_ = fmt::format("element {}, attribute {}: {}", element_, attribute_, what);
  }

  int line_of(const TextRange& range) const { return source_->span_of(range).line; }

  void visit(const tinyxml2::XMLElement& element, std::uint32_t parent) {
    if (element_ == places_->elements.size()) return expect(false, "a place is missing");
    const auto index = static_cast<std::uint32_t>(element_++);
    const xml::ElementPlace& place = places_->elements[index];
    const std::string_view tag = place.opening_tag().of(text_);
    const std::string_view whole = place.whole().of(text_);
    expect(place.name.of(text_) == element.Name(), "its name");
    expect(place.parent == parent, "its parent");
    expect(line_of(place.opening_tag()) == element.GetLineNum(), "its line");
    expect(tag.starts_with(fmt::format("<{}", element.Name())) && tag.ends_with('>'), "its tag");
    expect(place.closes_itself() == tag.ends_with("/>"), "whether it closes itself");
    expect(place.closes_itself() ? whole == tag : ends_in_closing_tag(whole, element.Name()),
           "its closing tag");
    visit_attributes(element, index);
    std::uint32_t free = place.tag_end;  // from here on the next child may stand
    for (const auto* child = element.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const std::size_t child_index = element_;
      visit(*child, index);
      if (!complaint_.empty()) return;
      const TextRange inner = places_->elements[child_index].whole();
      expect(inner.begin >= free && inner.end < place.end, "the place of a child");
      free = inner.end;
    }
  }

  /// Holds what readers see against tinyxml2.
  void compare(const tinyxml2::XMLElement& element, const xml::Element& own) {
    expect(own.name() == element.Name() && line_of(own.place().range) == element.GetLineNum(),
           "its tree");
    std::vector<xml::GivenAttribute> attributes = own.attributes();
    auto attribute = attributes.begin();
    for (const auto* given = element.FirstAttribute(); given; given = given->Next(), ++attribute) {
      if (attribute == attributes.end())
        return expect(false, "an attribute is missing in its tree");
      expect(attribute->name == given->Name() && attribute->value == given->Value() &&
                 line_of(attribute->place.name) == given->GetLineNum(),
             "an attribute in its tree");
    }
    expect(attribute == attributes.end(), "an attribute too many in its tree");
    xml::Findings findings("");
    xml::ContentReader content(own, findings);
    auto child = own.first_child();
    for (const auto* node = element.FirstChild(); node; node = node->NextSibling()) {
      if (node->ToComment()) continue;
      const auto part = content.next();
      if (!part) return expect(false, "a part of its content is missing");
      expect(part->element.has_value() == (node->ToElement() != nullptr), "the kind of a part");
      if (!complaint_.empty()) return;
      if (!part->element) {
        expect(xml::trimmed(part->value()) == xml::trimmed(node->Value()), "a text in it");
        expect(line_of(part->place.range) == node->GetLineNum(), "the line of a text in it");
        continue;
      }
      expect(child && child->place() == part->element->place() &&
                 child->parent().place() == own.place(),
             "the children in its tree");
      compare(*node->ToElement(), *part->element);
      if (!complaint_.empty()) return;
      child = child->next();
    }
    expect(!content.next() && !child, "a part too many");
  }

  void visit_attributes(const tinyxml2::XMLElement& element, std::size_t index) {
    const auto places = places_->attributes_of(index);
    std::uint32_t free = places_->elements[index].name.end;
    std::size_t count = 0;
    for (const auto* given = element.FirstAttribute(); given; given = given->Next()) {
      if (count == places.size()) return expect(false, "an attribute is missing");
      const xml::AttributePlace& place = places[count++];
      ++attribute_;
      expect(place.name.of(text_) == given->Name(), "the name of an attribute");
      expect(decoded(place.value.of(text_)) == given->Value(), "the value of an attribute");
      expect(line_of(place.name) == given->GetLineNum(), "the line of an attribute");
      expect(place.name.begin > free && place.whole().end < places_->elements[index].tag_end,
             "the place of an attribute");
      free = place.whole().end - 1;
      const std::string alone = fmt::format("<a {}/>", place.whole().of(text_));
      tinyxml2::XMLDocument document;
      expect(document.Parse(alone.data(), alone.size()) == tinyxml2::XML_SUCCESS &&
                 document.RootElement()->Attribute(given->Name(), given->Value()),
             "the whole of an attribute");
    }
    expect(count == places.size(), "an attribute too many");
  }

  /// Whether a text ends in `</name>`, with blanks after the name.
  static bool ends_in_closing_tag(std::string_view text, std::string_view name) {
    const std::size_t at = text.rfind("</");
    return at != std::string_view::npos && text.ends_with('>') &&
           xml::trimmed(text.substr(at + 2, text.size() - at - 3)) == name;
  }

  const std::string& text_;
  std::optional<xml::Markup> places_;
  std::shared_ptr<const SourceText> source_;
  std::size_t element_ = 0;
  std::size_t attribute_ = 0;
  std::string complaint_;
};

}  // namespace pliant::testing
