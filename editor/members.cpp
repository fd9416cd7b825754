#include "editor/members.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::editor {

void Members::refuse(std::string_view name, std::string_view rule) {
  if (!fault_) fault_ = fmt::format("{} {}", printable(name), rule);
}

const Body* Members::find(std::string_view name) {
  known_.push_back(name);
  const auto found = body_.find(name);
  return found == body_.end() ? nullptr : &*found;
}

std::string Members::text(std::string_view name) {
  const Body* const value = find(name);
  if (!value) return "";
  if (value->is_string()) return *value;
  refuse(name, "must be a text");
  return "";
}

std::string Members::required_text(std::string_view name) {
  if (!body_.contains(name)) refuse(name, "is missing");
  return text(name);
}

bool Members::flag(std::string_view name) {
  const Body* const value = find(name);
  if (value && !value->is_boolean()) refuse(name, "must be true or false");
  return value && value->is_boolean() && value->get<bool>();
}

std::optional<std::int64_t> Members::whole(std::string_view name) {
  const Body* const value = find(name);
  if (!value) return {};
  if (value->is_number_integer()) return value->get<std::int64_t>();
  refuse(name, "must be a whole number");
  return {};
}

std::optional<double> Members::number(std::string_view name) {
  const Body* const value = find(name);
  if (!value) return {};
  if (value->is_number()) return value->get<double>();
  refuse(name, "must be a number");
  return {};
}

std::optional<std::pair<int, int>> Members::span(std::string_view name) {
  const Body* const value = find(name);
  if (!value) return {};
  const auto is_int = [](const Body& one) {
    return one.is_number_integer() && one == one.get<int>();
  };
  if (value->is_array() && value->size() == 2 && is_int((*value)[0]) && is_int((*value)[1]))
    return std::pair((*value)[0].get<int>(), (*value)[1].get<int>());
  refuse(name, "must be [first, last]");
  return {};
}

std::optional<HttpAnswer> Members::fault() {
  for (const auto& [name, value] : body_.items()) {
    if (std::ranges::find(known_, name) == known_.end()) refuse(name, "is unknown");
  }
  return fault_ ? std::optional(refusal(400, *fault_)) : std::nullopt;
}

}  // namespace pliant::editor
