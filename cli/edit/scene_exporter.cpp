#include "cli/edit/scene_exporter.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <iterator>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "cli/terminal/child.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/view/movie_writer.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant::cli {
namespace {

using editor::Exporter;
using editor::ExportState;

// A scene as the standard input of a program.
Result<OpenDescriptor> memory_file_of(const std::string& text) {
  OpenDescriptor file(memfd_create("scene", MFD_CLOEXEC));
  std::string_view left = text;
  while (file.is_open() && !left.empty()) {
    const ssize_t count = ::write(file.number(), left.data(), left.size());
    if (count <= 0) break;
    left.remove_prefix(static_cast<std::size_t>(count));
  }
  if (!file.is_open() || !left.empty() || lseek(file.number(), 0, SEEK_SET) != 0)
    return fail(ErrorCode::OutOfMemory, "there is no memory to hand the scene to a program");
  return file;
}

bool is_log(const Exporter::Order& order) { return ending_of(order.file) == ".replay"; }

std::vector<std::string> words_for(const Exporter::Order& order, const ResourceOptions& resources) {
  const std::filesystem::path file(order.file);
  const bool is_movie = movie_format(file).has_value();
  const bool is_recorded = is_log(order);
  std::vector<std::string> words = {"/proc/self/exe"};
  const auto add = [&](std::initializer_list<std::string> more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  if (is_movie)
    add({"view", "-", "--movie", order.file});
  else if (is_recorded)
    add({"replay", "record", order.saved, "-o", order.file});
  else
    add({"bake", "-", "-o", order.file});
  if (order.frames && !is_recorded)
    add({"--frames", fmt::format("{}:{}", order.frames->first, order.frames->last)});
  if (!order.surface.empty() && !is_movie && !is_recorded) add({"--surface", order.surface});
  if (!order.space.empty() && !is_movie && !is_recorded) add({"--space", order.space});
  add({"--root", order.root});
  if (resources.threads > 0) add({"--threads", std::to_string(resources.threads)});
  if (resources.max_memory > 0) add({"--max-memory", fmt::format("{}", resources.max_memory)});
  return words;
}

// `12/96`, as `Progress` tells it to programs.
bool read_progress(std::string_view line, ExportState& state) {
  int done = 0, total = 0;
  const char* const end = line.data() + line.size();
  const auto first = std::from_chars(line.data(), end, done);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '/') return false;
  const auto second = std::from_chars(first.ptr + 1, end, total);
  if (second.ec != std::errc() || second.ptr != end) return false;
  state.done = done;
  state.total = total;
  return true;
}

// The errors among the messages of a command, "FILE:LINE: error: MESSAGE"; `name`: of the scene
// that it has as its standard input.
Error error_of(const std::vector<std::string>& messages, const std::string& name) {
  constexpr std::string_view sign = "error: ", input = "standard input";
  std::vector<Error> errors;
  for (std::string line : messages) {
    for (std::size_t at = 0; (at = line.find(input, at)) != std::string::npos; at += name.size())
      line.replace(at, input.size(), name);
    const std::size_t at = line.find(sign);
    if (at == std::string::npos || (at > 0 && !line.substr(0, at).ends_with(": "))) continue;
    Error error{.message = line.substr(at + sign.size())};
    std::string_view place = std::string_view(line).substr(0, at > 0 ? at - 2 : 0);
    const std::size_t colon = place.rfind(':');
    if (colon != std::string_view::npos) {
      std::from_chars(place.data() + colon + 1, place.data() + place.size(), error.line);
      if (error.line > 0) place = place.substr(0, colon);
    }
    if (place != "pliant") error.file = place;
    errors.push_back(std::move(error));
  }
  if (errors.empty())
    return {.message = messages.empty() ? "the program that exports has ended without a word"
                                        : fmt::format("{}", fmt::join(messages, "; "))};
  Error first = std::move(errors.front());
  first.others.assign(std::make_move_iterator(errors.begin() + 1),
                      std::make_move_iterator(errors.end()));
  return first;
}

class SceneExporter final : public Exporter {
 public:
  explicit SceneExporter(const ResourceOptions& resources) : resources_(resources) {}
  SceneExporter(const SceneExporter&) = delete;
  SceneExporter& operator=(const SceneExporter&) = delete;
  ~SceneExporter() override { end(); }

  Result<void> start(Order order) override {
    const std::lock_guard lock(mutex_);
    // One that was stopped is waited for.
    if (is_running_ && !is_stopped_)
      return fail(ErrorCode::InvalidInput, "an export is running; stop it, or wait for its end");
    if (is_log(order) && order.saved.empty())
      return fail(ErrorCode::InvalidInput,
                  "a log is of a file; save the scene before its run is recorded");
    if (is_log(order) && order.frames && order.frames->count() < order.scene_frames.count())
      return fail(ErrorCode::InvalidInput,
                  fmt::format("a log has all frames of a scene, {} to {}; leave them out",
                              order.scene_frames.first, order.scene_frames.last));
    auto input = memory_file_of(order.text);
    if (!input) return fail(input.error());
    if (thread_.joinable()) thread_.join();
    is_running_ = true;
    is_stopped_ = false;
    thread_ = std::thread([this, order = std::move(order), input = *std::move(input)]() mutable {
      run(order, input);
    });
    return {};
  }

  void stop() override { is_stopped_ = true; }

 private:
  void end() {
    is_stopped_ = true;
    const std::lock_guard lock(mutex_);
    if (thread_.joinable()) thread_.join();
  }

  void run(const Order& order, const OpenDescriptor& input) {
    ExportState state{.file = order.file, .state = "running"};
    if (order.frames) state.total = order.frames->count();
    order.tell(state);
    std::vector<std::string> messages;
    ProgramRun program;
    program.patience = std::chrono::hours(24 * 365);
    program.ends_gently = true;
    program.input = input.number();
    program.folder = order.folder;
    const std::vector<std::string> variables = {progress_variable + std::string("=1")};
    program.added = variables;
    program.take_line = [](std::string_view) {};
    program.take_message = [&](std::string_view line) {
      if (read_progress(line, state)) return order.tell(state);
      constexpr std::size_t most = 100;
      if (messages.size() < most) messages.emplace_back(line);
    };
    program.should_stop = [this] { return is_stopped_.load(); };
    const auto ended = run_program(words_for(order, resources_), program);
    if (!ended && ended.error().code == ErrorCode::Interrupted) {
      state.state = "stopped";
    } else if (!ended || ended->code != 0) {
      state.state = "failed";
      state.error = ended ? error_of(messages, order.name) : ended.error();
    } else {
      state.state = "done";
      state.done = state.total;
    }
    // Whoever is told may order the next one at once.
    is_running_ = false;
    order.tell(state);
  }

  ResourceOptions resources_;
  std::mutex mutex_;  // guards the thread
  std::thread thread_;
  std::atomic<bool> is_running_ = false, is_stopped_ = false;
};

}  // namespace

std::shared_ptr<editor::Exporter> make_exporter(const ResourceOptions& resources) {
  return std::make_shared<SceneExporter>(resources);
}

}  // namespace pliant::cli
