#include "viewer/gate.hpp"

#include <array>
#include <cerrno>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <sys/random.h>

namespace pliant::viewer {
namespace {

std::optional<ViewRoute> route_to(std::string_view place) {
  constexpr std::array<std::pair<std::string_view, ViewRoute>, 6> routes = {
      {{"", ViewRoute::Page},
       {"take", ViewRoute::PicturePage},
       {"events", ViewRoute::Events},
       {"bake", ViewRoute::Bake},
       {"job", ViewRoute::Job},
       {"picture", ViewRoute::Picture}}};
  for (const auto& [name, route] : routes) {
    if (name == place) return route;
  }
  return std::nullopt;
}

// Uses the fields in which browsers state the origin of a request; other programs do not send them.
bool is_from_own_page(const HttpHead& head, std::optional<ViewRoute> route) {
  const std::string* site = head.find("sec-fetch-site");
  if (site == nullptr || *site == "same-origin") return true;
  // "none": the user typed the address.
  if (route == ViewRoute::Page) return *site == "none";
  // Our own file redirects to this page, so the browser loads it as a top-level page, not inside
  // another.
  const auto says = [&](std::string_view name, std::string_view value) {
    const std::string* found = head.find(name);
    return found != nullptr && *found == value;
  };
  return route == ViewRoute::PicturePage && *site == "cross-site" &&
         says("sec-fetch-mode", "navigate") && says("sec-fetch-dest", "document");
}

}  // namespace

Result<std::string> make_token() {
  std::array<unsigned char, 16> bytes = {};
  std::size_t count = 0;
  while (count < bytes.size()) {
    const ssize_t got = getrandom(bytes.data() + count, bytes.size() - count, 0);
    if (got < 0 && errno == EINTR) continue;  // a signal while the system still collects entropy
    if (got <= 0) return fail(ErrorCode::Unreadable, "cannot get random bytes from the system");
    count += static_cast<std::size_t>(got);
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same_secret(std::string_view given, std::string_view secret) {
  if (given.size() != secret.size()) return false;
  // Volatile, since otherwise a compiler may leave the loop at the first difference.
  volatile unsigned char difference = 0;
  for (std::size_t k = 0; k < secret.size(); ++k) {
    const unsigned char here = static_cast<unsigned char>(given[k] ^ secret[k]);
    difference = static_cast<unsigned char>(difference | here);
  }
  return difference == 0;
}

std::string ViewGate::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", port_, token_);
}

bool ViewGate::is_own_host(std::string_view host) const {
  return host == fmt::format("127.0.0.1:{}", port_) || host == fmt::format("localhost:{}", port_);
}

std::variant<ViewRoute, Refusal> ViewGate::judge(const HttpHead& head) const {
  constexpr Refusal forbidden = {403};
  const std::string* host = head.find("host");
  if (host == nullptr || !is_own_host(*host)) return forbidden;
  const std::string* origin = head.find("origin");
  if (origin != nullptr && *origin != "http://" + *host) return forbidden;

  const std::string_view target = head.target;
  if (!target.starts_with('/')) return forbidden;
  const std::size_t slash = target.find('/', 1);
  if (!is_same_secret(target.substr(1, slash - 1), token_)) return forbidden;
  const auto route =
      slash == std::string_view::npos ? std::nullopt : route_to(target.substr(slash + 1));
  if (!is_from_own_page(head, route)) return forbidden;
  if (!route) return Refusal{404};
  if (head.method != (*route == ViewRoute::Picture ? "POST" : "GET")) return Refusal{405};
  return *route;
}

}  // namespace pliant::viewer
