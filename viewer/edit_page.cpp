#include "viewer/edit_page.hpp"

#include <span>

#include "viewer/page.hpp"

namespace pliant::viewer {

// Generated, see viewer/CMakeLists.txt.
extern const std::span<const unsigned char> embedded_edit_page;

Result<std::string_view> edit_page_template() { return text_of(embedded_edit_page); }

}  // namespace pliant::viewer
