#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::viewer {

/// The page that edits a scene. Errors: as `page_template`.
Result<std::string_view> edit_page_template();

}  // namespace pliant::viewer
