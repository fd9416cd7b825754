#include "editor/edit_server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "editor/motion.hpp"
#include "editor/query.hpp"
#include "editor/worker.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/json/json_reader.hpp"
#include "pliant/scene/format/format_json.hpp"
#include "viewer/gate.hpp"
#include "viewer/page.hpp"

namespace pliant::editor {
namespace {

using viewer::Gate;
using viewer::HttpHead;
using viewer::HttpReply;
using viewer::HttpServer;
using viewer::HttpVerdict;
using viewer::Route;

constexpr std::size_t most_body = 16'000'000;

using OnBody = HttpAnswer (EditSession::*)(const Body&);

// What a POST does in the session.
struct Posted {
  std::string_view place;
  OnBody act;
};
constexpr std::array<Posted, 10> changes = {{{"operations", &EditSession::operations},
                                             {"undo", &EditSession::undo},
                                             {"redo", &EditSession::redo},
                                             {"save", &EditSession::save},
                                             {"load", &EditSession::load},
                                             {"open", &EditSession::open_file},
                                             {"restore", &EditSession::restore},
                                             {"discard", &EditSession::discard},
                                             {"keep", &EditSession::keep},
                                             {"take", &EditSession::take}}};

// The same for what takes long. One that is overtaken by another revision begins again, unless it
// is about what was there.
struct LongPosted {
  std::string_view place;
  Begun (EditSession::*act)(const Body&);
  bool begins_again = true;
};
constexpr std::array<LongPosted, 4> long_changes = {{{"new", &EditSession::begin},
                                                     {"add", &EditSession::add},
                                                     {"material", &EditSession::material},
                                                     {"motion", &EditSession::motion, false}}};

constexpr std::array routes = {
    Route{""},
    Route{"events"},
    Route{"document"},
    Route{"format"},
    Route{"starters"},
    Route{"takes"},
    Route{.place = "objects", .has_query = true},
    Route{.place = "frame", .has_query = true},
    Route{.place = "scene", .has_query = true},
    Route{.place = "details", .has_query = true},
    Route{.place = "shape", .has_query = true},
    Route{.place = "picture", .has_query = true},
    Route{.place = "motion", .has_query = true},
    Route{"motion", "POST"},
    Route{"export", "POST"},
    Route{"operations", "POST"},
    Route{"undo", "POST"},
    Route{"redo", "POST"},
    Route{"save", "POST"},
    Route{"load", "POST"},
    Route{"new", "POST"},
    Route{"open", "POST"},
    Route{"restore", "POST"},
    Route{"discard", "POST"},
    Route{"keep", "POST"},
    Route{"take", "POST"},
    Route{"add", "POST"},
    Route{"material", "POST"},
};

HttpAnswer to_answer(const FrameAnswer& answer, const char* type) {
  if (!answer) return refusal(409, "there is another revision by now");
  if (!*answer) return refusal((*answer).error());
  return {.type = type, .body = **answer};
}

HttpAnswer shape_answer(std::shared_ptr<const std::string> shape) {
  if (!shape) return {.status = 404};
  return {.type = "application/octet-stream", .body = std::move(shape)};
}

// The part of a Content-Type before its parameters.
bool is_json(std::string_view type) {
  type = type.substr(0, type.find(';'));
  type = type.substr(0, type.find_last_not_of(" \t") + 1);
  const auto lower = [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  };
  return std::ranges::equal(type, std::string_view("application/json"), {}, lower);
}

}  // namespace

struct EditServer::State {
  std::string policy;
  std::shared_ptr<const std::string> page;
  Gate gate;
  std::shared_ptr<Exporter> exporter;
  std::vector<SceneNote> notes = {};  // of the scene that it began with

  std::mutex mutex;  // guards the events
  struct Event {
    std::int64_t number = 0;
    std::string data;
    bool is_over = false;  // and no news to a page that is opened later
  };
  std::map<std::string, Event, std::less<>> events;  // the last of each name
  std::int64_t event_number = 0;

  std::atomic<bool> is_ending = false;
  std::optional<HttpServer> server;
  Worker worker;   // of the session
  Worker adviser;  // of what takes long, and changes nothing by itself
  std::unique_ptr<EditSession> session = nullptr;  // last: its solver tells news to its end

