#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Limits of a file's JSON: nesting depth of its brackets, and number of values, so that its size
/// bounds the memory needed.
inline constexpr std::size_t deepest_json = 200;
inline constexpr std::size_t most_json_values = 4'000'000;

/// A step of the way to a value: into the member `key` of an object, or the element `index` of a
/// list.
struct JsonStep {
  std::string_view key = {};
  std::size_t index = 0;
  bool is_list = false;
};

/// Is offered each text in a list, with the way to it, while a file is parsed. True: it has taken
/// it, so that the list does not have it. Errors: as it likes; they end the parsing.
using TakeJsonText =
    std::function<Result<bool>(std::span<const JsonStep> way, const std::string& text)>;

/// Empties a value when its scope ends, from its leaves on. A value's own destructor allocates
/// memory for all that it contains, and ends the program where there is none.
class EmptiedJson {
 public:
  explicit EmptiedJson(nlohmann::json& value) : value_(value) {}
  EmptiedJson(const EmptiedJson&) = delete;
  EmptiedJson& operator=(const EmptiedJson&) = delete;
  ~EmptiedJson();

 private:
  nlohmann::json& value_;
};

/// Parses the JSON of a file, in one pass: the only parser of JSON from outside. `kind`: "glTF", in
/// messages. Errors: invalid JSON, with the line, but without quoting the text, which may be of any
/// file; a member that an object has twice; a NUL byte, but for three at the end; a number beyond
/// those of `double`; more than `most_values`, or too deep; those of `take_text`. Interrupted.
Result<nlohmann::json> parse_json(std::string_view text, std::string_view kind,
                                  const StopRequest& should_stop = {},
                                  std::size_t most_values = most_json_values,
                                  const TakeJsonText& take_text = {});

/// Reads values from JSON, each by its path. The first error is kept, and values read after it are
/// meaningless. Internal to the library.
class JsonReader {
 public:
  using Json = nlohmann::json;

 protected:
  explicit JsonReader(Json& root, const StopRequest& should_stop = {})
      : root_(root), should_stop_(should_stop), stop_(should_stop_) {}
  JsonReader(const JsonReader&) = delete;
  JsonReader& operator=(const JsonReader&) = delete;

  /// The path to the current value: `meshes[2].primitives[0]`.
  std::string place() const;

  /// Keeps an error about the member of the current value, `key`; empty: the value itself.
  void refuse(std::string_view key, std::string_view rule);

  /// The error that was kept, or that of an interrupt. Requires: `fault_`.
  tl::unexpected<Error> fault();

  /// Whether to go on with the next of many elements: no error, and no interrupt.
  bool goes_on();

  /// Ends the reading, since other work on a value was interrupted.
  void end() {
    is_interrupted_ = true;
    fault_ = "interrupted";
  }

  /// Null: it is missing, or the value is no object.
  static Json* member(Json& object, const char* key);

  /// Calls `read` for the objects in a list that may be missing.
  template <class Read>
  void each(Json& parent, const char* key, const Read& read) {
    Json* const list = member(parent, key);
    if (!list) return;
    if (!list->is_array()) return refuse(key, "is not a list");
    for (std::size_t k = 0; k < list->size() && goes_on(); ++k) {
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
  void each_required(Json& parent, const char* key, const Read& read) {
    if (!member(parent, key)) refuse(key, "is missing");
    each(parent, key, read);
  }

  template <class Read>
  void within(const char* key, const Read& read) {
    place_.push_back({key, {}});
    read();
    place_.pop_back();
  }

  /// An object that may be missing.
  Json* part(Json& parent, const char* key);
  Json* required_part(Json& parent, const char* key);

  std::optional<std::string> text(Json& parent, const char* key);
  std::string required_text(Json& parent, const char* key);
  /// A list, which may be missing.
  std::vector<std::string> texts(Json& parent, const char* key);
  std::vector<std::string> required_texts(Json& parent, const char* key);
  Hash required_hash(Json& parent, const char* key);

  /// A whole number of at least 0.
  static std::optional<std::uint64_t> to_whole(const Json& json);
  std::optional<std::uint64_t> whole(Json& parent, const char* key);
  std::uint64_t required_whole(Json& parent, const char* key);
  /// A list, which may be missing.
  std::vector<std::uint64_t> wholes(Json& parent, const char* key);

  static std::optional<std::int64_t> to_integer(const Json& json);
  std::int64_t required_integer(Json& parent, const char* key, std::int64_t least,
                                std::int64_t most);
  int required_int(Json& parent, const char* key, int least = std::numeric_limits<int>::min());
  double required_number(Json& parent, const char* key);

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
  StopRequest should_stop_;
  StopPoll stop_;
  bool is_interrupted_ = false;
};

}  // namespace pliant
