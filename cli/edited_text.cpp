#include "edited_text.hpp"

#include <utility>

#include <fmt/format.h>

namespace pliant::cli {
namespace {

xml::Markup markup_of(const std::string& text) {
  xml::Findings findings("scene");
  return xml::scan_markup(text, findings).value_or(xml::Markup{});
}

}  // namespace

EditedText::EditedText(std::string text) : text_(std::move(text)), markup_(markup_of(text_)) {}

std::optional<std::size_t> EditedText::find(std::string_view name, std::size_t from) const {
  for (std::size_t k = from; k < element_count(); ++k) {
    if (name_of(k) == name) return k;
  }
  return std::nullopt;
}

std::string_view EditedText::name_of(std::size_t element) const {
  return markup_.elements[element].name.of(text_);
}

bool EditedText::is_inside(std::size_t element, std::size_t ancestor) const {
  const xml::TextRange outer = markup_.elements[ancestor].whole();
  const xml::TextRange inner = markup_.elements[element].whole();
  return outer.begin < inner.begin && inner.end < outer.end;
}

std::optional<std::string> EditedText::attribute(std::size_t element, std::string_view name) const {
  for (const xml::AttributePlace& place : markup_.attributes_of(element)) {
    if (place.name.of(text_) == name) return std::string(place.value.of(text_));
  }
  return std::nullopt;
}

void EditedText::set(std::size_t element, std::string_view name, std::string_view value) {
  for (const xml::AttributePlace& place : markup_.attributes_of(element)) {
    if (place.name.of(text_) == name) return replace(place.value.begin, place.value.end, value);
  }
  const auto places = markup_.attributes_of(element);
  const std::size_t behind =
      places.empty() ? markup_.elements[element].name.end : places.back().whole().end;
  replace(behind, behind, fmt::format(" {}=\"{}\"", name, value));
}

void EditedText::replace_with_comment(std::size_t element, std::string_view text) {
  const xml::TextRange whole = markup_.elements[element].whole();
  std::string_view before = std::string_view(text_).substr(0, whole.begin);
  before = before.substr(0, before.find_last_not_of(" \t\r\n") + 1);
  const std::size_t begin = before.ends_with("-->") ? before.rfind("<!--") : whole.begin;
  replace(begin, whole.end, text);
}

void EditedText::replace(std::size_t begin, std::size_t end, std::string_view by) {
  text_.replace(begin, end - begin, by);
  markup_ = markup_of(text_);
}

}  // namespace pliant::cli
