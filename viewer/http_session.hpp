#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "viewer/http_head.hpp"
#include "viewer/http_server.hpp"

namespace pliant::viewer {

class HttpSession;
class DueAnswer;

/// Brings work into the server's thread, as long as there is a server. Thread-safe.
class HttpPost {
 public:
  void open(boost::asio::io_context& context);
  void close();
  void send(std::function<void()> work);

 private:
  std::mutex mutex_;
  boost::asio::io_context* context_ = nullptr;  // null: the server has ended
};

/// What all connections of a server share. Used only in the server's thread.
struct HttpSessions {
  using Kind = bool (HttpSession::*)() const;

  HttpLimits limits;
  HttpService service = {};
  std::shared_ptr<HttpPost> post = {};
  /// Bodies that have arrived, and whose requests are not answered.
  std::shared_ptr<std::atomic<std::size_t>> bodies =
      std::make_shared<std::atomic<std::size_t>>(std::size_t{0});
  std::set<HttpSession*> all = {};

  std::size_t count(Kind is) const;
  /// The one to be closed for another, or null: the oldest idle one, else the oldest.
  HttpSession* first_to_go(Kind is) const;
};

/// One connection of an `HttpServer`. Its pending operations own it: it ends with the last of them.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  using Clock = std::chrono::steady_clock;

  HttpSession(HttpSessions& server, boost::asio::ip::tcp::socket socket);
  ~HttpSession();
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;

  void begin();
  void tell_news();
  void tell_heartbeat();
  /// Also discards data that the system still buffers for a client that does not read it.
  void close();

  bool is_stranger() const { return is_open() && !is_known_; }
  bool is_known() const { return is_open() && is_known_; }
  bool is_stream() const { return is_open() && is_stream_; }
  bool is_receiving() const { return is_open() && is_receiving_; }
  bool gives_way_before(const HttpSession& other) const {
    return std::tuple(!is_idle_, since_) < std::tuple(!other.is_idle_, other.since_);
  }
  /// When it began, if it is a stranger's; else when it last got on.
  Clock::time_point since() const { return since_; }

 private:
  friend class DueAnswer;
  template <class Work>
  void attempt(Work work);
  template <class Next>
  auto guarded(Next next);
  template <class Next>
  void read(Next next);

  void await_head();
  void scan();
  void obey();
  void receive_body();
  void answer();
  void send(int asked, HttpAnswer answer);
  void send_piece();
  void finish_answer();
  void refuse(int status);
  void linger(std::size_t bytes);
  void begin_stream();
  void write_event(const std::shared_ptr<const std::string>& event);
  void part();
  void become_known();
  bool is_open() const { return stream_.socket().is_open(); }
  bool is_last() const;
  std::string head_text(const HttpAnswer& answer, std::optional<std::size_t> size) const;

  HttpSessions& server_;
  boost::beast::tcp_stream stream_;
  std::array<char, 16'384> chunk_;  // bytes read but not yet processed: [begin_, end_)
  std::size_t begin_ = 0, end_ = 0;
  HeadScanner scanner_;
  HttpHead head_ = {};
  HttpVerdict verdict_ = {};
  std::string body_ = {};
  boost::asio::steady_timer awaited_;  // keeps the session while its answer is awaited
  int asked_ = 0;                      // requests that were given to the service
  HttpAnswer answer_ = {};
  std::string answer_head_ = {};
  std::size_t sent_ = 0;  // of the answer's body
  int requests_ = 0;
  bool is_known_ = false;
  Clock::time_point since_ = Clock::now();
  bool is_idle_ = false;  // no byte of the next request has arrived yet
  bool is_answering_ = false;
  bool is_receiving_ = false;
  bool is_stream_ = false;
  bool is_writing_ = false;  // an event
  std::int64_t seen_ = -1;
};

}  // namespace pliant::viewer
