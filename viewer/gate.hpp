#pragma once

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

/// The requests that the viewer's server answers.
enum class ViewRoute { Page, PicturePage, Events, Bake, Job, Picture };

/// An HTTP status, 400 or above.
struct Refusal {
  int status;
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// Decides which requests the viewer's server answers. Every program of the machine can reach the
/// server, and through a browser every web page can. So a request must contain the token, use this
/// machine's own name (against DNS rebinding) and come from the server's own page (against a
/// foreign page that knows the address).
class ViewGate {
 public:
  ViewGate(std::string token, int port) : token_(std::move(token)), port_(port) {}

  /// The address of the page, with a slash at its end. A page knows its server only by this
  /// address.
  std::string address() const;

  /// 403 does not reveal which paths exist; 404 and 405 need the token.
  std::variant<ViewRoute, Refusal> judge(const HttpHead& head) const;

 private:
  bool is_own_host(std::string_view host) const;

  std::string token_;
  int port_;
};

}  // namespace pliant::viewer
