#include "viewer/http_server.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <optional>
#include <set>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>
#include <fmt/format.h>

namespace pliant::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using tcp = asio::ip::tcp;
using Code = boost::system::error_code;

constexpr const char* this_machine = "127.0.0.1";
constexpr std::size_t piece_bytes = 262'144;  // of an answer, written within one deadline
constexpr int stream_buffer_bytes = 65'536;   // that the system buffers for a slow client
constexpr std::size_t most_lingering_bytes = 1'000'000;

// Fields of every answer: no caching, no guessing of its type, use by pages of this server only, no
// display in frames, and no referrer, since the address contains the token.
constexpr std::string_view common_fields =
    "Cache-Control: no-store\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "X-Frame-Options: DENY\r\n";

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& letter : result) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return result;
}

// The parsed head, or the status to refuse it with. `text`: a complete head.
std::variant<HttpHead, int> parse_head(const std::string& text) {
  http::request_parser<http::empty_body> parser;
  parser.header_limit(static_cast<std::uint32_t>(text.size() + 1));
  parser.skip(true);  // we read the body ourselves
  Code error;
  const std::size_t taken = parser.put(asio::buffer(text), error);
  if (error || taken != text.size() || !parser.is_header_done()) return 400;
  HttpHead head;
  const auto& request = parser.get();
  head.method = std::string(request.method_string());
  head.target = std::string(request.target());
  for (const auto& field : request) {
    std::string name = lower({field.name_string().data(), field.name_string().size()});
    if (head.find(name) != nullptr) return 400;  // a duplicate field is ambiguous
    head.fields.push_back({std::move(name), std::string(field.value())});
  }
  if (head.find("transfer-encoding") != nullptr) return 501;
  if (head.find("expect") != nullptr) return 417;
  if (head.find("upgrade") != nullptr) return 400;
  if (const std::string* size = head.find("content-length")) {
    // Beast also accepts a list of equal values.
    if (size->find_first_not_of("0123456789") != std::string::npos) return 400;
    head.body_size = parser.content_length().value_or(0);
  }
  return head;
}

class Session;

// State shared by all connections. Used only in the server's thread.
struct Shared {
  HttpLimits limits;
  HttpService service = {};
  std::set<Session*> sessions = {};
};

// One connection. Its pending operations own it: it ends with the last of them.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Shared& server, tcp::socket socket);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void begin();
  void tell_news();
  void tell_heartbeat();

  bool is_stream() const { return is_stream_; }
  bool is_receiving() const { return is_receiving_; }

 private:
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
  void send_piece();
  void finish_answer();
  void refuse(int status);
  void linger(std::size_t bytes);
  void begin_stream();
  void write_event(const std::shared_ptr<const std::string>& event);
  void close();
  void part();
  bool is_last() const;
  std::string head_text(const HttpAnswer& answer, std::optional<std::size_t> size) const;

  Shared& server_;
  beast::tcp_stream stream_;
  std::array<char, 16'384> chunk_;  // bytes read but not yet processed: [begin_, end_)
  std::size_t begin_ = 0, end_ = 0;
  HeadScanner scanner_;
  HttpHead head_ = {};
  HttpVerdict verdict_ = {};
  std::string body_ = {};
  HttpAnswer answer_ = {};
  std::string answer_head_ = {};
  std::size_t sent_ = 0;  // of the answer's body
  int requests_ = 0;
  bool is_idle_ = false;  // no byte of the next request has arrived yet
  bool is_answering_ = false;
  bool is_receiving_ = false;
  bool is_stream_ = false;
  bool is_writing_ = false;  // an event
  std::int64_t seen_ = -1;
};

Session::Session(Shared& server, tcp::socket socket)
    : server_(server),
      stream_(std::move(socket)),
      scanner_(server.limits.head_bytes, server.limits.head_lines) {
  server_.sessions.insert(this);
}

Session::~Session() { server_.sessions.erase(this); }

// An exception affects only this client. It is answered if no part of an answer has been sent yet.
template <class Work>
void Session::attempt(Work work) {
  const auto give_up = [this](int status) {
    try {
      is_answering_ ? close() : refuse(status);
    } catch (...) {
      close();
    }
  };
  try {
    work();
  } catch (const std::bad_alloc&) {
    give_up(503);
  } catch (...) {
    give_up(500);
  }
}

template <class Next>
auto Session::guarded(Next next) {
  return [self = shared_from_this(), next](Code error, std::size_t count) {
    self->attempt([&] { next(error, count); });
  };
}

template <class Next>
void Session::read(Next next) {
  stream_.async_read_some(asio::buffer(chunk_),
                          guarded([this, next](Code error, std::size_t count) {
                            if (error == asio::error::eof) return part();
                            if (error) return close();
                            begin_ = 0;
                            end_ = count;
                            next();
                          }));
}

// Also discards data that the system still buffers for a client that does not read it (see
// `begin`).
void Session::close() { stream_.close(); }

