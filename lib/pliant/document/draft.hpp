#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/document/text_edit.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant::edit {

/// The index of an element in the markup of a draft.
using ElementIndex = std::uint32_t;

/// The text of a scene while operations change it. Changes are noted at their places in the present
/// text, and made all at once by `commit`, after which elements have other indices.
class Draft {
 public:
  /// Errors: those of `markup_of`. `name`: the file in messages.
  static Result<Draft> make(std::string text, const std::string& name,
                            const StopRequest& should_stop = {});

  const std::string& text() const { return text_; }
  const std::string& file() const { return file_; }
  const StopRequest& should_stop() const { return should_stop_; }
  int line_of(ElementIndex element) const;
  /// The elements of the present text, as readers take them. The draft must outlive it, unchanged.
  xml::Tree tree() const { return {text_, markup_}; }

  // The elements of the present text.

  static constexpr ElementIndex root = 0;
  std::string_view name(ElementIndex element) const { return place(element).name.of(text_); }
  const xml::ElementPlace& place(ElementIndex element) const { return markup_.elements[element]; }
  std::string_view whole(ElementIndex element) const { return place(element).whole().of(text_); }
  std::vector<ElementIndex> children(ElementIndex element) const;
  std::optional<ElementIndex> first_child(ElementIndex element) const;
  std::vector<ElementIndex> children(ElementIndex element, std::string_view name) const;
  /// The place of an attribute; null if the element does not have it.
  const xml::AttributePlace* attribute(ElementIndex element, std::string_view name) const;
  std::span<const xml::AttributePlace> attributes(ElementIndex element) const {
    return markup_.attributes_of(element);
  }
  /// The value of an attribute; null if the element does not have it.
  std::optional<std::string> value(ElementIndex element, std::string_view name) const;

  /// Whether `is_it(name, value)` for any attribute of the text.
  template <class Is>
  bool any_attribute(const Is& is_it) const {
    for (const xml::AttributePlace& one : markup_.attributes)
      if (is_it(one.name.of(text_), xml::decoded(one.value.of(text_)))) return true;
    return false;
  }

  // Noting changes. Each returns at once; nothing overlaps.

  void replace(TextRange range, std::string text);
  void insert(std::uint32_t at, std::string text) { replace({at, at}, std::move(text)); }

  /// Changes a value, or adds the attribute behind the others as these are laid out. Notes nothing
  /// if the value is the same.
  void set(ElementIndex element, std::string_view attribute, std::string_view value);
  void remove_attribute(ElementIndex element, std::string_view attribute);

  /// Removes an element, and its line if nothing else is on it.
  void remove(ElementIndex element);

  /// Replaces an element by another, in the quotes and the indentation of the first.
  void replace_element(ElementIndex element, const xml::ElementText& by);

  /// Puts a comment of these lines before an element, in place of one that stands there.
  void set_comment(ElementIndex element, std::string_view lines);

  /// Inserts text that stands for an element: behind a child of `parent` and the comments on its
  /// line, or with `after` null as the first child. It is laid out as its neighbours are.
  struct Place {
    ElementIndex parent = 0;
    std::optional<ElementIndex> after = {};
    bool keeps_blank_line = false;  ///< between it and its neighbour, if that has one before it
  };
  void insert(const xml::ElementText& element, const Place& place);
  void insert(const std::vector<std::string>& elements, const Place& place);

  /// How elements in `parent` are laid out, and the blanks before each on its line.
  struct Surroundings {
    xml::Layout layout;
    std::string margin;
    bool is_inline = false;  ///< all on one line
  };
  Surroundings inside(const Place& place) const;

  /// The blanks before the element on its line; null: something else stands before it.
  std::optional<std::string> margin_of(ElementIndex element) const;
  /// The line end that is next to a place.
  std::string line_end_near(std::size_t at) const;
  /// The blanks by which an element is indented in another, as the first one in the text is.
  std::string indent() const;
  /// They are these, whatever is in the text.
  void use_indent(std::string blanks) { indent_ = std::move(blanks); }

  /// The text of an element with its lines indented by `to` in place of `from`. Line ends in
  /// values, comments and texts stay.
  std::string reindented(ElementIndex element, std::string_view from, std::string_view to) const;
  std::string reindented(TextRange range, std::string_view from, std::string_view to) const;

  /// The range of an element and the blanks before it.
  TextRange with_blanks_before(ElementIndex element) const;
  /// The end of a place, and of the comments that follow it on its line.
  std::uint32_t end_with_comments(std::uint32_t end) const;

  /// Makes the noted changes. Errors: those of `markup_of`.
  Result<void> commit();

  /// All changes since it was made.
  std::vector<EditBatch> take_batches() { return std::move(batches_); }

  /// An error about the file as a whole.
  tl::unexpected<Error> refuse(std::string message) const {
    return fail(ErrorCode::InvalidInput, std::move(message), file_);
  }

 private:
  Draft(std::string file, const StopRequest& should_stop)
      : file_(std::move(file)), should_stop_(should_stop) {}
  Result<void> scan();
  std::uint32_t blanks_begin(std::uint32_t at) const;
  std::string blanks_before(ElementIndex element) const;

  std::string file_;
  StopRequest should_stop_;
  std::string text_;
  xml::Markup markup_;
  EditBatch noted_;
  std::vector<EditBatch> batches_;
  std::optional<std::string> indent_ = {};  // null: that of the text
};

}  // namespace pliant::edit
