#include "pliant/scene/text/tree.hpp"

#include <algorithm>
#include <utility>

#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {

Element Tree::root() { return {*this, 0}; }

GivenAttribute Element::given(const AttributePlace& attribute) const {
  const std::string_view name = attribute.name.of(tree_->text_);
  return {name, decoded(attribute.value.of(tree_->text_)), tree_->line_of(name)};
}

std::vector<GivenAttribute> Element::attributes() const {
  std::vector<GivenAttribute> all;
  for (const AttributePlace& one : tree_->markup_.attributes_of(index_)) all.push_back(given(one));
  return all;
}

std::optional<GivenAttribute> Element::attribute(std::string_view name) const {
  for (const AttributePlace& one : tree_->markup_.attributes_of(index_))
    if (one.name.of(tree_->text_) == name) return given(one);
  return std::nullopt;
}

std::optional<Element> Element::first_child() const {
  const std::uint32_t child = index_ + 1;
  if (child >= tree_->markup_.elements.size()) return std::nullopt;
  const Element element(*tree_, child);
  return element.place().parent == index_ ? std::optional(element) : std::nullopt;
}

std::optional<Element> Element::next() const {
  const auto next = static_cast<std::uint32_t>(tree_->markup_.after(index_));
  if (next >= tree_->markup_.elements.size()) return std::nullopt;
  const Element element(*tree_, next);
  return element.place().parent == place().parent ? std::optional(element) : std::nullopt;
}

std::string ContentPart::value() const { return is_cdata ? std::string(text) : decoded(text); }

ContentReader::ContentReader(const Element& element, Findings& findings)
    : tree_(*element.tree_),
      findings_(findings),
      child_(element.first_child()),
      at_(element.place().tag_end),
      end_(element.place().closes_itself()
               ? at_
               : tree_.text_.rfind('<', element.place().end - std::size_t{1})) {}

std::string_view ContentReader::take_to(std::size_t end) {
  const std::size_t begin = std::exchange(at_, std::min(end, end_));
  return tree_.text_.substr(begin, at_ - begin);
}

std::optional<ContentPart> ContentReader::next() {
  constexpr std::string_view comment = "<!--", cdata = "<![CDATA[";
  while (!findings_.is_over()) {
    at_ = std::min(first_not_blank(tree_.text_, at_, findings_), end_);
    if (at_ >= end_) return std::nullopt;
    const std::string_view ahead = tree_.text_.substr(at_);
    if (child_ && at_ == child_->place().whole().begin) {
      ContentPart part{.element = child_};
      at_ = child_->place().end;
      child_ = child_->next();
      return part;
    }
    if (ahead.starts_with(comment)) {
      take_to(find_from(tree_.text_, "-->", at_ + comment.size(), findings_));
      take_to(at_ + 3);
    } else if (ahead.starts_with(cdata)) {
      take_to(at_ + cdata.size());
      ContentPart part{.is_cdata = true};
      part.text = take_to(find_from(tree_.text_, "]]>", at_, findings_));
      take_to(at_ + 3);
      return part;
    } else {
      return ContentPart{.text = take_to(tree_.text_.find('<', at_))};
    }
  }
  return std::nullopt;
}

}  // namespace pliant::xml
