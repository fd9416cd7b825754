#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/scene.hpp"

namespace pliant::xml {

/// Words of other programs for attributes of these elements. Each list is separated by blanks.
struct ArtistWords {
  std::string_view elements;
  std::string_view words;  ///< in lower case, without - and _
  std::string_view meant;  ///< attributes of the element; `density@material`: of another one
};

/// The words that are known, for tests.
std::span<const ArtistWords> artist_words();

/// Words of other programs for elements.
struct ElementWords {
  std::string_view words;  ///< separated by blanks, in lower case, without - and _
  std::string_view meant;  ///< what to use, for a message
};

/// The words that are known, for tests.
std::span<const ElementWords> element_words();

/// What an artist may mean by an element that the format does not have: what to use in its place.
/// Empty: it is no such word.
std::string_view meant_by_element(std::string_view word);

/// `; did you mean "b", "c" and "d"? allowed: density, …` for an attribute that an element does not
/// have: what an artist may mean by it, otherwise as `hint`. `own` receives the attributes of the
/// element that are probably meant.
std::string attribute_hint(std::string_view element, std::string_view word,
                           std::span<const std::string_view> allowed,
                           std::vector<std::string_view>& own);

/// The same for an attribute of one of several elements, the first of which that has it counts.
std::string attribute_hint(std::span<const std::string_view> elements, std::string_view word,
                           std::span<const std::string_view> allowed,
                           std::vector<std::string_view>& own);

/// The same for a channel of an element or of one of its parts.
std::string channel_hint(std::string_view element, std::string_view word,
                         std::span<const std::string_view> allowed);

}  // namespace pliant::xml
