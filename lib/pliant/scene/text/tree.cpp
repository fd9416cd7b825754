#include "pliant/scene/text/tree.hpp"

#include <algorithm>
#include <utility>

#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {

void Tree::include(int text, std::uint32_t element, std::string_view with, const Markup* markup,
                   bool is_content) {
  if (markup) included_.emplace(std::pair(text, element), static_cast<int>(texts_.size()));
  texts_.push_back({with, markup, is_content, text, element});
}

void Tree::set_value(int text, std::uint32_t begin, std::optional<std::string> value) {
  values_.emplace(std::pair(text, begin), std::move(value));
}

Element Tree::root() const { return {*this, 0, 0}; }

bool Tree::is_replaced(int text, std::uint32_t element) const {
  if (!is_spliced_) return false;
  const std::string_view name = this->name(text, element);
  return name == define_name || (name == include_name && included_.contains({text, element}));
}

std::optional<Tree::Siblings> Tree::in_place_of(int text, std::uint32_t element) const {
  const auto found = included_.find({text, element});
  if (found == included_.end()) return std::nullopt;
  const bool is_content = this->text(found->second).is_content;
  return Siblings{found->second, is_content ? 1U : 0U, is_content ? 0U : ElementPlace::no_parent};
}

/// The first of these, or of those that come after them in a text that includes theirs.
std::optional<Element> Tree::first_of(Siblings siblings) const {
  for (;;) {
    auto& [text, first, parent] = siblings;
    const Text& in = this->text(text);
    if (first < in.markup->elements.size() && place(text, first).parent == parent) {
      if (!is_replaced(text, first)) return Element(*this, text, first);
      if (const auto instead = in_place_of(text, first))
        siblings = *instead;
      else
        first = static_cast<std::uint32_t>(in.markup->after(first));
      continue;
    }
    const std::uint32_t outermost = in.is_content ? 0 : ElementPlace::no_parent;
    if (in.includer < 0 || parent != outermost) return std::nullopt;
    const Text& outer = this->text(in.includer);
    siblings = {in.includer, static_cast<std::uint32_t>(outer.markup->after(in.include)),
                place(in.includer, in.include).parent};
  }
}

GivenAttribute Element::given(const AttributePlace& attribute) const {
  const std::string_view text = tree_->text(text_).text;
  GivenAttribute given{.name = attribute.name.of(text), .text = text_, .place = attribute};
  const auto made = tree_->values_.find({text_, attribute.value.begin});
  given.is_unknown = made != tree_->values_.end() && !made->second;
  if (given.is_unknown) return given;
  given.value = made != tree_->values_.end() ? *made->second : decoded(attribute.value.of(text));
  return given;
}

std::vector<GivenAttribute> Element::attributes() const {
  std::vector<GivenAttribute> all;
  for (const AttributePlace& one : tree_->text(text_).markup->attributes_of(index_))
    all.push_back(given(one));
  return all;
}

std::optional<GivenAttribute> Element::attribute(std::string_view name) const {
  const Tree::Text& in = tree_->text(text_);
  const AttributePlace* const own = in.markup->attribute_of(index_, name, in.text);
  return own ? std::optional(given(*own)) : std::nullopt;
}

Element Element::parent() const {
  int text = text_;
  std::uint32_t parent = own().parent;
  for (;;) {
    const Tree::Text& in = tree_->text(text);
    const std::uint32_t outermost = in.is_content ? 0 : ElementPlace::no_parent;
    if (in.includer < 0 || parent != outermost) return {*tree_, text, parent};
    text = in.includer;
    parent = tree_->place(text, in.include).parent;
  }
}

std::optional<Element> Element::first_child() const {
  return tree_->first_of({text_, index_ + 1, index_});
}

std::optional<Element> Element::next() const {
  const auto next = static_cast<std::uint32_t>(tree_->text(text_).markup->after(index_));
  return tree_->first_of({text_, next, own().parent});
}

std::string ContentPart::value() const { return is_cdata ? std::string(text) : decoded(text); }

TextPlace ContentPart::place_of(std::string_view part) const {
  const auto begin = place.range.begin + static_cast<std::uint32_t>(part.data() - text.data());
  return {place.text, {begin, begin + static_cast<std::uint32_t>(part.size())}};
}

ContentReader::ContentReader(const Element& element, Findings& findings)
    : tree_(*element.tree_), findings_(findings) {
  const TextRange content = element.own().content_in(tree_.text(element.text_).text);
  open_.push_back({element.text_, element.index_ + 1, content.begin, content.end});
}

std::string_view ContentReader::take_to(std::size_t end) {
  Stretch& in = open_.back();
  const std::size_t begin = std::exchange(in.at, std::min(end, in.end));
  return whole().substr(begin, in.at - begin);
}

/// The child that comes next; null: something else stands in its place.
std::optional<Element> ContentReader::take_child() {
  Stretch& in = open_.back();
  const auto [text, child, at, end] = in;
  in.at = tree_.place(text, child).end;
  in.child = static_cast<std::uint32_t>(tree_.text(text).markup->after(child));
  if (!tree_.is_replaced(text, child)) return Element(tree_, text, child);
  if (const auto instead = tree_.in_place_of(text, child)) {
    const Tree::Text& inner = tree_.text(instead->text);
    const ElementPlace& root = inner.markup->elements.front();
    const TextRange range = inner.is_content ? root.content_in(inner.text) : root.whole();
    open_.push_back({instead->text, instead->first, range.begin, range.end});
  }
  return std::nullopt;
}

ContentPart ContentReader::text_part(std::string_view text, bool is_cdata) const {
  const auto begin = static_cast<std::uint32_t>(text.data() - whole().data());
  const std::string_view shown = trimmed(text);
  const auto size = static_cast<std::uint32_t>(shown.size());
  return {.text = text, .place = {open_.back().text, {begin, begin + size}}, .is_cdata = is_cdata};
}

std::optional<ContentPart> ContentReader::next() {
  constexpr std::string_view comment = "<!--", cdata = "<![CDATA[";
  while (!open_.empty() && !findings_.is_over()) {
    Stretch& in = open_.back();
    in.at = std::min(first_not_blank(whole(), in.at, findings_), in.end);
    if (in.at >= in.end) {
      open_.pop_back();
      continue;
    }
    const std::string_view ahead = whole().substr(in.at);
    const auto& elements = tree_.text(in.text).markup->elements;
    if (in.child < elements.size() && in.at == elements[in.child].whole().begin) {
      if (auto child = take_child()) return ContentPart{.element = child};
    } else if (ahead.starts_with(comment)) {
      take_to(find_from(whole(), "-->", in.at + comment.size(), findings_));
      take_to(in.at + 3);
    } else if (ahead.starts_with(cdata)) {
      take_to(in.at + cdata.size());
      const ContentPart part =
          text_part(take_to(find_from(whole(), "]]>", in.at, findings_)), true);
      take_to(in.at + 3);
      return part;
    } else {
      return text_part(take_to(whole().find('<', in.at)), false);
    }
  }
  return std::nullopt;
}

}  // namespace pliant::xml
