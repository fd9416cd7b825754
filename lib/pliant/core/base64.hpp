#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/stop_request.hpp"

namespace pliant {

/// With padding (RFC 4648).
std::string base64(std::string_view bytes);

/// Null: the text is no such base 64, or the work has to end.
std::optional<std::string> from_base64(std::string_view text, StopPoll& poll);

}  // namespace pliant
