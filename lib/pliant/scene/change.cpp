#include "pliant/scene/change.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/open_file.hpp"
#include "pliant/scene/change_texts.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/scene/description.hpp"
#include "pliant/scene/slot.hpp"
#include "pliant/scene/text.hpp"
#include "pliant/scene/value_path.hpp"
#include "pliant/timeline/adjustment.hpp"

namespace pliant {
namespace {

using namespace xml;
namespace fs = std::filesystem;

tl::unexpected<Error> refuse(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

// Adjusts the channel of a slot, or a component of it.
class Adjust {
 public:
  Adjust(const ValuePath& path, const SceneChange& change) : path_(path), change_(change) {}

  template <int D>
  Result<void> operator()(Channel<D>* channel) const {
    if (path_.is_of_path()) return no_path();
    return adjust<D>(*channel);
  }
  template <int D>
  Result<void> operator()(std::optional<Channel<D>>* channel) const {
    if (!*channel) return refuse(path_.title() + " is not given");
    return (*this)(&**channel);
  }
  Result<void> operator()(TangentChannel* tangent) const {
    return std::visit([&](auto& channel) { return (*this)(&channel); }, *tangent);
  }
  Result<void> operator()(PositionChannel* position) const {
    if (!path_.is_of_path()) return adjust<3>(*position);
    if (!position->path()) return no_path();
    if (path_.part == "closed") return close(*position->path());
    Channel<1>& progress = position->path()->progress;
    if (change_.kind != SceneChange::Kind::Set) return adjust<1>(progress);
    return read(slot(progress_attribute, &progress));
  }
  template <class Other>
  Result<void> operator()(const Other&) const {
    if (path_.part.empty()) return refuse(path_.title() + " is no numeric channel");
    return refuse(fmt::format("{} has no {}", path_.title(), path_.part));
  }

  Result<void> read(const Slot& slot) const {
    if (const Reading<void> reading = slot.read(change_.text); !reading)
      return refuse(fmt::format("{}: {}", in_quotes(change_.text), reading.error()));
    return {};
  }

 private:
  Result<void> no_path() const {
    return refuse(fmt::format("{} is not on a <path>, so it has no {}", path_.title(), path_.part));
  }

  Result<void> close(PathMotion& motion) const {
    if (change_.kind != SceneChange::Kind::Set)
      return refuse(path_.title() + ".closed is no numeric channel");
    const Reading<bool> is_closed = parse_boolean(trimmed(change_.text));
    if (!is_closed)
      return refuse(fmt::format("{}: {}", in_quotes(change_.text), is_closed.error()));
    auto path = Path::make(motion.path.waypoints(), *is_closed);
    if (!path)
      return refuse(fmt::format("waypoint {} {}", path.error().waypoint + 1, path.error().message));
    motion.path = *std::move(path);
    return {};
  }

  template <int D, class Place>
  Result<void> adjust(Place& place) const {
    const auto adjustments = read_numbers<D>();
    if (!adjustments) return fail(adjustments.error());
    if (place.adjustments() && overlap<D>(*place.adjustments(), *adjustments))
      return refuse(path_.title() + " is changed already");
    place.adjust(*adjustments);
    return {};
  }

  // One number for a component or for all, or, to add to a vector, one for each.
  template <int D>
  Result<Adjustments<D>> read_numbers() const {
    const auto component = path_.component();
    if (component && D == 1)
      return refuse(path_.title() + " is a single number, so it has no x, y and z");
    const bool is_factor = change_.kind == SceneChange::Kind::Times;
    const std::size_t count = component || is_factor ? 1 : std::size_t{D};
    std::array<double, 3> numbers = {};
    const Reading<void> reading = parse_numbers(change_.text, std::span(numbers).first(count));
    if (!reading) return refuse(fmt::format("{}: {}", in_quotes(change_.text), reading.error()));
    const auto kind = is_factor                                 ? Adjustment::Kind::Times
                      : change_.kind == SceneChange::Kind::Plus ? Adjustment::Kind::Plus
                                                                : Adjustment::Kind::Set;
    Adjustments<D> adjustments;
    for (std::size_t c = 0; c < std::size_t{D}; ++c) {
      if (!component || *component == c) adjustments[c] = {kind, numbers[count == 1 ? 0 : c]};
    }
    return adjustments;
  }

  const ValuePath& path_;
  const SceneChange& change_;
};

// What a file would do beside the value itself.
Result<void> settle(Scene& scene, const ValuePath& path, const Slot& slot,
                    const std::string& root) {
  if (slot.attribute.syntax == Syntax::Path) {
    auto& file = *std::get<std::string*>(slot.place);
    const fs::path folder = fs::path(scene.origin.file).parent_path();
    if (!file.empty()) {
      file = (folder / file).string();
      if (auto below = find_below(file, root); !below) return fail(below.error());
    }
  }
  if (slot.attribute.name == "falloff") {
    for (Force& force : scene.forces)
      if (force.name == path.name) force.falloff_curve.reset();
  }
  // From now on the attribute counts as given.
  const std::string name = path.name == Description<Scene>::element ? "" : path.name;
  if (scene.origin.gives(name, path.attribute)) return {};
  const SceneLine line{name + '.' + path.attribute, std::max(1, scene.origin.line_of(name))};
  std::vector<SceneLine>& lines = scene.origin.lines;
  lines.insert(
      std::lower_bound(lines.begin(), lines.end(), line,
                       [](const SceneLine& a, const SceneLine& b) { return a.part < b.part; }),
      line);
  return {};
}

Result<void> make_change(Scene& scene, const SceneChange& change, const std::string& root) {
  const auto at = slot_at(scene, change.path);
  if (!at) return refuse(at.error());
  const Adjust adjust(at->path, change);
  if (change.kind != SceneChange::Kind::Set || !at->path.part.empty())
    return std::visit(adjust, at->slot.place);
  if (auto read = adjust.read(at->slot); !read) return read;
  return settle(scene, at->path, at->slot, root);
}

// Adjusts a copy of the channel.
class AdjustCopy {
 public:
  explicit AdjustCopy(const Adjust& adjust) : adjust_(adjust) {}

  template <class Value>
  Result<void> operator()(Value* place) const {
    Value copy = *place;
    return adjust_(&copy);
  }
  template <class Other>
  Result<void> operator()(const Other& other) const {
    return adjust_(other);
  }

 private:
  const Adjust& adjust_;
};

// Where a scene as a whole breaks a rule.
std::vector<Error> problems_of(const Scene& scene) {
  std::vector<Error> problems = check_scene(scene);
  return problems.empty() ? check_channels(scene) : problems;
}

// The problems that all changes bring to a scene without any, as those of the change from which on
// there are some.
Error blamed(std::vector<Error> problems, const Scene& scene, std::span<const SceneChange> changes,
             const std::string& root) {
  std::size_t count = changes.size();
  for (; count > 1; --count) {
    Scene before = scene;
    if (!make_changes(before, changes.first(count - 1), root)) break;
    std::vector<Error> others = problems_of(before);
    if (others.empty()) break;
    problems = std::move(others);
  }
  for (Error& problem : problems)
    problem = {.code = problem.code,
               .message = fmt::format("--set {}: {}", changes[count - 1].typed(), problem.message)};
  return as_one(std::move(problems), "");
}

// The name of a file that a path leads to; null: it leads to another value.
const std::string* file_at(Scene& scene, const std::string& path) {
  const auto at = slot_at(scene, path);
  if (!at || at->slot.attribute.syntax != Syntax::Path) return nullptr;
  return std::get<std::string*>(at->slot.place);
}

template <class Member>
bool is_adjusted(const Member& member) {
  if constexpr (requires { member.adjustments(); }) {
    return member.adjustments() != nullptr;
  } else if constexpr (requires { member->adjustments(); }) {
    return member && member->adjustments() != nullptr;
  } else if constexpr (std::is_same_v<Member, TangentChannel>) {
    return std::visit([](const auto& channel) { return channel.adjustments() != nullptr; }, member);
  } else {
    return false;
  }
}

// Calls look_at(attribute, member) for each row that may be a channel.
template <class LookAt>
void for_each_member(const Surface& surface, const LookAt& look_at) {
  describe(look_at, surface.transform);
  describe(look_at, surface.material);
  describe(look_at, surface.tangents);
  describe(look_at, surface.solver);
}
template <class LookAt>
void for_each_member(const Force& force, const LookAt& look_at) {
  describe(look_at, force);
  std::visit([&](const auto& kind) { describe(look_at, kind); }, force.kind);
}
template <class LookAt>
void for_each_member(const Group& group, const LookAt& look_at) {
  describe(look_at, group);
}

}  // namespace

std::string SceneChange::typed() const {
  const std::string_view sign = kind == Kind::Times ? "*=" : kind == Kind::Plus ? "+=" : "=";
  return path + std::string(sign) + text;
}

bool SceneChange::overlaps(const SceneChange& other) const {
  const auto own = split_path(path), others = split_path(other.path);
  if (!own || !others) return path == other.path;
  if (own->name != others->name || own->attribute != others->attribute) return false;
  // Parts of a position on a path are those of another value than the path.
  if (own->is_of_path() != others->is_of_path()) return own->part.empty() && kind == Kind::Set;
  return own->part.empty() || others->part.empty() || own->part == others->part;
}

Result<SceneChange> parse_change(std::string_view typed) {
  const std::size_t equals = typed.find('=');
  SceneChange change;
  std::size_t end = equals;
  if (equals != std::string_view::npos && equals > 0) {
    const char sign = typed[equals - 1];
    if (sign == '*') change.kind = SceneChange::Kind::Times;
    if (sign == '+') change.kind = SceneChange::Kind::Plus;
    if (change.kind != SceneChange::Kind::Set) --end;
  }
  if (equals != std::string_view::npos) {
    change.path = trimmed(typed.substr(0, end));
    change.text = typed.substr(equals + 1);
  }
  if (!change.path.empty()) return change;
  return refuse(
      fmt::format("{} is no change; write PATH=TEXT, PATH*=K or PATH+=V, such as "
                  "poke.magnitude*=2",
                  in_quotes(typed)));
}

Result<void> make_changes(Scene& scene, std::span<const SceneChange> changes,
                          const std::string& root) {
  Scene changed = scene;
  std::map<std::string, std::vector<const SceneChange*>> before;  // by the value that they change
  for (const SceneChange& change : changes) {
    const auto complain = [&](const std::string& message) {
      return refuse(fmt::format("{}: {}", change.typed(), message));
    };
    const std::optional<ValuePath> parts = split_path(change.path);
    auto& others = before[parts ? parts->name + '.' + parts->attribute : change.path];
    for (const SceneChange* other : others) {
      if (change.overlaps(*other) || other->overlaps(change))
        return complain(fmt::format("{} changes the same value", other->typed()));
    }
    others.push_back(&change);
    if (const auto made = make_change(changed, change, root); !made)
      return complain(made.error().message);
  }
  scene = std::move(changed);
  return {};
}

Result<void> change_scene(Scene& scene, std::span<const SceneChange> changes,
                          const std::string& root) {
  Scene changed = scene;
  if (auto made = make_changes(changed, changes, root); !made) return made;
  if (std::vector<Error> problems = problems_of(changed); !problems.empty())
    return fail(as_one(std::move(problems), changed.origin.file));
  scene = std::move(changed);
  return {};
}

Result<void> change_scene(Scene& scene, std::span<const std::string> typed,
                          const std::string& root) {
  std::vector<SceneChange> changes;
  for (const std::string& one : typed) {
    auto change = parse_change(one);
    if (!change) return refuse("--set " + change.error().message);
    changes.push_back(*std::move(change));
  }
  Scene changed = scene;
  if (auto made = make_changes(changed, changes, root); !made)
    return refuse("--set " + made.error().message);
  if (auto there = check_files(changed, changes); !there)
    return refuse("--set " + there.error().message);
  if (std::vector<Error> problems = problems_of(changed); !problems.empty())
    return fail(blamed(std::move(problems), scene, changes, root));
  scene = std::move(changed);
  return {};
}

Result<void> check_files(const Scene& changed, std::span<const SceneChange> changes) {
  Scene scene = changed;  // a table gives access to what it lists
  for (const SceneChange& change : changes) {
    const std::string* const file = file_at(scene, change.path);
    if (!file || file->empty()) continue;
    if (const auto readable = OpenFile::open(*file, scene.origin.root); !readable)
      return refuse(fmt::format("{}: {}", change.typed(), readable.error().message));
  }
  return {};
}

Result<void> check_change_texts(const Scene& scene, const SceneChange& change,
                                std::span<const std::string_view> texts, const std::string& root,
                                const StopRequest& should_stop) {
  SceneChange one = change;
  const auto check_fully = [&](std::string_view text) {
    Scene changed = scene;
    one.text = text;
    if (auto made = make_changes(changed, std::span(&one, 1), root); !made) return made;
    return check_files(changed, std::span(&one, 1));
  };
  if (texts.empty()) return {};
  if (auto made = check_fully(texts.front()); !made) return made;
  // The path is right, so that only the texts can be wrong.
  Scene changed = scene;
  const auto at = slot_at(changed, change.path);
  PLIANT_EXPECTS(at.has_value());
  const bool is_file = at->slot.attribute.syntax == Syntax::Path;
  const bool is_whole = change.kind == SceneChange::Kind::Set && at->path.part.empty();
  const Adjust adjust(at->path, one);
  for (std::size_t k = 1; k < texts.size(); ++k) {
    if (is_stopped(should_stop, k))
      return fail(ErrorCode::Interrupted, "interrupted before the first take");
    if (is_file) {
      if (auto made = check_fully(texts[k]); !made) return made;
      continue;
    }
    one.text = texts[k];
    const Result<void> read =
        is_whole ? adjust.read(at->slot) : std::visit(AdjustCopy(adjust), at->slot.place);
    if (!read) return refuse(fmt::format("{}: {}", one.typed(), read.error().message));
  }
  return {};
}

bool names_file(const Scene& scene, const std::string& path) {
  Scene changed = scene;  // a table gives access to what it lists
  return file_at(changed, path) != nullptr;
}

std::optional<std::string> first_adjusted_channel(const Scene& scene) {
  std::optional<std::string> first;
  const auto look_at_all = [&](const auto& thing) {
    const auto look_at = [&](const Attribute& attribute, const auto&... members) {
      const auto look = [&](const auto& member) {
        if (first) return;
        if (is_adjusted(member)) {
          first = fmt::format("{}.{}", thing.name, attribute.name);
        } else if constexpr (requires { member.path()->progress; }) {
          if (member.path() && member.path()->progress.adjustments())
            first = fmt::format("{}.{}.progress", thing.name, attribute.name);
        }
      };
      (look(members), ...);
    };
    for_each_member(thing, look_at);
  };
  for (const Surface& surface : scene.surfaces) look_at_all(surface);
  for (const Force& force : scene.forces) look_at_all(force);
  for (const Group& group : scene.groups) look_at_all(group);
  return first;
}

}  // namespace pliant
