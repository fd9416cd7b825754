#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// The page that shows a bake, from cli/viewer. Errors: Unwritable in a build that was made without
/// it, telling how to get it.
Result<std::string_view> page_template();

/// What the page may do, as a content security policy: run and be styled by what stands in it, ask
/// its own server, nothing else.
std::string policy_of(std::string_view page);

/// One page that needs nothing else: `page` with a title, and `packed` (see `ViewBake`) in it. It
/// asks for nothing at all.
std::string page_with(std::string_view page, std::string_view title, std::string_view packed);

}  // namespace pliant::cli
