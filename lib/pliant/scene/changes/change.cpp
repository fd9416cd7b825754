#include "pliant/scene/changes/change.hpp"

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
#include "pliant/core/shortened.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/scene/changes/change_texts.hpp"
#include "pliant/scene/changes/changed_values.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/resolve.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/text/text.hpp"
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
    if (const Checked<void> reading = slot.read(change_.text); !reading)
      return refuse(fmt::format("{}: {}", in_quotes(change_.text), reading.error().message));
    return {};
  }

 private:
  Result<void> no_path() const {
    return refuse(fmt::format("{} is not on a <path>, so it has no {}", path_.title(), path_.part));
  }

  Result<void> close(PathMotion& motion) const {
    if (change_.kind != SceneChange::Kind::Set)
      return refuse(path_.title() + ".closed is no numeric channel");
    const Checked<bool> is_closed = parse_boolean(trimmed(change_.text));
    if (!is_closed)
      return refuse(fmt::format("{}: {}", in_quotes(change_.text), is_closed.error().message));
    auto path = Path::make(motion.path.waypoints(), *is_closed);
    if (!path)
      return refuse(fmt::format("waypoint {} {}", path.error().index + 1, path.error().message));
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
    const Checked<void> reading = parse_numbers(change_.text, std::span(numbers).first(count));
    if (!reading)
      return refuse(fmt::format("{}: {}", in_quotes(change_.text), reading.error().message));
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

// Attributes that count as given from now on, not yet among those of the scene.
class NewParts {
 public:
  explicit NewParts(Scene& scene) : scene_(scene) {}

  void add(const std::string& name, const std::string& attribute) {
    if (scene_.origin.gives(name, attribute)) return;
    added_.push_back({name + '.' + attribute, scene_.origin.at(name)});
  }

  void put() {
    if (added_.empty()) return;
    std::vector<ScenePart>& parts = scene_.origin.parts;
    const auto end = static_cast<std::ptrdiff_t>(parts.size());
    std::ranges::sort(added_, {}, &ScenePart::name);
    parts.insert(parts.end(), added_.begin(), added_.end());
    std::ranges::inplace_merge(parts, parts.begin() + end, {}, &ScenePart::name);
    added_.clear();
  }

 private:
  Scene& scene_;
  std::vector<ScenePart> added_;
};

// The name of a file is one from the folder of the scene's file, and leads to `root` or below.
Result<void> settle_file(const Scene& scene, std::string& file, const std::string& root) {
  if (file.empty()) return {};
  file = (fs::path(scene.origin.file).parent_path() / file).string();
  if (auto below = find_below(file, root); !below) return fail(below.error());
  return {};
}

// What a file would do beside the value itself.
Result<void> settle(const NamedThings& things, const ValuePath& path, const Slot& slot,
                    const std::string& root, NewParts& parts) {
  if (slot.attribute.syntax == Syntax::Path) {
    auto settled = settle_file(things.scene(), *std::get<std::string*>(slot.place), root);
    if (!settled) return settled;
  }
  if (slot.attribute.name == "falloff") {
    if (Force* const force = things.force(path.name)) force->falloff_curve.reset();
  }
  parts.add(path.name == Description<Scene>::element ? "" : path.name, path.attribute);
  return {};
}

Result<void> make_change(const NamedThings& things, const SceneChange& change,
                         const std::string& root, NewParts& parts) {
  const auto at = slot_at(things, change.path);
  if (!at) return refuse(at.error().message);
  const Adjust adjust(at->path, change);
  if (change.kind != SceneChange::Kind::Set || !at->path.part.empty())
    return std::visit(adjust, at->slot.place);
  if (auto read = adjust.read(at->slot); !read) return read;
  return settle(things, at->path, at->slot, root, parts);
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
  // So many changes bring problems, and so few bring none; looked for backwards, one by one, then
  // in growing steps, and at last between two of these.
  constexpr int most_single_steps = 32;
  int round = 0;
  std::size_t with = changes.size(), without = 0;
  for (std::size_t step = 1; with - without > 1;) {
    const std::size_t count =
        without > 0 ? without + (with - without) / 2 : with - std::min(step, with - 1);
    if (++round > most_single_steps) step *= 2;
    Scene before = scene;
    std::vector<Error> others;
    if (make_changes(before, changes.first(count), root)) others = problems_of(before);
    if (others.empty()) {
      without = count;
    } else {
      with = count;
      problems = std::move(others);
    }
  }
  for (Error& problem : problems)
    problem = {.code = problem.code,
               .message = fmt::format("--set {}: {}", changes[with - 1].told(), problem.message)};
  return as_one(std::move(problems), "");
}

// The name of a file that a path leads to; null: it leads to another value.
const std::string* file_at(const NamedThings& things, const std::string& path) {
  const auto at = slot_at(things, path);
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

}  // namespace

std::string SceneChange::told() const {
  constexpr std::size_t longest = 400;
  return shortened(typed(), longest);
}

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
      fmt::format("{} is not a change; write PATH=TEXT, PATH*=K or PATH+=V, such as "
                  "poke.magnitude*=2",
                  in_quotes(typed)));
}

