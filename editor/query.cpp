#include "editor/query.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

#include "pliant/core/text.hpp"

namespace pliant::editor {
namespace {

std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t k = 0; k < text.size(); ++k) {
    unsigned code = 0;
    const char* const first = text.data() + k + 1;
    const bool is_coded = text[k] == '%' && k + 2 < text.size() &&
                          std::from_chars(first, first + 2, code, 16).ptr == first + 2;
    plain += is_coded ? static_cast<char>(code) : text[k];
    if (is_coded) k += 2;
  }
  return plain;
}

}  // namespace

Query::Query(std::string_view query) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view word = query.substr(0, end);
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string_view value = word.substr(std::min(equals + 1, word.size()));
    const bool is_new = words_.emplace(word.substr(0, equals), decoded(value)).second;
    is_sound_ = is_sound_ && is_new;
    query.remove_prefix(std::min(end + 1, query.size()));
  }
}

std::string Query::text(std::string_view name) {
  const auto found = words_.find(name);
  if (found == words_.end()) return "";
  std::string value = std::move(found->second);
  words_.erase(found);
  return value;
}

std::optional<std::int64_t> Query::number(std::string_view name) {
  const std::string value = text(name);
  if (value.empty()) return {};
  const auto number = to_integer(value);
  is_sound_ = is_sound_ && number.has_value();
  return number;
}

}  // namespace pliant::editor
