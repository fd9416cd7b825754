#include "viewer/http_server.hpp"

#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "support/catch.hpp"

using namespace pliant::viewer;
using Catch::Matchers::StartsWith;

namespace {

// A connection, closed by the destructor.
class Client {
 public:
  explicit Client(const HttpServer& server) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }
  Client(Client&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Client& operator=(Client&&) = delete;
  ~Client() {
    if (socket_ >= 0) close(socket_);
  }

  void send(const std::string& text) const {
    REQUIRE(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(text.size()));
  }
  // Everything that the server sends until it closes the connection; if it does not, ctest's time
  // limit ends the test.
  std::string receive() const {
    std::string answer;
    char piece[4096];
    for (ssize_t got; (got = recv(socket_, piece, sizeof piece, 0)) > 0;)
      answer.append(piece, static_cast<std::size_t>(got));
    return answer;
  }

 private:
  int socket_ = socket(AF_INET, SOCK_STREAM, 0);
};

std::string request_for(const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n";
}

std::string answer_to(const HttpServer& server, const std::string& path) {
  const Client client(server);
  client.send(request_for(path));
  return client.receive();
}

[[noreturn]] void fail_as(const std::string& path) {
  if (path.find("memory") != std::string::npos) throw std::bad_alloc();
  if (path.find("number") != std::string::npos) throw 7;
  throw std::runtime_error("secret");
}

}  // namespace

TEST_CASE("what a service throws is answered, and the server goes on", "[viewer][http][threads]") {
  auto server = HttpServer::listen(0);
  REQUIRE(server);
  server->serve({.judge =
                     [](const HttpHead& head) {
                       if (head.target.starts_with("/judge")) fail_as(std::string(head.target));
                       return HttpVerdict{.is_stream = head.target.starts_with("/event")};
                     },
                 .answer =
                     [](const HttpHead& head, const std::string&) {
                       if (head.target.starts_with("/answer")) fail_as(std::string(head.target));
                       return HttpAnswer{.type = "text/plain",
                                         .body = std::make_shared<std::string>("well")};
                     },
                 .next_event = [](std::int64_t&) -> std::shared_ptr<const std::string> {
                   fail_as("/event");
                 }});
  for (const std::string when : {"/judge", "/answer"}) {
    CHECK_THAT(answer_to(*server, when + "/memory"), StartsWith("HTTP/1.1 503 "));
    for (const std::string what : {"/number", "/error"}) {
      const std::string answer = answer_to(*server, when + what);
      CHECK_THAT(answer, StartsWith("HTTP/1.1 500 "));
      CHECK(answer.find("secret") == std::string::npos);
    }
  }
  answer_to(*server, "/event");  // ends
  const std::string answer = answer_to(*server, "/fine");
  CHECK_THAT(answer, StartsWith("HTTP/1.1 200 "));
  CHECK_THAT(answer, Catch::Matchers::EndsWith("well"));
}

TEST_CASE("strangers keep nobody out, and give way in the order of their age",
          "[viewer][http][threads]") {
  // No deadline within this test.
  HttpLimits limits = {.connections = 3, .strangers = 4};
  limits.head = limits.idle = limits.write = std::chrono::hours(1);
  auto server = HttpServer::listen(0, limits);
  REQUIRE(server);
  server->serve({.judge =
                     [](const HttpHead& head) {
                       return HttpVerdict{.status = head.target == "/known" ? 200 : 403};
                     },
                 .answer =
                     [](const HttpHead&, const std::string&) {
                       return HttpAnswer{.type = "text/plain",
                                         .body = std::make_shared<std::string>("well")};
                     },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  std::vector<Client> strangers;
  for (const std::string& begin :
       {std::string(), std::string("G"), request_for("/known").substr(2)}) {
    for (int k = 0; k < 20; ++k) {
      strangers.emplace_back(*server);
      if (!begin.empty()) strangers.back().send(begin.substr(0, begin.size() - 1));
    }
  }
  CHECK_THAT(answer_to(*server, "/known"), StartsWith("HTTP/1.1 200 "));
  // The last but one of the four may have given way to this answer.
  for (std::size_t k = 0; k + 4 < strangers.size(); ++k) CHECK(strangers[k].receive().empty());
  CHECK_THAT(answer_to(*server, "/other"), StartsWith("HTTP/1.1 403 "));
}
