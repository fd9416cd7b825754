#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::viewer {

/// The page that shows a sweep. Errors: as `page_template`.
Result<std::string_view> sweep_page_template();

}  // namespace pliant::viewer
