#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/commands/cache.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/json.hpp"
#include "cli/terminal/report.hpp"
#include "cli/view/view.hpp"
#include "cli/view/view_scene.hpp"
#include "editor/files.hpp"
#include "pliant/scene/inputs.hpp"
#include "viewer/server.hpp"

namespace pliant::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto pause = 50ms;

// Polls files, and reports when one has been saved.
class Watch {
 public:
  explicit Watch(std::vector<std::filesystem::path> files) {
    for (std::filesystem::path& file : files) stamps_.emplace(std::move(file), editor::FileStamp());
    for (auto& [file, stamp] : stamps_) stamp = editor::stamp_of(file);
  }

  // Whether a file has changed since construction. Thread-safe.
  bool has_changed() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    auto due = due_.load();
    if (now < due) return has_changed_;
    const auto next = now + std::chrono::steady_clock::duration(pause).count();
    if (!due_.compare_exchange_strong(due, next)) return has_changed_;  // another thread checks
    for (const auto& [file, stamp] : stamps_) {
      if (editor::stamp_of(file) != stamp) has_changed_ = true;
    }
    return has_changed_;
  }

 private:
  std::map<std::filesystem::path, editor::FileStamp> stamps_;
  std::atomic<std::chrono::steady_clock::rep> due_ = 0;
  std::atomic<bool> has_changed_ = false;
};

std::vector<std::filesystem::path> files_to_watch(const Scene& scene) {
  std::vector<std::filesystem::path> files;
  for (SceneInput& input : inputs_of(scene, &was_interrupted))
    files.push_back(std::move(input.file));
  return files;
}

std::string error_json(const Error& error) {
  Json messages = Json::array();
  constexpr std::size_t longest_text = 2000;
  const auto add = [&](const Error& each) {
    messages.push_back({{"kind", "error"},
                        {"file", std::filesystem::path(each.file).filename().string()},
                        {"line", each.line},
                        {"text", each.message.substr(0, longest_text)}});
  };
  add(error);
  // A page shows some and the number of the others; the terminal shows all.
  constexpr std::size_t most_shown = 100;
  const std::size_t shown = std::min(error.others.size(), most_shown);
  for (std::size_t k = 0; k < shown; ++k) add(error.others[k]);
  if (const std::size_t left = error.others.size() - shown; left > 0) {
    add({error.code, fmt::format("{} more errors; see the terminal", left)});
  }
  return messages.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Size of the store for states that need not be solved again after the next save: a quarter of the
// command's memory, at most a gigabyte.
std::size_t store_bytes(const ResourceOptions& resources) {
  return std::min(simulation_options(resources).max_memory / 4, std::size_t{1'000'000'000});
}

// Bakes the scene in its present state. Returns the watch over its files.
std::unique_ptr<Watch> bake_once(const ViewOptions& options, viewer::ViewServer& server,
                                 MemoryStateStore& store) {
  // Watch the files before reading them, so that no save is missed.
  auto watch = std::make_unique<Watch>(
      text_files_of(options.scene, options.root.value_or(""), &was_interrupted));
  server.tell_working();
  auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) {
    report(scene.error());
    server.tell_failure(error_json(scene.error()));
    return watch;
  }
  auto all = std::make_unique<Watch>(files_to_watch(*scene));
  if (watch->has_changed()) return watch;
  const auto should_stop = [&] { return was_interrupted() || all->has_changed(); };
  auto baked = bake_scene(*std::move(scene), options, should_stop, &store);
  if (should_stop()) return all;  // the result is outdated or not needed
  if (!baked) {
    report(baked.error());
    server.tell_failure(error_json(baked.error()));
    return all;
  }
  if (!options.is_quiet) {
    print(stdout, fmt::format("{}: {}, {}, {}{}\n", printable(options.scene),
                              counted(baked->frames.count(), "frame"),
                              counted(baked->bake.vertex_count, "vertex", "vertices"),
                              peak_text(baked->bake.peak_displacement, baked->frames, baked->scene),
                              cache_summary(baked->counts)));
  }
  server.publish(std::move(baked->bake.packed));
  return all;
}

}  // namespace

int serve_view(const ViewOptions& options, std::string_view page) {
  auto server = viewer::ViewServer::start(std::string(page), *options.port);
  if (!server) return report(server.error());
  print(stdout, server->address() + '\n');
  if (std::ferror(stdout) != 0)
    return exit_failed;  // the address was not printed, so no one can
                         // use the server
  MemoryStateStore store(store_bytes(options.resources));
  while (!was_interrupted()) {
    const auto watch = bake_once(options, *server, store);
    while (!was_interrupted() && !watch->has_changed()) std::this_thread::sleep_for(pause);
    // A save may need a moment: wait before reading the files.
    std::this_thread::sleep_for(pause);
  }
  return exit_done;
}

}  // namespace pliant::cli