// Closes after the client has ended its side; data still buffered for it is delivered.
void Session::part() {
  Code ignored;
  stream_.socket().set_option(asio::socket_base::linger(false, 0), ignored);
  close();
}

void Session::begin() {
  attempt([this] {
    tcp::socket& socket = stream_.socket();
    socket.set_option(tcp::no_delay(true));
    socket.set_option(asio::socket_base::send_buffer_size(static_cast<int>(piece_bytes)));
    // After a deadline the connection is reset, and the system keeps no data of it.
    socket.set_option(asio::socket_base::linger(true, 0));
    stream_.expires_after(server_.limits.head);
    read([this] { scan(); });
  });
}

void Session::await_head() {
  scanner_ = HeadScanner(server_.limits.head_bytes, server_.limits.head_lines);
  is_answering_ = false;
  is_idle_ = true;
  stream_.expires_after(server_.limits.idle);
  begin_ < end_ ? scan() : read([this] { scan(); });
}

void Session::scan() {
  if (std::exchange(is_idle_, false)) stream_.expires_after(server_.limits.head);
  while (begin_ < end_) {
    switch (scanner_.take(chunk_[begin_++])) {
      case HeadScanner::State::More:
        break;
      case HeadScanner::State::Complete:
        return obey();
      case HeadScanner::State::Malformed:
        return refuse(400);
      case HeadScanner::State::TooLarge:
        return refuse(431);
    }
  }
  read([this] { scan(); });
}

void Session::obey() {
  auto head = parse_head(scanner_.text());
  if (const int* status = std::get_if<int>(&head)) return refuse(*status);
  head_ = std::get<HttpHead>(std::move(head));
  verdict_ = server_.service.judge(head_);
  if (verdict_.status != 200) return refuse(verdict_.status);
  if (head_.body_size > verdict_.most_body) return refuse(413);
  const auto count = [&](bool (Session::*is)() const) {
    return static_cast<std::size_t>(
        std::count_if(server_.sessions.begin(), server_.sessions.end(),
                      [&](const Session* each) { return (each->*is)(); }));
  };
  if (verdict_.is_stream && count(&Session::is_stream) >= server_.limits.streams) {
    return refuse(503);
  }
  body_.clear();
  if (head_.body_size == 0) return answer();
  if (count(&Session::is_receiving) >= server_.limits.bodies) return refuse(503);
  is_receiving_ = true;
  stream_.expires_after(server_.limits.body);
  receive_body();
}

// The body grows with the bytes received, not with the announced size.
void Session::receive_body() {
  const std::size_t missing = static_cast<std::size_t>(head_.body_size) - body_.size();
  const std::size_t count = std::min(missing, end_ - begin_);
  body_.append(chunk_.data() + begin_, count);
  begin_ += count;
  if (count < missing) return read([this] { receive_body(); });
  is_receiving_ = false;
  answer();
}

void Session::answer() {
  answer_ = server_.service.answer(head_, std::exchange(body_, {}));
  if (answer_.status >= 400) return refuse(answer_.status);
  ++requests_;
  if (!answer_.body) answer_.body = std::make_shared<const std::string>();
  sent_ = 0;
  const auto size = verdict_.is_stream ? std::nullopt : std::optional(answer_.body->size());
  answer_head_ = head_text(answer_, size);
  is_answering_ = true;
  send_piece();
}

// Whether this is the last request answered on this connection.
bool Session::is_last() const {
  const std::string* wish = head_.find("connection");
  return requests_ >= server_.limits.requests || (wish && beast::iequals(*wish, "close"));
}

std::string Session::head_text(const HttpAnswer& answer, std::optional<std::size_t> size) const {
  const auto reason = http::obsolete_reason(static_cast<http::status>(answer.status));
  const bool is_kept = size && answer.status < 400 && !is_last();
  std::string text = fmt::format("HTTP/1.1 {} {}\r\n", answer.status,
                                 std::string_view(reason.data(), reason.size()));
  if (!answer.type.empty()) text += fmt::format("Content-Type: {}\r\n", answer.type);
  if (size) text += fmt::format("Content-Length: {}\r\n", *size);
  text += is_kept ? "Connection: keep-alive\r\n" : "Connection: close\r\n";
  text += fmt::format("Content-Security-Policy: {}; frame-ancestors 'none'\r\n{}\r\n",
                      answer.policy, common_fields);
  return text;
}

// The first piece includes the head.
void Session::send_piece() {
  const std::size_t count = std::min(piece_bytes, answer_.body->size() - sent_);
  const std::array<asio::const_buffer, 2> parts = {
      asio::buffer(answer_head_.data(), sent_ == 0 ? answer_head_.size() : 0),
      asio::buffer(answer_.body->data() + sent_, count)};
  stream_.expires_after(server_.limits.write);
  asio::async_write(stream_, parts, guarded([this, count](Code error, std::size_t) {
                      if (error) return close();
                      sent_ += count;
                      sent_ < answer_.body->size() ? send_piece() : finish_answer();
                    }));
}

void Session::finish_answer() {
  answer_ = {};
  if (verdict_.is_stream) return begin_stream();
  if (is_last()) return linger(0);
  await_head();
}

