#include "view_server.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>

namespace pliant::cli {
namespace {

constexpr const char* this_machine = "127.0.0.1";
constexpr auto heartbeat = std::chrono::seconds(2);

// A server-sent event.
std::string event_text(std::string_view name, std::string_view data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, data);
}

}  // namespace

struct ViewServer::State {
  httplib::Server server;
  std::thread listener;
  std::atomic<bool> has_ended = false;
  std::string page;
  int port = 0;

  std::mutex mutex;  // of all below
  std::condition_variable changed;
  bool is_stopping = false;
  std::string packed;
  int bake_number = 0;   // of `packed`; 0: none yet
  std::string event;     // the last one
  int event_number = 0;  // counts them
  std::string job = "{}";
  std::optional<std::string> picture;

  // Requires: the mutex is held.
  std::string baked_text() const { return event_text("baked", std::to_string(bake_number)); }

  void tell(std::string text) {
    {
      const std::lock_guard lock(mutex);
      event = std::move(text);
      ++event_number;
    }
    changed.notify_all();
  }

  bool is_asked_by_name(const httplib::Request& request) const {
    const std::string host = request.get_header_value("Host");
    const std::array<std::string, 2> names = {fmt::format("{}:{}", this_machine, port),
                                              fmt::format("localhost:{}", port)};
    const std::string origin = request.get_header_value("Origin");
    bool is_host = false, is_origin = origin.empty();
    for (const std::string& name : names) {
      is_host = is_host || host == name;
      is_origin = is_origin || origin == "http://" + name;
    }
    return is_host && is_origin;
  }

  // What has happened since, until the page goes away. A new page hears of the last bake first.
  void follow(httplib::Response& response) {
    response.set_chunked_content_provider(
        "text/event-stream", [this, seen = -1](std::size_t, httplib::DataSink& sink) mutable {
          std::string text;
          {
            std::unique_lock lock(mutex);
            changed.wait_for(lock, heartbeat, [&] { return is_stopping || seen != event_number; });
            if (is_stopping) return false;
            if (seen < 0 && bake_number > 0 && event != baked_text()) {
              text = baked_text();
            }
            if (std::exchange(seen, event_number) != event_number) text += event;
          }
          // A piece of no bytes would end the stream: for a page ahead of the first event.
          if (text.empty()) text = ": still here\n\n";
          return sink.write(text.data(), text.size());
        });
  }

  void add_routes() {
    server.set_default_headers({{"Cache-Control", "no-store"},
                                {"X-Content-Type-Options", "nosniff"},
                                {"Cross-Origin-Resource-Policy", "same-origin"}});
    server.set_pre_routing_handler([this](const auto& request, auto& response) {
      if (is_asked_by_name(request)) return httplib::Server::HandlerResponse::Unhandled;
      response.status = 403;
      return httplib::Server::HandlerResponse::Handled;
    });
    const auto send_page = [this](const auto&, auto& response) {
      response.set_content(page, "text/html; charset=utf-8");
    };
    server.Get("/", send_page);
    server.Get("/take", send_page);
    server.Get("/events", [this](const auto&, auto& response) { follow(response); });
    server.Get("/bake", [this](const auto&, auto& response) {
      const std::lock_guard lock(mutex);
      response.status = bake_number > 0 ? 200 : 404;
      response.set_content(packed, "application/octet-stream");
    });
    server.Get("/job", [this](const auto&, auto& response) {
      const std::lock_guard lock(mutex);
      response.set_content(job, "application/json");
    });
    server.Post("/picture", [this](const auto& request, auto&) {
      {
        const std::lock_guard lock(mutex);
        picture = request.body;
      }
      changed.notify_all();
    });
  }
};

ViewServer::ViewServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewServer::ViewServer(ViewServer&&) noexcept = default;

Result<ViewServer> ViewServer::start(std::string page, int port) {
  auto state = std::make_unique<State>();
  state->page = std::move(page);
  // One for each page that is open and listens, and some for what they fetch.
  constexpr std::size_t most_connections = 64;
  state->server.new_task_queue = [] { return new httplib::ThreadPool(most_connections); };
  // Without SO_REUSEPORT, which would let two commands share a port, each with half the requests.
  state->server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  state->add_routes();
  if (port == 0) {
    state->port = state->server.bind_to_any_port(this_machine);
  } else if (state->server.bind_to_port(this_machine, port)) {
    state->port = port;
  }
  if (state->port <= 0) {
    return fail(
        ErrorCode::Unwritable,
        fmt::format("cannot listen on {}:{}: the port is taken or not allowed; name another "
                    "one, or 0 for any that is free",
                    this_machine, port));
  }
  state->listener = std::thread([raw = state.get()] {
    raw->server.listen_after_bind();
    raw->has_ended = true;
  });
  while (!state->server.is_running() && !state->has_ended) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return ViewServer(std::move(state));
}

ViewServer::~ViewServer() {
  if (!state_) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_stopping = true;
  }
  state_->changed.notify_all();
  state_->server.stop();
  state_->listener.join();
}

int ViewServer::port() const { return state_->port; }

void ViewServer::publish(std::string packed) {
  std::string text;
  {
    const std::lock_guard lock(state_->mutex);
    state_->packed = std::move(packed);
    ++state_->bake_number;
    text = state_->baked_text();
  }
  state_->tell(std::move(text));
}

void ViewServer::tell_working() { state_->tell(event_text("working", "")); }

void ViewServer::tell_failure(std::string messages) {
  state_->tell(event_text("failed", messages));
}

void ViewServer::order_picture(std::string job) {
  const std::lock_guard lock(state_->mutex);
  state_->job = std::move(job);
}

std::optional<std::string> ViewServer::take_picture() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->picture, std::nullopt);
}

}  // namespace pliant::cli
