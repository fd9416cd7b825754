#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pliant/document/draft.hpp"
#include "pliant/scene/key_text.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::edit {

/// A curve of a draft, with the elements that say it.
template <int D>
struct KeyedCurve {
  std::string channel;
  Element animate = 0;            ///< or <falloff>
  std::vector<Element> elements;  ///< of the keys
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

/// Reads the curve of an <animate> or <falloff> whose values have the type of an attribute.
/// Errors: those of the reader, with their lines.
Result<AnyCurve> read_keyed_curve(const Draft& draft, Element animate, std::string_view type,
                                  const std::string& channel);

}  // namespace pliant::edit
