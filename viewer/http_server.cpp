#include "viewer/http_server.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>

#include "viewer/http_session.hpp"

namespace pliant::viewer {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using Code = boost::system::error_code;
using Clock = HttpSession::Clock;

constexpr const char* this_machine = "127.0.0.1";

}  // namespace

struct HttpServer::State {
  std::shared_ptr<HttpPost> post = std::make_shared<HttpPost>();
  HttpSessions shared;  // before the context, whose destructor ends the last sessions
  bool is_accepting = false;
  bool is_short_of_descriptors = false;
  bool is_beating = false;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer rest{context};
  asio::steady_timer heartbeat{context};
  std::thread thread = {};

  explicit State(const HttpLimits& limits) : shared{.limits = limits, .post = post} {
    post->open(context);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { post->close(); }
  void run();
  void accept();
  void accept_after(Clock::duration pause);
  void close_oldest_stranger();
  Clock::duration pause_before_next() const;
  void beat();
};

void HttpServer::State::accept() {
  is_accepting = true;
  if (const auto pause = pause_before_next(); pause > pause.zero()) return accept_after(pause);
  acceptor.async_accept([this](Code error, tcp::socket socket) {
    is_accepting = false;
    if (error) {
      // Most likely no file descriptors are left.
      is_short_of_descriptors = true;
      return accept_after(std::chrono::milliseconds(50));
    }
    if (shared.count(&HttpSession::is_stranger) >= shared.limits.strangers) close_oldest_stranger();
    std::make_shared<HttpSession>(shared, std::move(socket))->begin();
    accept();
  });
}

void HttpServer::State::accept_after(Clock::duration pause) {
  is_accepting = true;
  rest.expires_after(pause);
  rest.async_wait([this](Code) {
    if (std::exchange(is_short_of_descriptors, false)) close_oldest_stranger();
    accept();
  });
}

void HttpServer::State::close_oldest_stranger() {
  if (HttpSession* oldest = shared.first_to_go(&HttpSession::is_stranger)) oldest->close();
}

// In a flood of connections each has some time for its first request; the others wait in the
// system.
Clock::duration HttpServer::State::pause_before_next() const {
  if (shared.count(&HttpSession::is_stranger) < shared.limits.strangers) return {};
  return shared.first_to_go(&HttpSession::is_stranger)->since() + shared.limits.chance -
         Clock::now();
}

void HttpServer::State::beat() {
  is_beating = true;
  heartbeat.expires_after(shared.limits.heartbeat);
  heartbeat.async_wait([this](Code) {
    is_beating = false;
    for (HttpSession* session : shared.all) session->tell_heartbeat();
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
    for (HttpSession* session : state->shared.all) session->tell_news();
  });
}

}  // namespace pliant::viewer
