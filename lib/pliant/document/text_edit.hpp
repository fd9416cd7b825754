#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// A change of a text: at a byte offset, some bytes are replaced by others.
struct TextEdit {
  std::size_t at = 0;
  std::string removed = {};
  std::string inserted = {};

  friend bool operator==(const TextEdit&, const TextEdit&) = default;
};

namespace edit {

/// Changes of one text, in the order of their offsets in it. They do not overlap.
using EditBatch = std::vector<TextEdit>;

/// The text with the changes made. Requires: it contains what they remove.
std::string made(const std::string& text, const EditBatch& batch);

/// The changes that take them back.
EditBatch reversed(const EditBatch& batch);

/// The change between two texts: what both begin with and what both end with stays, in whole
/// characters of UTF-8.
TextEdit difference(std::string_view from, std::string_view to);

}  // namespace edit

}  // namespace pliant
