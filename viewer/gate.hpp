#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "pliant/core/result.hpp"
#include "viewer/http_head.hpp"

namespace pliant::viewer {

/// 128 random bits from the system, as 32 hexadecimal digits. Errors: Unreadable if the system
/// provides no random bytes.
Result<std::string> make_token();

/// Whether both texts are equal. The time needed does not depend on where they differ, so that a
/// secret cannot be found digit by digit; its length is not secret.
bool is_same_secret(std::string_view given, std::string_view secret);

/// A request that a server answers.
struct Route {
  std::string_view place;  ///< below the address; empty: the page
  std::string_view method = "GET";
  bool has_query = false;     ///< `?` and words may follow
  bool is_from_file = false;  ///< a page to which a file of ours redirects
};

/// An HTTP status, 400 or above.
struct Refusal {
  int status;
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// Decides which requests a server answers. Every program of the machine can reach the server, and
/// through a browser every web page can. So a request must contain the token, use this machine's
/// own name (against DNS rebinding) and come from the server's own page (against a foreign page
/// that knows the address).
class Gate {
 public:
  /// `routes` outlive it.
  Gate(std::string token, int port, std::span<const Route> routes)
      : token_(std::move(token)), port_(port), routes_(routes) {}

  /// The address of the page, with a slash at its end. A page knows its server only by this
  /// address.
  std::string address() const;

  /// The index of the route. 403 does not reveal which paths exist; 404 and 405 need the token.
  std::variant<std::size_t, Refusal> judge(const HttpHead& head) const;

 private:
  bool is_own_host(std::string_view host) const;

  std::string token_;
  int port_;
  std::span<const Route> routes_;
};

/// The words behind the `?` of a target; empty: none.
std::string_view query_of(std::string_view target);

/// The requests that the viewer's server answers, in the order of their routes.
enum class ViewRoute { Page, PicturePage, Events, Bake, Job, Picture };

std::span<const Route> view_routes();

}  // namespace pliant::viewer
