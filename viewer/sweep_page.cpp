#include "viewer/sweep_page.hpp"

#include <span>

#include "viewer/page.hpp"

namespace pliant::viewer {

// Generated, see viewer/CMakeLists.txt.
extern const std::span<const unsigned char> embedded_sweep_page;

Result<std::string_view> sweep_page_template() { return text_of(embedded_sweep_page); }

}  // namespace pliant::viewer