Result<void> make_changes(Scene& scene, std::span<const SceneChange> changes,
                          const std::string& root) {
  Scene changed = scene;
  const NamedThings things(changed);
  NewParts parts(changed);
  ChangedValues values;
  for (const SceneChange& change : changes) {
    const auto complain = [&](const std::string& message) {
      return refuse(fmt::format("{}: {}", change.told(), message));
    };
    if (const auto other = values.add(change))
      return complain(fmt::format("{} changes the same value", changes[*other].told()));
    if (const auto made = make_change(things, change, root, parts); !made)
      return complain(made.error().message);
  }
  parts.put();
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
  const NamedThings things(scene);
  for (const SceneChange& change : changes) {
    const std::string* const file = file_at(things, change.path);
    if (!file || file->empty()) continue;
    if (const auto readable = OpenFile::open(*file, scene.origin.root); !readable)
      return refuse(fmt::format("{}: {}", change.told(), readable.error().message));
  }
  return {};
}

ChangeCheck::ChangeCheck(const Scene& scene, std::string root)
    : scene_(scene), things_(scene_), root_(std::move(root)) {}

std::optional<WrongText> ChangeCheck::first_wrong(const SceneChange& change,
                                                  std::span<const std::string_view> texts,
                                                  const StopRequest& should_stop) {
  const auto at = slot_at(things_, change.path);
  const std::string name = at ? at->path.name : "";
  // Other values of a thing may depend on the one that is changed; none do on one of the scene.
  const auto checked = [&](auto* thing) {
    const auto before = *thing;
    auto wrong = first_wrong_at(at, change, texts, should_stop);
    *thing = before;
    return wrong;
  };
  if (Surface* const surface = things_.surface(name)) return checked(surface);
  if (Force* const force = things_.force(name)) return checked(force);
  if (Group* const group = things_.group(name)) return checked(group);
  return first_wrong_at(at, change, texts, should_stop);
}

std::optional<WrongText> ChangeCheck::first_wrong_at(const Checked<SlotAt>& at,
                                                     const SceneChange& change,
                                                     std::span<const std::string_view> texts,
                                                     const StopRequest& should_stop) const {
  SceneChange one = change;
  const auto check = [&]() -> Result<void> {
    if (!at) return refuse(at.error().message);
    const Adjust adjust(at->path, one);
    if (change.kind != SceneChange::Kind::Set || !at->path.part.empty())
      return std::visit(AdjustCopy(adjust), at->slot.place);
    if (auto read = adjust.read(at->slot); !read) return read;
    if (at->slot.attribute.syntax != Syntax::Path) return {};
    std::string& file = *std::get<std::string*>(at->slot.place);
    if (auto settled = settle_file(scene_, file, root_); !settled) return settled;
    if (file.empty()) return {};
    return OpenFile::open(file, root_).map([](const OpenFile&) {});
  };
  const bool is_file = at && at->slot.attribute.syntax == Syntax::Path;
  for (std::size_t k = 0; k < texts.size(); ++k) {
    if (is_stopped(should_stop, is_file ? 0 : k)) {
      return WrongText{k,
                       fail(ErrorCode::Interrupted, "interrupted before the first take").value()};
    }
    one.text = texts[k];
    if (auto read = check(); !read)
      return WrongText{k, refuse(fmt::format("{}: {}", one.told(), read.error().message)).value()};
  }
  return {};
}

bool ChangeCheck::names_file(const std::string& path) const {
  return file_at(things_, path) != nullptr;
}

bool has_some_value(const Scene& scene, std::span<const std::string> paths) {
  Scene changed = scene;  // a table gives access to what it lists
  const NamedThings things(changed);
  return std::ranges::any_of(
      paths, [&](const std::string& path) { return slot_at(things, path).has_value(); });
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
    for_each_part(thing, [&](const auto& part) { describe(look_at, part); });
  };
  for (const Surface& surface : scene.surfaces) look_at_all(surface);
  for (const Force& force : scene.forces) look_at_all(force);
  for (const Group& group : scene.groups) look_at_all(group);
  for (const Collider& collider : scene.colliders) look_at_all(collider);
  return first;
}

}  // namespace pliant
