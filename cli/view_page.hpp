#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// The page that shows a bake, from cli/viewer. Errors: Unwritable in a build that was made without
/// it, telling how to get it.
Result<std::string_view> page_template();

/// One page that needs nothing else: `page` with a title, and `packed` (see `ViewBake`) in it.
std::string page_with(std::string_view page, std::string_view title, std::string_view packed);

}  // namespace pliant::cli
