#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pliant/core/result.hpp"
#include "viewer/http_head.hpp"

namespace pliant::viewer {

/// Limits of a server for all clients. They bound the cost of anything that a client sends or fails
/// to do.
struct HttpLimits {
  std::size_t head_bytes = 16384;
  std::size_t head_lines = 64;
  std::size_t connections = 64;  ///< of known clients; the longest idle one gives way to another
  std::size_t strangers = 16;    ///< connections of others; the oldest gives way to another
  std::size_t streams = 16;      ///< connections that receive events
  std::size_t bodies = 1;        ///< that arrive, or wait for their answer, at the same time
  int requests = 100;            ///< per connection

  std::chrono::milliseconds head{2'000};    ///< from its first byte, or the connection, to its last
  std::chrono::milliseconds chance{10};     ///< before a stranger gives way
  std::chrono::milliseconds idle{15'000};   ///< from an answer to the next request
  std::chrono::milliseconds body{30'000};   ///< from its first byte to its last one
  std::chrono::milliseconds write{10'000};  ///< for 256 KiB
  std::chrono::milliseconds linger{500};    ///< from the last answer until the connection is closed
  std::chrono::milliseconds heartbeat{2'000};
};

/// The decision about a request, made before its body is read.
struct HttpVerdict {
  int status = 200;             ///< any other: refused with it, and the connection is closed
  std::uint64_t most_body = 0;  ///< a longer body is refused
  bool is_stream = false;       ///< receives events until it disconnects; `answer` gives the type
};

struct HttpAnswer {
  int status =
      200;  ///< from 400 on without a body: a refusal, after which the connection is closed
  std::string type = {};
  std::shared_ptr<const std::string> body = {};  ///< shared by all connections that send it
  std::string policy = "default-src 'none'";     ///< content security policy, for a page
};

/// Sends the answer to a request: call it once, in any thread, at once or when there is one. It
/// does nothing after the client or the server has gone. If it is destroyed without a call, the
/// answer is 503.
using HttpReply = std::function<void(HttpAnswer)>;

/// The functions of a service. They are called in the server's thread, one at a time; an exception
/// is answered by 503 (out of memory) or 500.
struct HttpService {
  std::function<HttpVerdict(const HttpHead&)> judge;
  std::function<void(const HttpHead&, std::string body, const HttpReply& reply)> answer;
  /// The events that a stream has not received yet, or null. Each stream has its own `seen`, -1 at
  /// first.
  std::function<std::shared_ptr<const std::string>(std::int64_t& seen)> next_event;
};

/// A server of HTTP/1.1 for this machine only (127.0.0.1). A client is known from its first request
/// on that `judge` accepts; until then it is a stranger, and however many of these there are,
/// others get in. The server is strict: a malformed request, one with a body of unknown length, or
/// a refused one ends the connection, so that none of its bytes can be read as another request.
class HttpServer {
 public:
  /// Accepts connections from now on. `port` 0: any free port. Errors: Unwritable if the port is in
  /// use.
  static Result<HttpServer> listen(int port, const HttpLimits& limits = {});

  HttpServer(HttpServer&&) noexcept;
  HttpServer& operator=(HttpServer&&) = delete;
  ~HttpServer();  ///< ends all connections at once

  int port() const;

  /// Starts answering. Call once.
  void serve(HttpService service);
  /// Makes the server call `next_event` for all streams. Thread-safe.
  void notify();

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::viewer
