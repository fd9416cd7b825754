#include "viewer/http_server.hpp"

#include <new>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "support/catch.hpp"

using namespace pliant::viewer;
using Catch::Matchers::StartsWith;

namespace {

// Everything that the server sends for a request until it closes the connection; if it does not,
// ctest's time limit ends the test.
std::string answer_to(const HttpServer& server, const std::string& path) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  const std::string request = "GET " + path + " HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n";
  REQUIRE(send(connection, request.data(), request.size(), MSG_NOSIGNAL) ==
          static_cast<ssize_t>(request.size()));
  std::string answer;
  char piece[4096];
  for (ssize_t got; (got = recv(connection, piece, sizeof piece, 0)) > 0;)
    answer.append(piece, static_cast<std::size_t>(got));
  close(connection);
  return answer;
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
