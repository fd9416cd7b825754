#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor/answer.hpp"

namespace pliant::editor {

/// The body of a POST: a JSON object.
using Body = nlohmann::json;

/// Reads the members of a body, each of its type. What is not read is unknown.
class Members {
 public:
  /// Requires: an object, which outlives this.
  explicit Members(const Body& body) : body_(body) {}

  /// Null: it is missing.
  const Body* find(std::string_view name);
  /// Empty: it is missing.
  std::string text(std::string_view name);
  std::string required_text(std::string_view name);
  bool flag(std::string_view name);
  std::optional<std::int64_t> whole(std::string_view name);
  std::optional<double> number(std::string_view name);
  /// Two whole numbers.
  std::optional<std::pair<int, int>> span(std::string_view name);

  void refuse(std::string_view name, std::string_view rule);

  /// The answer to what is wrong with the body; null: nothing is. Call it after all was read.
  std::optional<HttpAnswer> fault();

 private:
  const Body& body_;
  std::vector<std::string_view> known_;
  std::optional<std::string> fault_;
};

}  // namespace pliant::editor