void Session::refuse(int status) {
  answer_head_ = head_text({.status = status}, 0);
  is_answering_ = true;
  is_receiving_ = false;
  body_ = {};
  stream_.expires_after(server_.limits.write);
  asio::async_write(stream_, asio::buffer(answer_head_),
                    guarded([this](Code error, std::size_t) { error ? close() : linger(0); }));
}

// A client that is still sending would not receive the last answer if the connection were closed at
// once. So bytes that arrive are discarded, up to a limit and for a short time.
void Session::linger(std::size_t bytes) {
  if (bytes == 0) {
    Code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(server_.limits.linger);
  }
  if (bytes > most_lingering_bytes) return close();
  read([this, bytes] { linger(bytes + end_); });
}

void Session::begin_stream() {
  if (begin_ < end_) return linger(0);  // a client must not send on a stream
  is_stream_ = true;
  Code ignored;  // on failure the system chooses the size
  stream_.socket().set_option(asio::socket_base::send_buffer_size(stream_buffer_bytes), ignored);
  stream_.expires_never();
  read([this] { close(); });  // close if the client disconnects or sends
  tell_news();
}

void Session::tell_news() {
  attempt([this] {
    if (!is_stream_ || is_writing_) return;
    if (const auto event = server_.service.next_event(seen_)) write_event(event);
  });
}

void Session::tell_heartbeat() {
  attempt([this] {
    static const auto sign = std::make_shared<const std::string>(": still here\n\n");
    if (is_stream_ && !is_writing_) write_event(sign);
  });
}

// One event at a time: events that happen meanwhile are queried after it.
void Session::write_event(const std::shared_ptr<const std::string>& event) {
  is_writing_ = true;
  stream_.expires_after(server_.limits.write);
  const auto text = asio::buffer(*event);
  asio::async_write(stream_, text, guarded([this, event](Code error, std::size_t) {
                      is_writing_ = false;
                      error ? close() : tell_news();
                    }));
}

}  // namespace

struct HttpServer::State {
  Shared shared;  // before the context, whose destructor ends the last sessions
  bool is_accepting = false;
  bool is_beating = false;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer rest{context};
  asio::steady_timer heartbeat{context};
  std::thread thread = {};

  explicit State(const HttpLimits& limits) : shared{.limits = limits} {}
  void run();
  void accept();
  void take(tcp::socket socket);
  void beat();
};

void HttpServer::State::accept() {
  is_accepting = true;
  acceptor.async_accept([this](Code error, tcp::socket socket) {
    is_accepting = false;
    if (!error) {
      take(std::move(socket));
      return accept();
    }
    // Most likely no file descriptors are left: try again later.
    is_accepting = true;
    rest.expires_after(std::chrono::milliseconds(50));
    rest.async_wait([this](Code) { accept(); });
  });
}

void HttpServer::State::take(tcp::socket socket) {
  if (shared.sessions.size() >= shared.limits.connections) return;  // its destructor closes it
  std::make_shared<Session>(shared, std::move(socket))->begin();
}

void HttpServer::State::beat() {
  is_beating = true;
  heartbeat.expires_after(shared.limits.heartbeat);
  heartbeat.async_wait([this](Code) {
    is_beating = false;
    for (Session* session : shared.sessions) session->tell_heartbeat();
    beat();
  });
}

// Runs until it is stopped. The only exception here is lack of memory for our own work; then it
// tries again.
void HttpServer::State::run() {
  while (!context.stopped()) {
    try {
      if (!is_accepting) accept();
      if (!is_beating) beat();
      context.run();
    } catch (...) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
}

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
HttpServer::HttpServer(HttpServer&&) noexcept = default;

Result<HttpServer> HttpServer::listen(int port, const HttpLimits& limits) {
  auto state = std::make_unique<State>(limits);
  const tcp::endpoint place(asio::ip::make_address_v4(this_machine),
                            static_cast<unsigned short>(port));
  Code error;
  tcp::acceptor& acceptor = state->acceptor;
  acceptor.open(place.protocol(), error);
  // Not SO_REUSEPORT, which would let two commands share a port, each with half of the requests.
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(place, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    return fail(ErrorCode::Unwritable,
                fmt::format("cannot listen on {}:{}: the port is in use or not allowed; choose "
                            "another, or 0 for any free port",
                            this_machine, port));
  }
  return HttpServer(std::move(state));
}

HttpServer::~HttpServer() {
  if (!state_) return;
  state_->context.stop();
  if (state_->thread.joinable()) state_->thread.join();
}

int HttpServer::port() const { return state_->acceptor.local_endpoint().port(); }

void HttpServer::serve(HttpService service) {
  state_->shared.service = std::move(service);
  state_->thread = std::thread([state = state_.get()] { state->run(); });
}

void HttpServer::notify() {
  asio::post(state_->context, [state = state_.get()] {
    for (Session* session : state->shared.sessions) session->tell_news();
  });
}

}  // namespace pliant::viewer
