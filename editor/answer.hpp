#pragma once

#include <memory>
#include <string>
#include <utility>

#include "pliant/core/result.hpp"
#include "viewer/http_server.hpp"
#include "viewer/json.hpp"

namespace pliant::editor {

using viewer::HttpAnswer;
using viewer::Json;

inline HttpAnswer text_answer(std::string text, int status = 200,
                              std::string type = "application/json") {
  return {.status = status,
          .type = std::move(type),
          .body = std::make_shared<const std::string>(std::move(text))};
}

/// Bytes that are not UTF-8, as an author's text may have them, are replaced.
inline std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

inline HttpAnswer json_answer(const Json& json, int status = 200) {
  return text_answer(text_of(json), status);
}

/// `[{"message","file","line"}…]`: the error and those found with it, in their order.
Json to_json(const Error& error);

inline HttpAnswer refusal(int status, const Error& error) {
  return json_answer({{"errors", to_json(error)}}, status);
}

inline HttpAnswer refusal(int status, std::string message) {
  return refusal(status, Error{.message = std::move(message)});
}

/// Refused by the document, or by what runs its scene.
inline HttpAnswer refusal(const Error& error) { return refusal(422, error); }

}  // namespace pliant::editor
