#include "viewer/http_session.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <string_view>
#include <utility>
#include <variant>

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
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

constexpr std::size_t piece_bytes = 262'144;  // of an answer, written within one deadline
constexpr int stream_buffer_bytes = 65'536;   // that the system buffers for a slow client
constexpr std::size_t most_lingering_bytes = 100'000'000;
constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";

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
  const std::string* expectation = head.find("expect");
  if (expectation != nullptr && !beast::iequals(*expectation, "100-continue")) return 417;
  if (head.find("upgrade") != nullptr) return 400;
  if (const std::string* size = head.find("content-length")) {
    // Beast also accepts a list of equal values.
    if (size->find_first_not_of("0123456789") != std::string::npos) return 400;
    head.body_size = parser.content_length().value_or(0);
  }
  return head;
}

}  // namespace

void HttpPost::open(asio::io_context& context) {
  const std::lock_guard lock(mutex_);
  context_ = &context;
}

void HttpPost::close() {
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
}

void HttpPost::send(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  if (context_ != nullptr) asio::post(*context_, std::move(work));
}

// The answer to a request, from any thread. Its body counts until then, whether or not the client
// is still there. A request that nobody will answer any more gets 503: there was no memory for it.
class DueAnswer {
 public:
  DueAnswer(const HttpSessions& server, std::weak_ptr<HttpSession> session, int asked,
            std::size_t bodies)
      : post_(server.post),
        session_(std::move(session)),
        asked_(asked),
        bodies_(bodies),
        all_bodies_(server.bodies) {
    *all_bodies_ += bodies;
  }
  DueAnswer(const DueAnswer&) = delete;
  DueAnswer& operator=(const DueAnswer&) = delete;
  ~DueAnswer() {
    try {
      if (!is_given_) give({.status = 503});
    } catch (...) {
      *all_bodies_ -= bodies_.exchange(0);
    }
  }

  void give(HttpAnswer answer) {
    *all_bodies_ -= bodies_.exchange(0);
    post_->send([session = session_, asked = asked_, answer = std::move(answer)]() mutable {
      if (const auto self = session.lock()) self->send(asked, std::move(answer));
    });
    is_given_ = true;
  }

 private:
  std::shared_ptr<HttpPost> post_;
  std::weak_ptr<HttpSession> session_;
  int asked_;
  std::atomic<bool> is_given_ = false;
  std::atomic<std::size_t> bodies_;  // that it still counts
  std::shared_ptr<std::atomic<std::size_t>> all_bodies_;
};

std::size_t HttpSessions::count(Kind is) const {
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const HttpSession* each) { return (each->*is)(); }));
}

HttpSession* HttpSessions::first_to_go(Kind is) const {
  HttpSession* first = nullptr;
  for (HttpSession* each : all) {
    if ((each->*is)() && (first == nullptr || each->gives_way_before(*first))) first = each;
  }
  return first;
}

HttpSession::HttpSession(HttpSessions& server, tcp::socket socket)
    : server_(server),
      stream_(std::move(socket)),
      scanner_(server.limits.head_bytes, server.limits.head_lines),
      awaited_(stream_.get_executor()) {
  server_.all.insert(this);
}

HttpSession::~HttpSession() { server_.all.erase(this); }

