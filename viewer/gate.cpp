#include "viewer/gate.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>
#include <sys/random.h>

namespace pliant::viewer {
namespace {

constexpr std::array<Route, 6> routes_of_viewer = {{{""},
                                                    {.place = "take", .is_from_file = true},
                                                    {"events"},
                                                    {"bake"},
                                                    {"job"},
                                                    {"picture", "POST"}}};

// Uses the fields in which browsers state the origin of a request; other programs do not send them.
bool is_from_own_page(const HttpHead& head, const Route* route) {
  const std::string* site = head.find("sec-fetch-site");
  if (site == nullptr || *site == "same-origin") return true;
  // "none": the user typed the address.
  if (route != nullptr && route->place.empty()) return *site == "none";
  // Our own file redirects to this page, so the browser loads it as a top-level page, not inside
  // another.
  const auto says = [&](std::string_view name, std::string_view value) {
    const std::string* found = head.find(name);
    return found != nullptr && *found == value;
  };
  return route != nullptr && route->is_from_file && *site == "cross-site" &&
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

std::string Gate::address() const { return fmt::format("http://127.0.0.1:{}/{}/", port_, token_); }

bool Gate::is_own_host(std::string_view host) const {
  return host == fmt::format("127.0.0.1:{}", port_) || host == fmt::format("localhost:{}", port_);
}

std::variant<std::size_t, Refusal> Gate::judge(const HttpHead& head) const {
  constexpr Refusal forbidden = {403};
  const std::string* host = head.find("host");
  if (host == nullptr || !is_own_host(*host)) return forbidden;
  const std::string* origin = head.find("origin");
  if (origin != nullptr && *origin != "http://" + *host) return forbidden;

  const std::string_view target = head.target;
  if (!target.starts_with('/')) return forbidden;
  const std::size_t slash = target.find('/', 1);
  if (!is_same_secret(target.substr(1, slash - 1), token_)) return forbidden;
  const std::string_view place = slash == std::string_view::npos ? "/" : target.substr(slash + 1);
  const auto is_there = [&](const Route& route) {
    return route.place == (route.has_query ? place.substr(0, place.find('?')) : place);
  };
  const auto known = std::ranges::find_if(routes_, is_there);
  const Route* const route = known == routes_.end() ? nullptr : &*known;
  if (!is_from_own_page(head, route)) return forbidden;
  if (route == nullptr) return Refusal{404};
  const auto found = std::ranges::find_if(
      routes_, [&](const Route& one) { return is_there(one) && head.method == one.method; });
  if (found == routes_.end()) return Refusal{405};
  return static_cast<std::size_t>(found - routes_.begin());
}

std::string_view query_of(std::string_view target) {
  const std::size_t mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
}

std::span<const Route> view_routes() { return routes_of_viewer; }

}  // namespace pliant::viewer