  State(std::string text, Gate rules, std::shared_ptr<Exporter> exporting)
      : policy(viewer::policy_of(text)),
        page(std::make_shared<const std::string>(std::move(text))),
        gate(std::move(rules)),
        exporter(std::move(exporting)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { stop(); }

  void stop() {
    is_ending = true;
    if (exporter) exporter->stop();
    adviser.end();
    worker.end();
    exporter.reset();  // waits for its end, which it tells
    server.reset();
  }

  void tell(const char* name, std::string data) {
    {
      const std::lock_guard lock(mutex);
      Event& event = events[name];
      if (event.data == data) return;
      event = {++event_number, std::move(data)};
    }
    if (server) server->notify();
  }

  void tell_export(const ExportState& state, const std::string& file) {
    Json json = {
        {"file", file}, {"done", state.done}, {"total", state.total}, {"state", state.state}};
    if (state.error) json["errors"] = to_json(*state.error);
    {
      const std::lock_guard lock(mutex);
      events["export"] = {++event_number, text_of(json), state.state != "running"};
    }
    if (server) server->notify();
  }

  // Each stream gets the last event of each name, whenever it begins and whatever it has missed.
  std::shared_ptr<const std::string> next_event(std::int64_t& seen) {
    const std::lock_guard lock(mutex);
    std::vector<std::pair<std::int64_t, std::string>> news;
    for (const auto& [name, event] : events) {
      if (event.number > seen && !(seen < 0 && event.is_over))
        news.emplace_back(event.number, fmt::format("event: {}\ndata: {}\n\n", name, event.data));
    }
    seen = std::max(seen, event_number);
    if (news.empty()) return nullptr;
    std::ranges::sort(news);
    std::string text;
    for (const auto& [number, one] : news) text += one;
    return std::make_shared<const std::string>(std::move(text));
  }

  // In any thread, also before there is a session.
  void notify() {
    worker.add([this] { tell_all(); });
  }

  void tell_all() {
    tell("revision", std::to_string(session->revision()));
    tell("disk", text_of({{"changed", session->is_changed_on_disk()},
                          {"saved", session->is_saved()},
                          {"count", session->disk_count()}}));
    tell("takes", text_of(session->takes()));
    const ReadyFrames ready = session->solver().ready();
    Json ranges = Json::array();
    for (const auto& [first, last] : ready.ranges) ranges.push_back(Json::array({first, last}));
    tell("frames", text_of({{"revision", ready.revision}, {"ready", ranges}}));
    const auto failure = session->solver().failure();
    if (!failure) {
      const std::lock_guard lock(mutex);
      events.erase("failed");
    }
    if (failure)
      tell("failed", text_of({{"revision", ready.revision}, {"errors", to_json(*failure)}}));
  }

  HttpVerdict judge(const HttpHead& head) const {
    const auto judged = gate.judge(head);
    if (const auto* refused = std::get_if<viewer::Refusal>(&judged))
      return {.status = refused->status};
    const Route& route = routes[std::get<std::size_t>(judged)];
    if (route.place == "events") return {.is_stream = true};
    if (route.method == "GET") return {};
    const std::string* const type = head.find("content-type");
    return type && is_json(*type) ? HttpVerdict{.most_body = most_body}
                                  : HttpVerdict{.status = 415};
  }

  // A browser writes each refusal to its console, but for those with the status of none.
  static HttpAnswer made_quiet(HttpAnswer answer) {
    if (answer.status < 400) return answer;
    const std::string_view body = answer.body ? std::string_view(*answer.body) : "{\"errors\":[]}";
    return text_answer(fmt::format("{{\"status\":{},{}", answer.status, body.substr(1)), 200,
                       "application/vnd.pliant.refusal+json");
  }

  void answer(const HttpHead& head, std::string body, const HttpReply& reply) {
    if (head.find("pliant-quiet") == nullptr) return give_answer(head, std::move(body), reply);
    give_answer(head, std::move(body),
                [reply](HttpAnswer answer) { reply(made_quiet(std::move(answer))); });
  }

  void give_answer(const HttpHead& head, std::string body, const HttpReply& reply) {
    const auto judged = gate.judge(head);
    const Route& route = routes[std::get<std::size_t>(judged)];
    if (route.method == "POST") return change(route, std::move(body), reply);
    if (route.place.empty())
      return reply({.type = "text/html; charset=utf-8", .body = page, .policy = policy});
    if (route.place == "events") return reply({.type = "text/event-stream"});
    if (route.place == "format") {
      static const auto format = std::make_shared<const std::string>(scene_format_json());
      return reply({.type = "application/json", .body = format});
    }
    Query query(viewer::query_of(head.target));
    if (route.place == "document") return later(reply, [this] { return session->document(); });
    if (route.place == "starters") return later(reply, [this] { return session->starters(); });
    if (route.place == "takes")
      return later(reply, [this] { return json_answer(session->takes()); });
    if (route.place == "picture") {
      const std::string starter = query.text("starter");
      const auto take = query.number("take");
      if (!query.is_sound() || (take && !starter.empty())) return reply(bad_query());
      return later(reply, [this, starter, take] {
        return take ? session->picture_of_take(*take) : session->picture(starter);
      });
    }
    if (route.place == "shape") {
      const std::string key = query.text("key");
      if (!query.is_sound()) return reply(bad_query());
      if (auto shape = session->solver().shape(key)) return reply(shape_answer(std::move(shape)));
      return later(reply, [this, key] { return shape_answer(session->ghosts().shape(key)); });
    }
    const auto revision = query.number("revision");
    if (route.place == "objects") {
      if (!query.is_sound()) return reply(bad_query());
      return later(reply, [this, revision] { return session->objects(revision); });
    }
    if (route.place == "motion") {
      const std::string surface = query.text("surface");
      if (!query.is_sound() || !revision) return reply(bad_query());
      return tell_motion(*revision, surface, reply);
    }
    const bool is_scene = route.place == "scene";
    const auto take = query.number("take");
    const auto frame = is_scene ? std::optional<std::int64_t>(0) : query.number("frame");
    if (!query.is_sound() || revision.has_value() == take.has_value() || !frame)
      return reply(bad_query());
    const auto kind = is_scene                   ? FrameQuestion::Kind::Scene
                      : route.place == "details" ? FrameQuestion::Kind::Details
                                                 : FrameQuestion::Kind::Frame;
    if (take) return ask_ghost(kind, *take, *frame, reply);
    ask({kind, *revision}, *frame, reply);
  }

  static HttpAnswer bad_query() {
    return refusal(400, "the words behind ? are missing, unknown or no numbers");
  }

  void ask(FrameQuestion question, std::int64_t frame, const HttpReply& reply) {
    // In the session's thread, which knows the scene's frames.
    worker.add([this, question, frame, reply]() mutable {
      const bool is_scene = question.kind == FrameQuestion::Kind::Scene;
      if (!is_scene && session->has_scene() && question.revision == session->revision()) {
        const Scene& scene = session->scene_document().scene();
        if (auto fault = fault_of(frame, {scene.start, scene.end})) return reply(*std::move(fault));
        question.frame = static_cast<int>(frame);
      }
      ask(session->solver(), question, reply);
    });
  }

  void ask_ghost(FrameQuestion::Kind kind, std::int64_t take, std::int64_t frame,
                 const HttpReply& reply) {
    worker.add([this, kind, take, frame, reply] {
      const auto ghost = session->ghost(take);
      if (!ghost) return reply(refusal(ghost.error()));
      FrameQuestion question{kind, Ghost::revision};
      if (kind != FrameQuestion::Kind::Scene) {
        if (auto fault = fault_of(frame, (*ghost)->frames)) return reply(*std::move(fault));
        question.frame = static_cast<int>(frame);
      }
      ask(*(*ghost)->solver, question, reply);
    });
  }

  static std::optional<HttpAnswer> fault_of(std::int64_t frame, const FrameSpan& frames) {
    if (frame >= frames.first && frame <= frames.last) return {};
    return refusal(422, fmt::format("frame {}: the scene has frames {} to {}", frame, frames.first,
                                    frames.last));
  }

  static void ask(FrameSolver& solver, const FrameQuestion& question, const HttpReply& reply) {
    const bool is_scene = question.kind == FrameQuestion::Kind::Scene;
    const char* const type = is_scene ? "application/json" : "application/octet-stream";
    solver.ask(question,
               [reply, type](const FrameAnswer& answer) { reply(to_answer(answer, type)); });
  }

  void later(const HttpReply& reply, std::function<HttpAnswer()> work) {
    worker.add([reply, work = std::move(work)] { reply(work()); });
  }

  void change(const Route& route, std::string body, const HttpReply& reply) {
    worker.add([this, place = route.place, body = std::move(body), reply] {
      auto json = parse_json(body.empty() ? "{}" : body, "a request");
      if (!json) return reply(refusal(400, json.error()));
      const EmptiedJson end(*json);
      if (!json->is_object()) return reply(refusal(400, "a request must be an object"));
      if (place == "export") return reply(export_scene(*json));
      const auto found = std::ranges::find(changes, place, &Posted::place);
      if (found != changes.end()) return reply(((*session).*(found->act))(*json));
      change_slowly(*std::ranges::find(long_changes, place, &LongPosted::place), *json, reply);
    });
  }

  void change_slowly(const LongPosted& posted, const Body& body, const HttpReply& reply);

  HttpAnswer export_scene(const Body& body);
  SimulationOptions advice_for(Revision revision);
  void tell_motion(Revision revision, const std::string& surface, const HttpReply& reply);
};

// Numbers for a motion may take seconds; meanwhile the document goes on.
void EditServer::State::tell_motion(Revision revision, const std::string& surface,
                                    const HttpReply& reply) {
  worker.add([this, revision, surface, reply] {
    if (revision != session->revision() || !session->has_scene())
      return reply(refusal(409, "there is another revision by now"));
    adviser.add([this, scene = session->scene_document().scene(), revision, surface, reply] {
      const auto motion = motion_of(scene, surface, advice_for(revision));
      if (!motion && motion.error().code == ErrorCode::Interrupted)
        return reply(refusal(409, "there is another revision by now"));
      if (!motion) return reply(refusal(motion.error()));
      const auto number = [](const std::optional<double>& one) {
        return one ? Json(*one) : Json();
      };
      reply(json_answer({{"peak", number(motion->peak)},
                         {"settling", number(motion->settling)},
                         {"frequency", number(motion->frequency)},
                         {"reason", motion->reason}}));
    });
  });
}

SimulationOptions EditServer::State::advice_for(Revision revision) {
  SimulationOptions options = session->simulation();
  options.shelf = &session->solver().shelf();
  options.should_stop = [this, revision] {
    return is_ending.load() || session->solver().revision() != revision;
  };
  return options;
}

// The adviser works it out; meanwhile the document goes on.
void EditServer::State::change_slowly(const LongPosted& posted, const Body& body,
                                      const HttpReply& reply) {
  Begun begun = ((*session).*(posted.act))(body);
  if (auto* const answer = std::get_if<HttpAnswer>(&begun)) return reply(std::move(*answer));
  adviser.add([this, &posted, body, reply, revision = session->revision(),
               work = std::get<LongWork>(std::move(begun))] {
    worker.add([this, &posted, body, reply, revision, finish = work(advice_for(revision))] {
      if (revision == session->revision()) return reply(finish());
      if (posted.begins_again) return change_slowly(posted, body, reply);
      reply(refusal(409, "there is another revision by now"));
    });
  });
}

// Whether the scene has what is to be written.
Result<void> check_parts(const Exporter::Order& order, const Scene& scene) {
  const auto& surfaces = scene.surfaces;
  if (!order.surface.empty() &&
      std::ranges::find(surfaces, order.surface, &Surface::name) == surfaces.end())
    return fail(ErrorCode::InvalidInput,
                fmt::format("no surface is named {}", printable(order.surface)));
  if (!order.space.empty() && order.space != "world" && order.space != "object")
    return fail(ErrorCode::InvalidInput,
                fmt::format("space {}: must be world or object", printable(order.space)));
  if (order.frames && (order.frames->first > order.frames->last ||
                       order.frames->first < scene.start || order.frames->last > scene.end))
    return fail(ErrorCode::InvalidInput,
                fmt::format("frames {} to {}: the scene has frames {} to {}", order.frames->first,
                            order.frames->last, scene.start, scene.end));
  return {};
}

HttpAnswer EditServer::State::export_scene(const Body& body) {
  if (!exporter) return refusal(422, "this command cannot export");
  Members members(body);
  const bool stops = members.flag("stop");
  const std::string file = stops ? members.text("file") : members.required_text("file");
  Exporter::Order order;
  order.surface = members.text("surface");
  order.space = members.text("space");
  if (const auto frames = members.span("frames"))
    order.frames = FrameSpan{frames->first, frames->second};
  if (body.contains("stop") && (!stops || body.size() > 1))
    members.refuse("stop", "must be true, and alone");
  if (auto fault = members.fault()) return *std::move(fault);
  if (stops) {
    exporter->stop();
    return json_answer({{"revision", session->revision()}});
  }
  if (!session->has_scene()) return refusal(409, "there is no scene yet");
  const Scene& scene = session->scene_document().scene();
  if (auto known = check_parts(order, scene); !known) return refusal(known.error());
  order.scene_frames = {scene.start, scene.end};
  const auto place = session->place_of(file);
  if (!place) return refusal(place.error());
  if (auto free = session->check_export(*place); !free) return refusal(free.error());
  order.file = place->string();
  order.text = session->scene_document().text();
  order.name = session->scene_document().file();
  order.root = session->root();
  order.folder = session->folder_of_file();
  std::error_code unknown;
  if (session->is_saved())
    order.saved = std::filesystem::absolute(session->scene_document().file(), unknown).string();
  order.tell = [this, file](const ExportState& state) { tell_export(state, file); };
  if (auto started = exporter->start(std::move(order)); !started) return refusal(started.error());
  return json_answer({{"revision", session->revision()}});
}

EditServer::EditServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
EditServer::EditServer(EditServer&&) noexcept = default;
EditServer::~EditServer() = default;

Result<EditServer> EditServer::start(std::string page, int port, SessionOptions options,
                                     std::shared_ptr<Exporter> exporter) {
  auto token = viewer::make_token();
  if (!token) return fail(token.error());
  // Two pages of one browser send several requests at once, and as many as frames are dragged over.
  auto server = HttpServer::listen(port, {.bodies = 16, .requests = 10'000});
  if (!server) return fail(server.error());
  Gate gate(*std::move(token), server->port(), routes);
  auto state = std::make_unique<State>(std::move(page), std::move(gate), std::move(exporter));
  State& its = *state;
  auto session = EditSession::open(std::move(options), [&its] { its.notify(); });
  if (!session) return fail(session.error());
  its.session = *std::move(session);
  if (its.session->has_scene()) its.notes = its.session->scene_document().scene().notes;
  its.server.emplace(*std::move(server));
  its.adviser.begin();
  its.worker.begin([&its] { its.session->tick(); });
  its.notify();
  its.server->serve(
      {.judge = [&its](const HttpHead& head) { return its.judge(head); },
       .answer = [&its](const HttpHead& head, std::string body,
                        const HttpReply& reply) { its.answer(head, std::move(body), reply); },
       .next_event = [&its](std::int64_t& seen) { return its.next_event(seen); }});
  return EditServer(std::move(state));
}

std::string EditServer::address() const { return state_->gate.address(); }

const std::vector<SceneNote>& EditServer::notes() const { return state_->notes; }

std::optional<Error> EditServer::finish() {
  state_->stop();
  EditSession& session = *state_->session;
  session.flush();
  if (session.is_saved()) return {};
  const std::string& fault = session.journal_fault();
  return Error{.code = ErrorCode::Unwritable,
               .message = fault.empty()
                              ? "changes were not saved; pliant edit offers them again"
                              : "changes were not saved, and are lost: no journal, " + fault,
               .file = session.told_name()};
}

}  // namespace pliant::editor
