#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace pliant::editor {

/// The words behind the `?` of a request: `revision=3&frame=12`, with `%41` as `A`.
class Query {
 public:
  explicit Query(std::string_view query);

  /// Takes a word; empty: it is missing.
  std::string text(std::string_view name);
  /// Takes a whole number; null: it is missing.
  std::optional<std::int64_t> number(std::string_view name);

  /// Whether no word came twice, all numbers were some, and all words were taken. Call it last.
  bool is_sound() const { return is_sound_ && words_.empty(); }

 private:
  std::map<std::string, std::string, std::less<>> words_;
  bool is_sound_ = true;
};

}  // namespace pliant::editor
