#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/text/markup.hpp"

namespace pliant::xml {

class Element;

/// The elements of a text that `scan_markup` accepts. Text and markup must outlive it.
class Tree {
 public:
  Tree(std::string_view text, const Markup& markup) : text_(text), markup_(markup), lines_(text) {}

  Element root();

 private:
  friend class Element;
  friend class ContentReader;

  int line_of(std::string_view part) {
    return lines_.line_of(static_cast<std::size_t>(part.data() - text_.data()));
  }

  std::string_view text_;
  const Markup& markup_;
  LineCounter lines_;
};

/// An attribute as an element gives it.
struct GivenAttribute {
  std::string_view name;
  std::string value;  ///< as XML reads it
  int line = 0;       ///< counted from 1
};

/// An element of a tree, which must outlive it.
class Element {
 public:
  Element(Tree& tree, std::uint32_t index) : tree_(&tree), index_(index) {}

  std::string_view name() const { return place().name.of(tree_->text_); }
  int line() const { return tree_->line_of(name()); }  ///< counted from 1

  std::vector<GivenAttribute> attributes() const;
  std::optional<GivenAttribute> attribute(std::string_view name) const;

  bool is_root() const { return place().parent == ElementPlace::no_parent; }
  /// The element that contains it. Requires: it is not the root.
  Element parent() const { return {*tree_, place().parent}; }
  std::optional<Element> first_child() const;
  std::optional<Element> next() const;  ///< in the same parent

 private:
  friend class ContentReader;

  const ElementPlace& place() const { return tree_->markup_.elements[index_]; }
  GivenAttribute given(const AttributePlace& attribute) const;

  Tree* tree_;
  std::uint32_t index_;
};

/// A part of the content of an element: an element, or text.
struct ContentPart {
  std::optional<Element> element = {};
  std::string_view text = {};  ///< as written, from its first character that is no blank
  bool is_cdata = false;       ///< in which no reference stands for a character

  std::string value() const;  ///< of the text, as XML reads it
};

/// Reads the content of an element from its begin to its end. Comments, and text that is blank, are
/// no parts of it.
class ContentReader {
 public:
  ContentReader(const Element& element, Findings& findings);

  std::optional<ContentPart> next();  ///< null: the end, or reading is to end

  /// The line of a part of a text.
  int line_of(std::string_view part) const { return tree_.line_of(part); }

 private:
  std::string_view take_to(std::size_t end);

  Tree& tree_;
  Findings& findings_;
  std::optional<Element> child_;  // that comes next
  std::size_t at_ = 0;
  std::size_t end_ = 0;
};

}  // namespace pliant::xml
