#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::viewer {

/// A raw deflate stream (RFC 1951) of the bytes. Errors: OutOfMemory; Interrupted.
Result<std::string> deflated(std::string_view bytes, const StopRequest& should_stop = {});

}  // namespace pliant::viewer
