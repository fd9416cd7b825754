#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::viewer {

/// The page that shows a bake, from viewer/page. Errors: Unwritable if this build has no page; the
/// message says how to get it.
Result<std::string_view> page_template();

/// A page that is embedded in the program; empty: in a build without npm. Errors: likewise.
Result<std::string_view> text_of(std::span<const unsigned char> page);

/// The page's content security policy: it may use its own scripts and styles and connect to its own
/// server, nothing else.
std::string policy_of(std::string_view page);

/// A self-contained page: `page` with a title and `packed` (see `ViewBake`, `SweepBake`) inside. It
/// makes no requests. Errors: Interrupted.
Result<std::string> page_with(std::string_view page, std::string_view title,
                              std::string_view packed, const StopRequest& should_stop = {});

}  // namespace pliant::viewer
