#include "viewer/server.hpp"

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "viewer/gate.hpp"
#include "viewer/http_server.hpp"
#include "viewer/page.hpp"

namespace pliant::viewer {
namespace {

using Text = std::shared_ptr<const std::string>;

constexpr std::string_view working = "working", failed = "failed", baked = "baked";

std::size_t pixel_bytes(PictureSize size) {
  return std::size_t{4} * static_cast<std::size_t>(size.width) *
         static_cast<std::size_t>(size.height);
}

std::size_t longest_picture(const PictureOrder& order) {
  return order.form == PictureForm::Png ? longest_png(order.size) : pixel_bytes(order.size);
}

Result<void> check_picture(std::string_view bytes, const PictureOrder& order,
                           const StopRequest& should_stop) {
  if (order.form == PictureForm::Png) return check_png(bytes, order.size, should_stop);
  if (bytes.size() == pixel_bytes(order.size)) return {};
  return invalid(fmt::format("it has {} bytes, not those of {} x {} pixels", bytes.size(),
                             order.size.width, order.size.height));
}

}  // namespace

struct ViewServer::State {
  std::string policy;
  Text page;
  Gate gate;

  std::mutex mutex;  // guards the members up to `pictures`
  Text packed = std::make_shared<const std::string>();
  int bake_number = 0;  // of `packed`; 0: none yet
  std::string_view status = working;
  std::string messages = "[]";    // of the last bake that ended, if it failed
  std::int64_t event_number = 0;  // counts changes of these
  bool was_ordered = false;
  std::deque<PictureOrder> orders = {};           // whose pictures have not arrived
  std::deque<Result<std::string>> pictures = {};  // that have not been taken

  std::atomic<bool> is_ending = false;
  HttpServer server;  // last, so that its thread ends before the members it uses

  State(std::string text, Gate rules, HttpServer http)
      : policy(policy_of(text)),
        page(std::make_shared<const std::string>(std::move(text))),
        gate(std::move(rules)),
        server(std::move(http)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { is_ending = true; }

  void tell(std::string_view what, std::optional<std::string> told = {}) {
    {
      const std::lock_guard lock(mutex);
      status = what;
      if (told) messages = *std::move(told);
      ++event_number;
    }
    server.notify();
  }

  // An event is all that a page needs to know, so that each page shows the same, whenever it was
  // opened and whatever it has missed: what happens, the bake to show, and why the last one failed.
  Text next_event(std::int64_t& seen) {
    const std::lock_guard lock(mutex);
    if (std::exchange(seen, event_number) == event_number) return nullptr;
    return std::make_shared<const std::string>(fmt::format(
        "event: {}\ndata: {{\"bake\":{},\"messages\":{}}}\n\n", status, bake_number, messages));
  }

  HttpVerdict judge(const HttpHead& head) {
    const auto judged = gate.judge(head);
    if (const auto* refusal = std::get_if<Refusal>(&judged)) return {.status = refusal->status};
    const auto route = static_cast<ViewRoute>(std::get<std::size_t>(judged));
    const std::lock_guard lock(mutex);
    switch (route) {
      case ViewRoute::Page:
        return {};
      case ViewRoute::Events:
        return {.is_stream = true};
      case ViewRoute::Bake:
        return {.status = bake_number > 0 ? 200 : 404};
      case ViewRoute::PicturePage:
      case ViewRoute::Job:
        return {.status = was_ordered ? 200 : 404};
      case ViewRoute::Picture:
        if (!was_ordered) return {.status = 404};
        if (orders.empty()) return {.status = 409};
        return {.most_body = longest_picture(orders.front())};
    }
    return {.status = 404};
  }

  // Requires: `judge` accepted the head.
  HttpAnswer answer(const HttpHead& head, std::string body) {
    const auto judged = gate.judge(head);
    const auto route = static_cast<ViewRoute>(std::get<std::size_t>(judged));
    if (route == ViewRoute::Picture) return take(std::move(body));
    const std::lock_guard lock(mutex);
    switch (route) {
      case ViewRoute::Page:
      case ViewRoute::PicturePage:
        return {.type = "text/html; charset=utf-8", .body = page, .policy = policy};
      case ViewRoute::Events:
        return {.type = "text/event-stream"};
      case ViewRoute::Bake:
        return {.type = "application/octet-stream", .body = packed};
      case ViewRoute::Job:
        return jobs();
      case ViewRoute::Picture:
        break;
    }
    return {.status = 404};
  }

  // The jobs whose pictures have not arrived. Requires: the mutex is held.
  HttpAnswer jobs() const {
    std::string text = "[";
    for (const PictureOrder& order : orders) text += (text.size() > 1 ? "," : "") + order.job;
    return {.type = "application/json",
            .body = std::make_shared<const std::string>(std::move(text) + "]")};
  }

  HttpAnswer take(std::string body) {
    PictureOrder order;
    {
      const std::lock_guard lock(mutex);
      if (orders.empty()) return {.status = 409};  // another client was faster
      order = std::move(orders.front());
      orders.pop_front();
    }
    // Without the lock, since a large picture takes its time.
    const auto checked = check_picture(body, order, [this] { return is_ending.load(); });
    const std::lock_guard lock(mutex);
    if (!checked) {
      pictures.emplace_back(fail(checked.error()));
      return {.status = 400};
    }
    pictures.emplace_back(std::move(body));
    return jobs();
  }
};

ViewServer::ViewServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewServer::ViewServer(ViewServer&&) noexcept = default;
ViewServer::~ViewServer() = default;

Result<ViewServer> ViewServer::start(std::string page, int port) {
  auto token = make_token();
  if (!token) return fail(token.error());
  auto server = HttpServer::listen(port);
  if (!server) return fail(server.error());
  Gate gate(*std::move(token), server->port(), view_routes());
  auto state = std::make_unique<State>(std::move(page), std::move(gate), *std::move(server));
  State& its = *state;
  its.server.serve(
      {.judge = [&its](const HttpHead& head) { return its.judge(head); },
       .answer = [&its](const HttpHead& head, std::string body,
                        const HttpReply& reply) { reply(its.answer(head, std::move(body))); },
       .next_event = [&its](std::int64_t& seen) { return its.next_event(seen); }});
  return ViewServer(std::move(state));
}

std::string ViewServer::address() const { return state_->gate.address(); }

void ViewServer::publish(std::string packed) {
  auto shared = std::make_shared<const std::string>(std::move(packed));
  {
    const std::lock_guard lock(state_->mutex);
    state_->packed = std::move(shared);
    ++state_->bake_number;
  }
  state_->tell(baked, "[]");
}

void ViewServer::tell_working() { state_->tell(working); }

void ViewServer::tell_failure(const std::string& messages) { state_->tell(failed, messages); }

void ViewServer::order_picture(PictureOrder order) {
  const std::lock_guard lock(state_->mutex);
  state_->orders.push_back(std::move(order));
  state_->was_ordered = true;
}

std::optional<Result<std::string>> ViewServer::take_picture() {
  const std::lock_guard lock(state_->mutex);
  if (state_->pictures.empty()) return {};
  auto picture = std::move(state_->pictures.front());
  state_->pictures.pop_front();
  return picture;
}

}  // namespace pliant::viewer
