#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/scene/text/markup.hpp"

namespace pliant::xml {

class Element;

inline constexpr std::string_view include_name = "include";
inline constexpr std::string_view define_name = "define";

/// The elements of a scene's texts. Those of a file that is included stand in place of the
/// <include>, values that are made of definitions in place of what is written, and a <define> is
/// not there. Texts and markup must outlive it.
class Tree {
 public:
  /// The elements of a text as they are written.
  Tree(std::string_view text, const Markup& markup) : texts_{{text, &markup}} {}

  /// The elements of a text whose includes and definitions are replaced: by what the following
  /// functions are given.
  static Tree spliced(std::string_view text, const Markup& markup) {
    Tree tree(text, markup);
    tree.is_spliced_ = true;
    return tree;
  }
  /// The next text stands in place of an <include>: its root, or what that contains. Null markup:
  /// it cannot be used, and the <include> stays.
  void include(int text, std::uint32_t element, std::string_view with, const Markup* markup,
               bool is_content);
  /// The value that begins at an offset of a text; null: it could not be made.
  void set_value(int text, std::uint32_t begin, std::optional<std::string> value);

  Element root() const;

 private:
  friend class Element;
  friend class ContentReader;

  struct Text {
    std::string_view text;
    const Markup* markup = nullptr;
    bool is_content = false;  // only what the root contains
    int includer = -1;        // the text of the <include>
    std::uint32_t include = 0;
  };
  // Neighbours in a text: the element that comes first, and what contains them.
  struct Siblings {
    int text = 0;
    std::uint32_t first = 0;
    std::uint32_t parent = ElementPlace::no_parent;
  };

  const Text& text(int index) const { return texts_[static_cast<std::size_t>(index)]; }
  const ElementPlace& place(int text, std::uint32_t element) const {
    return this->text(text).markup->elements[element];
  }
  std::string_view name(int text, std::uint32_t element) const {
    return place(text, element).name.of(this->text(text).text);
  }
  bool is_replaced(int text, std::uint32_t element) const;
  // What stands in place of an <include>; null: itself.
  std::optional<Siblings> in_place_of(int text, std::uint32_t element) const;
  std::optional<Element> first_of(Siblings siblings) const;

  std::vector<Text> texts_;  // the scene's own first
  bool is_spliced_ = false;
  std::map<std::pair<int, std::uint32_t>, int> included_;  // texts
  std::map<std::pair<int, std::uint32_t>, std::optional<std::string>> values_;
};

/// An attribute as an element gives it.
struct GivenAttribute {
  std::string_view name;
  std::string value = {};   ///< as XML reads it, of definitions as they make it
  bool is_unknown = false;  ///< it could not be made of definitions, which is reported
  int text = 0;
  AttributePlace place = {};

  TextPlace name_place() const { return {text, place.name}; }
  TextPlace value_place() const { return {text, place.value}; }
  TextPlace whole_place() const { return {text, place.whole()}; }
};

/// An element of a tree, which must outlive it.
class Element {
 public:
  Element(const Tree& tree, int text, std::uint32_t index)
      : tree_(&tree), text_(text), index_(index) {}

  std::string_view name() const { return tree_->name(text_, index_); }
  TextPlace place() const { return {text_, own().name}; }  ///< of its name

  std::vector<GivenAttribute> attributes() const;
  std::optional<GivenAttribute> attribute(std::string_view name) const;

  bool is_root() const { return text_ == 0 && index_ == 0; }
  /// The element that contains it. Requires: it is not the root.
  Element parent() const;
  std::optional<Element> first_child() const;
  std::optional<Element> next() const;  ///< in the same parent

 private:
  friend class ContentReader;

  const ElementPlace& own() const { return tree_->place(text_, index_); }
  GivenAttribute given(const AttributePlace& attribute) const;

  const Tree* tree_;
  int text_;
  std::uint32_t index_;
};

/// A part of the content of an element: an element, or text.
struct ContentPart {
  std::optional<Element> element = {};
  std::string_view text = {};  ///< as written, from its first character that is no blank
  TextPlace place = {};        ///< of the text
  bool is_cdata = false;       ///< in which no reference stands for a character

  std::string value() const;                        ///< of the text, as XML reads it
  TextPlace place_of(std::string_view part) const;  ///< of a part of the text
};

/// Reads the content of an element from its begin to its end. Comments, and text that is blank, are
/// no parts of it.
class ContentReader {
 public:
  ContentReader(const Element& element, Findings& findings);

  std::optional<ContentPart> next();  ///< null: the end, or reading is to end

 private:
  // What is read of a text: from `at` to `end`, with the element `child` as the next one.
  struct Stretch {
    int text = 0;
    std::uint32_t child = 0;
    std::size_t at = 0, end = 0;
  };

  std::string_view take_to(std::size_t end);
  std::optional<Element> take_child();
  ContentPart text_part(std::string_view text, bool is_cdata) const;
  std::string_view whole() const { return tree_.text(open_.back().text).text; }

  const Tree& tree_;
  Findings& findings_;
  std::vector<Stretch> open_;  // texts that include each other, from the outside in
};

}  // namespace pliant::xml