// An exception affects only this client. It is answered if no part of an answer has been sent yet.
template <class Work>
void HttpSession::attempt(Work work) {
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
auto HttpSession::guarded(Next next) {
  return [self = shared_from_this(), next](Code error, std::size_t count) {
    self->attempt([&] { next(error, count); });
  };
}

template <class Next>
void HttpSession::read(Next next) {
  stream_.async_read_some(asio::buffer(chunk_),
                          guarded([this, next](Code error, std::size_t count) {
                            if (error == asio::error::eof) return part();
                            if (error) return close();
                            begin_ = 0;
                            end_ = count;
                            next();
                          }));
}

// See the option in `begin`.
void HttpSession::close() {
  awaited_.cancel();
  stream_.close();
}

// Closes after the client has ended its side; data still buffered for it is delivered.
void HttpSession::part() {
  Code ignored;
  stream_.socket().set_option(asio::socket_base::linger(false, 0), ignored);
  close();
}

void HttpSession::begin() {
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

void HttpSession::await_head() {
  scanner_ = HeadScanner(server_.limits.head_bytes, server_.limits.head_lines);
  is_answering_ = false;
  is_idle_ = true;
  since_ = Clock::now();
  stream_.expires_after(server_.limits.idle);
  begin_ < end_ ? scan() : read([this] { scan(); });
}

void HttpSession::scan() {
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

void HttpSession::obey() {
  auto head = parse_head(scanner_.text());
  if (const int* status = std::get_if<int>(&head)) return refuse(*status);
  head_ = std::get<HttpHead>(std::move(head));
  verdict_ = server_.service.judge(head_);
  if (verdict_.status != 200) return refuse(verdict_.status);
  if (head_.body_size > verdict_.most_body) return refuse(413);
  become_known();
  if (verdict_.is_stream && server_.count(&HttpSession::is_stream) >= server_.limits.streams) {
    return refuse(503);
  }
  body_.clear();
  if (head_.body_size == 0) return answer();
  const std::size_t bodies = *server_.bodies + server_.count(&HttpSession::is_receiving);
  if (bodies >= server_.limits.bodies) return refuse(503);
  is_receiving_ = true;
  stream_.expires_after(server_.limits.body);
  if (head_.find("expect") == nullptr) return receive_body();
  asio::async_write(stream_, asio::buffer(go_on),
                    guarded([this](Code error, std::size_t) { error ? close() : receive_body(); }));
}

void HttpSession::become_known() {
  if (is_known_) return;
  if (server_.count(&HttpSession::is_known) >= server_.limits.connections)
    server_.first_to_go(&HttpSession::is_known)->close();
  is_known_ = true;
  since_ = Clock::now();
}

// The body grows with the bytes received, not with the announced size.
void HttpSession::receive_body() {
  const std::size_t missing = static_cast<std::size_t>(head_.body_size) - body_.size();
  const std::size_t count = std::min(missing, end_ - begin_);
  body_.append(chunk_.data() + begin_, count);
  begin_ += count;
  since_ = Clock::now();
  if (count < missing) return read([this] { receive_body(); });
  is_receiving_ = false;
  answer();
}

void HttpSession::answer() {
  const std::size_t bodies = head_.body_size > 0 ? 1 : 0;
  const auto due = std::make_shared<DueAnswer>(server_, weak_from_this(), ++asked_, bodies);
  awaited_.expires_at(Clock::time_point::max());
  awaited_.async_wait([self = shared_from_this()](Code) {});
  stream_.expires_never();
  server_.service.answer(head_, std::exchange(body_, {}),
                         [due](HttpAnswer answer) { due->give(std::move(answer)); });
}

// A reply that comes again, or for an earlier request, is not that of the request that waits.
void HttpSession::send(int asked, HttpAnswer answer) {
  if (asked_ != asked || is_answering_ || !is_open()) return;
  attempt([&] {
    awaited_.cancel();
    answer_ = std::move(answer);
    if (answer_.status >= 400 && !answer_.body) return refuse(answer_.status);
    ++requests_;
    if (!answer_.body) answer_.body = std::make_shared<const std::string>();
    sent_ = 0;
    const auto size = verdict_.is_stream ? std::nullopt : std::optional(answer_.body->size());
    answer_head_ = head_text(answer_, size);
    is_answering_ = true;
    send_piece();
  });
}

// Whether this is the last request answered on this connection.
bool HttpSession::is_last() const {
  const std::string* wish = head_.find("connection");
  return requests_ >= server_.limits.requests || (wish && beast::iequals(*wish, "close"));
}

std::string HttpSession::head_text(const HttpAnswer& answer,
                                   std::optional<std::size_t> size) const {
  const auto reason = http::obsolete_reason(static_cast<http::status>(answer.status));
  const bool is_kept = size && (answer.status < 400 || answer.body) && !is_last();
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
void HttpSession::send_piece() {
  const std::size_t count = std::min(piece_bytes, answer_.body->size() - sent_);
  const std::array<asio::const_buffer, 2> parts = {
      asio::buffer(answer_head_.data(), sent_ == 0 ? answer_head_.size() : 0),
      asio::buffer(answer_.body->data() + sent_, count)};
  stream_.expires_after(server_.limits.write);
  asio::async_write(stream_, parts, guarded([this, count](Code error, std::size_t) {
                      if (error) return close();
                      sent_ += count;
                      since_ = Clock::now();
                      sent_ < answer_.body->size() ? send_piece() : finish_answer();
                    }));
}

void HttpSession::finish_answer() {
  answer_ = {};
  if (verdict_.is_stream) return begin_stream();
  if (is_last()) return linger(0);
  await_head();
}

void HttpSession::refuse(int status) {
  awaited_.cancel();
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
void HttpSession::linger(std::size_t bytes) {
  if (bytes == 0) {
    Code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(server_.limits.linger);
  }
  if (bytes > most_lingering_bytes) return close();
  read([this, bytes] { linger(bytes + end_); });
}

void HttpSession::begin_stream() {
  if (begin_ < end_) return linger(0);  // a client must not send on a stream
  is_stream_ = true;
  Code ignored;  // on failure the system chooses the size
  stream_.socket().set_option(asio::socket_base::send_buffer_size(stream_buffer_bytes), ignored);
  stream_.expires_never();
  read([this] { close(); });  // close if the client disconnects or sends
  tell_news();
}

void HttpSession::tell_news() {
  attempt([this] {
    if (!is_stream_ || is_writing_) return;
    if (const auto event = server_.service.next_event(seen_)) write_event(event);
  });
}

void HttpSession::tell_heartbeat() {
  attempt([this] {
    static const auto sign = std::make_shared<const std::string>(": still here\n\n");
    if (is_stream_ && !is_writing_) write_event(sign);
  });
}

// One event at a time: events that happen meanwhile are queried after it.
void HttpSession::write_event(const std::shared_ptr<const std::string>& event) {
  is_writing_ = true;
  stream_.expires_after(server_.limits.write);
  const auto text = asio::buffer(*event);
  asio::async_write(stream_, text, guarded([this, event](Code error, std::size_t) {
                      is_writing_ = false;
                      since_ = Clock::now();
                      error ? close() : tell_news();
                    }));
}

}  // namespace pliant::viewer
