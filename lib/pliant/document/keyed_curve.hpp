#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pliant/document/draft.hpp"
#include "pliant/scene/format/key_text.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::edit {

/// A curve of a draft, with the elements that say it.
template <int D>
struct KeyedCurve {
  std::string channel;
  ElementIndex animate = 0;            ///< or <falloff>
  std::vector<ElementIndex> elements;  ///< of the keys
  xml::KeyAxis axis = xml::KeyAxis::Frame;
  xml::ValueKind kind = xml::ValueKind::Number;
  xml::AnimateText<D> defaults;
  Curve<D> curve;

  const std::vector<Key<D>>& keys() const { return curve.keys().keys; }
};

using AnyCurve = std::variant<KeyedCurve<1>, KeyedCurve<3>>;

/// A key as it shall be.
template <int D>
struct KeyEntry {
  Key<D> key;
  std::optional<std::size_t> origin = {};  ///< the key that it was; null: a new one
};

/// Keys in place of those of a curve at the same frames.
template <int D>
std::vector<KeyEntry<D>> entries_of(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted);

/// The text `now` with those words of `old` that say the same, and its blanks if it has as many.
std::string changed_words(std::string_view old, std::string_view now);

/// Whether an attribute of an element is computed; `$$` is not, but is taken for it.
bool is_computed(const Draft& draft, ElementIndex element);

/// Makes the scene of a text.
using ParseScene = std::function<Result<Scene>(const std::string& text)>;

/// Reads the curve of an <animate> or <falloff> whose values have the type of an attribute. Numbers
/// of keys with a `$` are those of the scene that `parse` makes of the draft.
/// Errors: those of the reader, with their lines; a `$` in the <animate> itself or in a <falloff>.
Result<AnyCurve> read_keyed_curve(const Draft& draft, ElementIndex animate, std::string_view type,
                                  const std::string& channel, const ParseScene& parse);

}  // namespace pliant::edit
