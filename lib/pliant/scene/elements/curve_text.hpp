#pragma once

#include <string>
#include <string_view>

#include "pliant/scene/format/key_text.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::xml {

/// The text in which no `$` stands for a definition.
std::string with_doubled_dollars(std::string_view text);

/// Adds the attributes that differ from `standard`, a table of the same rows with the default
/// values, and those that are required.
void add_attributes(ElementText& element, const Table& table, const Table& standard);

/// A tangent with its length without the numbers that its kind does not read.
template <int D>
Tangent<D> plain(const Tangent<D>& tangent);

/// Whether they have the same name in a file; their parameters may differ.
bool has_same_word(const Interpolation& a, const Interpolation& b);

/// What a <key> says that stands in an <animate> with these defaults.
template <int D>
KeyText<D> text_of_key(const Key<D>& key, const AnimateText<D>& defaults);

/// The <key>.
template <int D>
ElementText key_element(const Key<D>& key, const AnimateText<D>& defaults, KeyAxis axis,
                        ValueKind kind);

/// The <loop>.
template <int D>
ElementText loop_element(const Loop<D>& loop, ValueKind kind);

/// An <animate> of the attribute, or if that is empty a <falloff>. Not all keys if the caller wants
/// it to stop.
template <int D>
ElementText curve_element(std::string_view attribute, const CurveKeys<D>& keys, ValueKind kind,
                          const StopRequest& should_stop = {});

}  // namespace pliant::xml
