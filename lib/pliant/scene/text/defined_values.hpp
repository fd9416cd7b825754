#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/text/line_map.hpp"

namespace pliant::xml {

/// Which values of an expanded text were made of definitions, so that messages about such a value
/// can tell where these are.
class DefinedValues {
 public:
  /// Definitions and values beyond these are not kept: messages do not tell of them.
  static constexpr std::size_t most_kept = 100'000;

  /// Adds a definition at a line of a text; returns its index.
  std::uint32_t add_definition(std::string name, int text, int line);

  /// Adds a value on a line of the expanded text, not before that of the last one.
  void add(int line, std::string_view attribute, std::string_view value,
           std::vector<std::uint32_t> definitions);

  /// `; $w is defined at line 3`, for a message about a value on a line that was made of $w; empty:
  /// it is about none. Such a message has `attribute="value"` or `NAME.attribute`. Of a line with
  /// very many values only the first are compared.
  std::string sources(int line, std::string_view message, const LineMap& files) const;

  /// The same of these definitions, for a message at a text.
  std::string sources(std::span<const std::uint32_t> definitions, int text,
                      const LineMap& files) const;

 private:
  struct Definition {
    std::string name;
    int text = 0;
    int line = 0;
  };
  struct Value {
    int line = 0;
    std::string attribute;
    std::string quoted;  ///< `attribute="value"`, as messages have it
    std::vector<std::uint32_t> definitions;
  };

  std::vector<Definition> definitions_;
  std::vector<Value> values_;  // by line
};

}  // namespace pliant::xml
