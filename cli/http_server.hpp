#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "http_head.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// What a server takes from whoever connects. Nothing that a client sends or leaves undone costs
/// more than this.
struct HttpLimits {
  std::size_t head_bytes = 16384;
  std::size_t head_lines = 64;
  std::size_t connections = 64;  ///< more are closed as they come
  std::size_t streams = 16;      ///< connections that are told of events
  std::size_t bodies = 1;        ///< that are being received at a time
  int requests = 100;            ///< of one connection

  std::chrono::milliseconds head{3'000};    ///< from its first byte to its last one
  std::chrono::milliseconds idle{15'000};   ///< from an answer to the next request
  std::chrono::milliseconds body{30'000};   ///< from its first byte to its last one
  std::chrono::milliseconds write{10'000};  ///< of a quarter of a megabyte
  std::chrono::milliseconds linger{500};    ///< from a refusal until the connection is cut
  std::chrono::milliseconds heartbeat{2'000};
};

/// What becomes of a request, said ahead of its body.
struct HttpVerdict {
  int status = 200;             ///< another one: refused with it, and the connection closed
  std::uint64_t most_body = 0;  ///< a longer one is refused
  bool is_stream = false;       ///< told of events until it goes away; `answer` gives the type
};

struct HttpAnswer {
  int status = 200;  ///< from 400 on: a refusal, which has no body
  std::string type = {};
  std::shared_ptr<const std::string> body = {};  ///< shared by all who are reading it
  std::string policy = "default-src 'none'";     ///< of content, if it is a page
};

/// What a server serves. Called in the server's thread, one at a time; what they throw is answered
/// by 503 (no memory) or 500.
struct HttpService {
  std::function<HttpVerdict(const HttpHead&)> judge;
  std::function<HttpAnswer(const HttpHead&, std::string body)> answer;
  /// What a stream has not been told yet, or nothing. `seen` is the stream's own, -1 at first.
  std::function<std::shared_ptr<const std::string>(std::int64_t& seen)> next_event;
};

/// A server of HTTP/1.1 for this machine only (127.0.0.1). It is strict: what is not well formed,
/// what has a body of unknown length, and what is refused ends the connection, so that no byte of
/// such a request can be taken for another request.
class HttpServer {
 public:
  /// Takes connections from now on. `port` 0: any that is free. Errors: Unwritable where the port
  /// is taken.
  static Result<HttpServer> listen(int port, const HttpLimits& limits = {});

  HttpServer(HttpServer&&) noexcept;
  HttpServer& operator=(HttpServer&&) = delete;
  ~HttpServer();  ///< ends all connections at once

  int port() const;

  /// Answers from now on. Once.
  void serve(HttpService service);
  /// There may be something new for `next_event`. From any thread.
  void notify();

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
