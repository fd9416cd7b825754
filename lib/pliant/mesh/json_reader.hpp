#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pliant/core/result.hpp"

namespace pliant {

/// Limits of a file's JSON: nesting depth of its brackets, and number of values, so that its size
/// bounds the memory needed.
inline constexpr std::size_t deepest_json = 200;
inline constexpr std::size_t most_json_values = 4'000'000;

/// Parses the JSON of a file. `kind`: "glTF", in messages. Errors: invalid JSON, with the line, but
/// without quoting the text, which may be of any file; one that exceeds the limits.
Result<nlohmann::json> parse_json(std::string_view text, std::string_view kind);

/// Reads values from JSON, each by its path. The first error is kept, and values read after it are
/// meaningless. Internal to the library.
class JsonReader {
 public:
  using Json = nlohmann::json;

 protected:
  explicit JsonReader(Json& root) : root_(root) {}

  /// The path to the current value: `meshes[2].primitives[0]`.
  std::string place() const;

  /// Keeps an error about the member of the current value, `key`; empty: the value itself.
  void refuse(std::string_view key, std::string_view rule);

  static Json* member(Json& object, const char* key);

  /// Calls `read` for the objects in a list that may be missing.
  template <class Read>
  void each(Json& parent, const char* key, const Read& read) {
    Json* const list = member(parent, key);
    if (!list) return;
    if (!list->is_array()) return refuse(key, "is not a list");
    for (std::size_t k = 0; k < list->size() && !fault_; ++k) {
      place_.push_back({key, k});
      Json& element = (*list)[k];
      if (element.is_object())
        read(element);
      else
        refuse("", "is not an object");
      place_.pop_back();
    }
  }

  template <class Read>
  void within(const char* key, const Read& read) {
    place_.push_back({key, {}});
    read();
    place_.pop_back();
  }

  /// An object that may be missing.
  Json* part(Json& parent, const char* key);

  std::optional<std::string> text(Json& parent, const char* key);

  /// A whole number of at least 0.
  static std::optional<std::uint64_t> to_whole(const Json& json);
  std::optional<std::uint64_t> whole(Json& parent, const char* key);
  std::uint64_t required_whole(Json& parent, const char* key);

  /// `count` numbers; nullopt: the member is missing.
  std::optional<std::vector<double>> numbers(Json& parent, const char* key, std::size_t count);

  /// The number of elements of a list of the root.
  std::size_t list_size(const char* key) const;

  Json& root_;
  std::optional<std::string> fault_;

 private:
  struct Step {
    const char* key;
    std::optional<std::size_t> index;  // in a list
  };
  std::vector<Step> place_;
};

}  // namespace pliant
