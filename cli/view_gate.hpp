#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "http_head.hpp"

namespace pliant::cli {

/// What can be asked of the viewer's server.
enum class ViewRoute { Page, PicturePage, Events, Bake, Job, Picture };

/// A status of HTTP from 400 on.
struct Refusal {
  int status;
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// Who may ask the viewer's server, and for what. The server is reached by every program of the
/// machine and, through a browser, by every web page; so whoever asks has to know the token, and to
/// ask by this machine's own name (else DNS rebinding) from the server's own page (else a page
/// from elsewhere that was told the address).
class ViewGate {
 public:
  ViewGate(std::string token, int port) : token_(std::move(token)), port_(port) {}

  /// Where the page is, with a slash at the end. Pages know their own server by it alone.
  std::string address() const;

  /// 403 says nothing of what there is; 404 and 405 are told to those who know the token.
  std::variant<ViewRoute, Refusal> judge(const HttpHead& head) const;

 private:
  bool is_own_host(std::string_view host) const;

  std::string token_;
  int port_;
};

}  // namespace pliant::cli
