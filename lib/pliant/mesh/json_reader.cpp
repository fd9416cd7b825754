#include "pliant/mesh/json_reader.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace pliant {
namespace {

// Checked before parsing: each value needs about a hundred bytes, even if it is written in two.
Result<void> check_json_size(std::string_view json) {
  std::size_t depth = 0, values = 1;
  bool is_quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    if (is_quoted && c == '\\') {
      ++k;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && (c == '[' || c == '{')) {
      ++values;
      if (++depth > deepest_json)
        return invalid(fmt::format("the file's JSON is nested more than {} deep", deepest_json));
    } else if (!is_quoted && (c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (!is_quoted && c == ',') {
      ++values;
    }
  }
  if (values <= most_json_values) return {};
  return invalid(fmt::format("the file's JSON has more than {} values", most_json_values));
}

}  // namespace

// The parser's own messages quote the text, which may be that of any file.
Result<nlohmann::json> parse_json(std::string_view text, std::string_view kind) {
  const auto line_at = [&](std::size_t byte) {
    const std::string_view before = text.substr(0, byte);
    return static_cast<int>(1 + std::count(before.begin(), before.end(), '\n'));
  };
  if (auto checked = check_json_size(text); !checked) return fail(checked.error());
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return invalid(fmt::format("the file is not {}: it is not valid JSON from here on", kind),
                   line_at(error.byte > 0 ? error.byte - 1 : 0));
  } catch (const nlohmann::json::exception&) {
    return invalid(
        fmt::format("the file is not {}: its JSON has a number that is too large", kind));
  }
}

std::string JsonReader::place() const {
  std::string text;
  for (const auto& [key, index] : place_) {
    text += fmt::format("{}{}", text.empty() ? "" : ".", key);
    if (index) text += fmt::format("[{}]", *index);
  }
  return text;
}

void JsonReader::refuse(std::string_view key, std::string_view rule) {
  if (fault_) return;
  const std::string at = place();
  fault_ = fmt::format("{}{}{} {}", at, at.empty() || key.empty() ? "" : ".", key, rule);
}

JsonReader::Json* JsonReader::member(Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

JsonReader::Json* JsonReader::part(Json& parent, const char* key) {
  Json* const json = member(parent, key);
  if (!json || json->is_object()) return json;
  refuse(key, "is not an object");
  return nullptr;
}

std::optional<std::string> JsonReader::text(Json& parent, const char* key) {
  Json* const json = member(parent, key);
  if (!json) return {};
  if (auto* const written = json->get_ptr<std::string*>()) return std::move(*written);
  refuse(key, "is not text");
  return {};
}

std::optional<std::uint64_t> JsonReader::to_whole(const Json& json) {
  return json.is_number_unsigned() ? std::optional(json.get<std::uint64_t>()) : std::nullopt;
}

std::optional<std::uint64_t> JsonReader::whole(Json& parent, const char* key) {
  const Json* const json = member(parent, key);
  if (!json) return {};
  const auto number = to_whole(*json);
  if (!number) refuse(key, "is not a whole number of at least 0");
  return number;
}

std::uint64_t JsonReader::required_whole(Json& parent, const char* key) {
  if (!member(parent, key)) refuse(key, "is missing");
  return whole(parent, key).value_or(0);
}

std::optional<std::vector<double>> JsonReader::numbers(Json& parent, const char* key,
                                                       std::size_t count) {
  const Json* const list = member(parent, key);
  if (!list) return {};
  std::vector<double> values(count);
  bool is_sound = list->is_array() && list->size() == count;
  for (std::size_t k = 0; is_sound && k < count; ++k) {
    const Json& number = (*list)[k];
    is_sound = number.is_number();
    if (is_sound) values[k] = number.get<double>();
  }
  if (!is_sound) refuse(key, fmt::format("is not a list of {} numbers", count));
  return values;
}

std::size_t JsonReader::list_size(const char* key) const {
  const Json* const list = member(root_, key);
  return list && list->is_array() ? list->size() : 0;
}

}  // namespace pliant
