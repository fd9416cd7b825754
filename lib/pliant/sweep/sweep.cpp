#include "pliant/sweep/sweep.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/changes/change_texts.hpp"

namespace pliant {
namespace {

bool is_whole(const VariedPath& path) {
  return path.kind == SceneChange::Kind::Set &&
         std::count(path.path.begin(), path.path.end(), '.') == 1;
}

// The error of a change, whose message begins with the change, after `begin`.
Error told_after(Error error, const std::string& begin) {
  error.message = begin + error.message;
  return error;
}

// Calls `visit` with a scene for each text of a path, changed by it and by what is set; `visit`
// gets the result of changing it.
template <class Visit>
Result<void> visit_texts(const Scene& base, const Takes& takes, std::size_t path,
                         const std::string& root, const Visit& visit,
                         const StopRequest& should_stop) {
  const VariedPath& varied = takes.paths()[path];
  Scene scene = base;
  for (const std::string_view text : takes.texts_of(path, should_stop)) {
    if (is_stopped(should_stop)) return interrupted();
    // A whole value takes the place of the last one.
    if (!is_whole(varied)) scene = base;
    const SceneChange change{varied.kind, varied.path, std::string(text)};
    auto made = make_changes(scene, std::span(&change, 1), root);
    if (auto done = visit(scene, made); !done) return done;
  }
  if (is_stopped(should_stop)) return interrupted();
  return {};
}

}  // namespace

Sweep::Sweep(std::vector<Scene> scenes, Takes takes, SweepSettings settings)
    : scenes_(std::move(scenes)), takes_(std::move(takes)), settings_(std::move(settings)) {
  PLIANT_EXPECTS(scenes_.size() == takes_.plan().scene_count);
}

Result<Sweep> Sweep::make(std::vector<Scene> scenes, Takes takes, SweepSettings settings,
                          const StopRequest& should_stop) {
  Sweep sweep(std::move(scenes), std::move(takes), std::move(settings));
  if (auto checked = sweep.check_values(should_stop); !checked) return fail(checked.error());
  if (auto checked = sweep.check_frames(should_stop); !checked) return fail(checked.error());
  return sweep;
}

Sweep Sweep::unchecked(std::vector<Scene> scenes, Takes takes, SweepSettings settings) {
  return {std::move(scenes), std::move(takes), std::move(settings)};
}

// A message may quote a table only if some head of it is a path of the scene: otherwise it may be
// any file.
Result<void> Sweep::check_table(const Scene& scene) const {
  if (takes_.table_title().empty()) return {};
  std::vector<std::string> paths;
  for (const VariedPath& path : takes_.paths()) paths.push_back(path.path);
  if (has_some_value(scene, paths)) return {};
  return invalid(takes_.table_title() +
                 ": no column is headed by the path of a value of the scene, such as scene.end");
}

Result<void> Sweep::check_values(const StopRequest& should_stop) const {
  for (const Scene& scene : scenes_) {
    Scene base = scene;
    if (auto made = make_changes(base, takes_.set(), settings_.root); !made)
      return fail(told_after(made.error(), "--set "));
    if (auto there = check_files(base, takes_.set()); !there)
      return fail(told_after(there.error(), "--set "));
    if (auto known = check_table(base); !known) return known;
    ChangeCheck check(base, settings_.root);
    for (std::size_t path = 0; path < takes_.paths().size(); ++path) {
      const VariedPath& varied = takes_.paths()[path];
      const std::vector<std::string_view> texts = takes_.texts_of(path, should_stop);
      if (is_stopped(should_stop)) return interrupted();
      const auto wrong = check.first_wrong({varied.kind, varied.path}, texts, should_stop);
      if (!wrong) continue;
      if (wrong->error.code == ErrorCode::Interrupted) return fail(wrong->error);
      return fail(told_after(wrong->error, takes_.place_of(path, texts[wrong->number]) + ": "));
    }
  }
  return {};
}

Result<void> Sweep::check_frames(const StopRequest& should_stop) const {
  for (const VariedPath& path : takes_.paths()) {
    if (path.path == "scene.start" || path.path == "scene.end") return {};
  }
  for (const Scene& scene : scenes_) {
    if (is_stopped(should_stop)) return interrupted();
    Scene base = scene;
    if (auto made = make_changes(base, takes_.set(), settings_.root); !made) return made;
    if (auto frames = frames_of(base); !frames) return fail(frames.error());
  }
  return {};
}

Result<void> Sweep::for_each_variant(const std::function<Result<void>(const Scene&)>& look_at,
                                     const StopRequest& should_stop) const {
  for (const Scene& scene : scenes_) {
    Scene base = scene;
    if (auto made = make_changes(base, takes_.set(), settings_.root); !made) return made;
    if (auto looked = look_at(base); !looked) return looked;
    const ChangeCheck check(base, settings_.root);
    for (std::size_t path = 0; path < takes_.paths().size(); ++path) {
      if (is_stopped(should_stop)) return interrupted();
      if (!check.names_file(takes_.paths()[path].path)) continue;
      const auto look = [&](const Scene& changed, const Result<void>& made) {
        return made ? look_at(changed) : Result<void>();
      };
      if (auto looked = visit_texts(base, takes_, path, settings_.root, look, should_stop); !looked)
        return looked;
    }
  }
  return {};
}

Result<Scene> Sweep::scene_of(std::size_t take) const {
  PLIANT_EXPECTS(take < takes_.count());
  Scene scene = scenes_[takes_.scene_of(take)];
  if (auto made = make_changes(scene, takes_.changes(take), settings_.root); !made)
    return fail(made.error());
  return scene;
}

Result<FrameSpan> Sweep::frames_of(const Scene& scene) const {
  if (!settings_.frames) return FrameSpan{scene.start, scene.end};
  const auto [first, last] = *settings_.frames;
  if (first <= last && first >= scene.start && last <= scene.end) return *settings_.frames;
  return fail(ErrorCode::InvalidInput, fmt::format("--frames {}:{}: the scene has frames {} to {}",
                                                   first, last, scene.start, scene.end));
}

}  // namespace pliant
