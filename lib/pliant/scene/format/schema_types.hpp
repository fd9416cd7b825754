#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/format/format.hpp"

namespace pliant::xml {

/// The values of the keys of one <animate>, as far as they are known from where it stands.
enum class KeyValues { Numbers, Vectors, Any };

/// As it is part of the names of types.
std::string_view name_of(KeyValues values);

/// A text in XML.
std::string xml_text(std::string_view text);

/// What an attribute is, for people, on one line.
std::string documentation_of(const AttributeFormat& attribute);

/// The simple types of a schema, each defined once. Every attribute's type also accepts a text with
/// a `$`, which is computed before it is read.
class SchemaTypes {
 public:
  /// The name of an attribute's type. `values` matter to keys only.
  std::string of(const AttributeFormat& attribute, KeyValues values);

  /// The type of one of some words. Requires: the same words for the same name.
  std::string of_words(const std::string& name, std::span<const std::string> words);

  /// The type of the numbers that an element contains.
  std::string numbers_in(std::string_view element, const Numbers& numbers);

  /// All types that were named, in the order of their names.
  std::string definitions() const;

 private:
  std::string define(const std::string& name, const std::string& body);
  std::string define_once(const std::string& stem, const std::string& body);

  std::map<std::string, std::string> bodies_;  // of the names
};

}  // namespace pliant::xml
