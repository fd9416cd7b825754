#include "viewer/page.hpp"

#include "pliant/core/base64.hpp"

namespace pliant::viewer {

// Generated, see viewer/CMakeLists.txt.
extern const std::span<const unsigned char> embedded_page;

namespace {

// Escapes text for the content of an element.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      default:
        result += letter;
    }
  }
  return result;
}

constexpr std::string_view policy_begin = "<meta http-equiv=\"Content-Security-Policy\" content=\"";
constexpr std::string_view asks_own_server = "connect-src 'self'";

// Replaces the text between two marks of the page.
void put(std::string& page, std::string_view begin, std::string_view end, std::string_view text) {
  const std::size_t from = page.find(begin);
  const std::size_t to = page.find(end, from);
  if (from == std::string::npos || to == std::string::npos) return;
  page.replace(from + begin.size(), to - from - begin.size(), text);
}

}  // namespace

Result<std::string_view> text_of(std::span<const unsigned char> page) {
  if (!page.empty()) {
    return std::string_view(reinterpret_cast<const char*>(page.data()), page.size());
  }
  return fail(ErrorCode::Unwritable,
              "this build has no viewer, because npm or its packages were missing; "
              "script/bootstrap && script/build adds it");
}

Result<std::string_view> page_template() { return text_of(embedded_page); }

std::string policy_of(std::string_view page) {
  const std::size_t from = page.find(policy_begin);
  if (from == std::string_view::npos) return "default-src 'none'";
  const std::string_view rest = page.substr(from + policy_begin.size());
  return std::string(rest.substr(0, rest.find('"')));
}

Result<std::string> page_with(std::string_view page, std::string_view title,
                              std::string_view packed, const StopRequest& should_stop) {
  constexpr std::size_t piece = 3'000'000;  // of three bytes each, so that pieces can be joined
  std::string digits;
  digits.reserve((packed.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < packed.size(); k += piece) {
    if (is_stopped(should_stop)) return interrupted();
    digits += base64(packed.substr(k, piece));
  }
  std::string result(page);
  if (const auto at = result.find(asks_own_server); at != std::string::npos) {
    result.replace(at, asks_own_server.size(), "connect-src 'none'");
  }
  put(result, "<title>", "</title>", (title.empty() ? "" : escaped(title) + " – ") + "pliant");
  put(result, "<script id=\"bake\" type=\"text/plain\">", "</script>", digits);
  return result;
}

}  // namespace pliant::viewer
