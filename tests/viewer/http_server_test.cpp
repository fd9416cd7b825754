#include "viewer/http_server.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
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
  // Nothing more comes from us.
  void end() const { shutdown(socket_, SHUT_WR); }
  // That many bytes, or everything that the server sends until it closes the connection; if it does
  // not, ctest's time limit ends the test.
  std::string receive(std::size_t most = SIZE_MAX) const {
    std::string answer;
    char piece[4096];
    for (ssize_t got = 1; got > 0 && answer.size() < most;) {
      got = recv(socket_, piece, std::min(sizeof piece, most - answer.size()), 0);
      if (got > 0) answer.append(piece, static_cast<std::size_t>(got));
    }
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
                     [](const HttpHead& head, const std::string&, const HttpReply& reply) {
                       if (head.target.starts_with("/answer")) fail_as(std::string(head.target));
                       reply({.type = "text/plain", .body = std::make_shared<std::string>("well")});
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
                     [](const HttpHead&, const std::string&, const HttpReply& reply) {
                       reply({.type = "text/plain", .body = std::make_shared<std::string>("well")});
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

namespace {

HttpAnswer text(const std::string& body, int status = 200) {
  return {
      .status = status, .type = "text/plain", .body = std::make_shared<const std::string>(body)};
}

HttpVerdict accept_all(const HttpHead&) { return {}; }

}  // namespace

TEST_CASE("an answer may come later, in another thread and order", "[viewer][http][threads]") {
  std::mutex mutex;
  std::map<std::string, HttpReply, std::less<>> waiting;
  std::condition_variable changed;
  auto server = HttpServer::listen(0);
  REQUIRE(server);
  server->serve({.judge = &accept_all,
                 .answer =
                     [&](const HttpHead& head, const std::string&, const HttpReply& reply) {
                       const std::lock_guard lock(mutex);
                       waiting[head.target] = reply;
                       changed.notify_all();
                     },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  std::vector<Client> clients;
  for (int k = 0; k < 5; ++k) {
    clients.emplace_back(*server);
    clients.back().send(request_for("/" + std::to_string(k)));
  }
  {
    const Client gone(*server);
    gone.send(request_for("/gone"));
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return waiting.size() == 6; });
  }
  for (int k = 5; k-- > 0;) {
    std::thread([&, k] {
      const HttpReply& reply = waiting["/" + std::to_string(k)];
      reply(text("answer " + std::to_string(k)));
      reply(text("once more"));
    }).join();
    const std::string answer = clients[static_cast<std::size_t>(k)].receive();
    CHECK_THAT(answer, Catch::Matchers::EndsWith("answer " + std::to_string(k)));
  }
  waiting["/gone"](text("nobody listens"));
  { const HttpServer ended = *std::move(server); }
  waiting["/0"](text("there is no server"));
}

TEST_CASE("a refusal with a reason keeps the connection", "[viewer][http][threads]") {
  auto server = HttpServer::listen(0);
  REQUIRE(server);
  server->serve({.judge = &accept_all,
                 .answer =
                     [&](const HttpHead& head, const std::string&, const HttpReply& reply) {
                       reply(head.target == "/bare" ? HttpAnswer{.status = 409}
                                                    : text("because", 409));
                     },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  const Client client(*server);
  for (const char* path : {"/told", "/told", "/bare", "/told"})
    client.send("GET " + std::string(path) + " HTTP/1.1\r\nHost: a\r\n\r\n");
  const std::string answers = client.receive();
  std::size_t count = 0;
  for (std::size_t at = 0; (at = answers.find("HTTP/1.1 409", at)) != std::string::npos; ++at)
    ++count;
  CHECK(count == 3);
  CHECK(answers.find("because") != answers.rfind("because"));
}

TEST_CASE("a client may ask ahead of its body whether it is wanted", "[viewer][http][threads]") {
  auto server = HttpServer::listen(0);
  REQUIRE(server);
  server->serve({.judge = [](const HttpHead&) { return HttpVerdict{.most_body = 4}; },
                 .answer = [](const HttpHead&, const std::string& body,
                              const HttpReply& reply) { reply(text("got " + body)); },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  const auto ask = [&](const std::string& expectation, int size) {
    Client client(*server);
    client.send("POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\nExpect: " + expectation +
                "\r\nContent-Length: " + std::to_string(size) + "\r\n\r\n");
    return client;
  };
  const Client wanted = ask("100-Continue", 4);
  const std::string go_on = "HTTP/1.1 100 Continue\r\n\r\n";
  CHECK(wanted.receive(go_on.size()) == go_on);
  wanted.send("body");
  const std::string answer = wanted.receive();
  CHECK_THAT(answer, StartsWith("HTTP/1.1 200 "));
  CHECK_THAT(answer, Catch::Matchers::EndsWith("got body"));
  CHECK_THAT(ask("100-continue", 5).receive(), StartsWith("HTTP/1.1 413 "));
  CHECK_THAT(ask("200-ok", 4).receive(), StartsWith("HTTP/1.1 417 "));
  CHECK_THAT(ask("100-continue", 0).receive(), StartsWith("HTTP/1.1 200 "));
}

TEST_CASE("whoever sends a body that is too large hears so", "[viewer][http][threads]") {
  HttpLimits limits;
  limits.linger = std::chrono::minutes(1);
  auto server = HttpServer::listen(0, limits);
  REQUIRE(server);
  server->serve({.judge = &accept_all,
                 .answer = [](const HttpHead&, const std::string&,
                              const HttpReply& reply) { reply(text("well")); },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  const Client client(*server);
  const std::string body(20'000'000, 'x');
  client.send("POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 20000000\r\n\r\n" + body);
  client.end();
  CHECK_THAT(client.receive(), StartsWith("HTTP/1.1 413 "));
}

TEST_CASE("a request that nobody will answer is answered by 503", "[viewer][http][threads]") {
  auto server = HttpServer::listen(0);
  REQUIRE(server);
  std::vector<std::thread> threads;
  server->serve({.judge = &accept_all,
                 .answer =
                     [&](const HttpHead& head, const std::string&, const HttpReply& reply) {
                       if (head.target == "/here") return;
                       threads.emplace_back([reply] {});
                     },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  for (const char* path : {"/here", "/elsewhere"})
    CHECK_THAT(answer_to(*server, path), StartsWith("HTTP/1.1 503 "));
  for (std::thread& thread : threads) thread.join();
}

TEST_CASE("bodies are counted until their answer, also of clients that have gone",
          "[viewer][http][threads]") {
  std::mutex mutex;
  std::vector<HttpReply> waiting;
  std::condition_variable changed;
  auto server = HttpServer::listen(0, {.bodies = 3});
  REQUIRE(server);
  server->serve({.judge = [](const HttpHead&) { return HttpVerdict{.most_body = 4}; },
                 .answer =
                     [&](const HttpHead& head, const std::string&, const HttpReply& reply) {
                       if (head.body_size == 0) return reply(text("well"));
                       const std::lock_guard lock(mutex);
                       waiting.push_back(reply);
                       changed.notify_all();
                     },
                 .next_event = [](std::int64_t&) { return nullptr; }});
  const auto post = [&] {
    Client client(*server);
    client.send("POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Length: 4\r\n\r\nbody");
    return client;
  };
  const auto wait_for = [&](std::size_t count) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return waiting.size() == count; });
  };
  const Client first = post();
  wait_for(1);
  post();  // and goes
  wait_for(2);
  const Client third = post();
  wait_for(3);
  CHECK_THAT(post().receive(), StartsWith("HTTP/1.1 503 "));
  CHECK_THAT(answer_to(*server, "/"), StartsWith("HTTP/1.1 200 "));
  // The first, or that of the client that has gone.
  const auto [which, is_answered] = GENERATE(std::pair(0U, true), std::pair(0U, false),
                                             std::pair(1U, true), std::pair(1U, false));
  {
    const std::lock_guard lock(mutex);
    if (is_answered) waiting[which](text("late"));
    if (!is_answered) waiting[which] = {};
  }
  const Client fourth = post();
  wait_for(4);
  CHECK_THAT(post().receive(), StartsWith("HTTP/1.1 503 "));
}
