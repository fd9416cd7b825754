#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/text.hpp"

/// The paths by which `--set` and sweeps name the values of a scene.
namespace pliant::xml {

/// `NAME.attribute`, `NAME.attribute.x`, or of a position on a path `NAME.attribute.progress` and
/// `.closed`. The scene's own values are those of `scene`.
struct ValuePath {
  std::string name, attribute;
  std::string part = {};  ///< `x`, `y`, `z`, `progress`, `closed`; empty: the whole

  /// Whether the part is one of a <path>.
  bool is_of_path() const { return part == "progress" || part == "closed"; }
  std::optional<std::size_t> component() const {
    if (part.empty() || is_of_path()) return {};
    return static_cast<std::size_t>(part[0] - 'x');
  }
  std::string title() const { return name + '.' + attribute; }
};

/// The parts of a path; nullopt: it has none. Whether there are such values is not examined.
std::optional<ValuePath> split_path(std::string_view path);

/// A path, and the slot of the attribute that it leads to.
struct SlotAt {
  ValuePath path;
  Slot slot;
};

/// Finds the things of a scene, which must outlive it and keep them in place, by their names, for
/// many paths of one scene.
class NamedThings {
 public:
  explicit NamedThings(Scene& scene);

  Scene& scene() const { return scene_; }

  /// Null: there is no such thing.
  Surface* surface(const std::string& name) const { return found(surfaces_, name); }
  Force* force(const std::string& name) const { return found(forces_, name); }
  Group* group(const std::string& name) const { return found(groups_, name); }

 private:
  template <class Thing>
  using ByName = std::unordered_map<std::string, Thing*>;
  template <class Thing>
  static Thing* found(const ByName<Thing>& things, const std::string& name) {
    const auto thing = things.find(name);
    return thing == things.end() ? nullptr : thing->second;
  }

  Scene& scene_;
  ByName<Surface> surfaces_;
  ByName<Force> forces_;
  ByName<Group> groups_;
};

/// The slot that a path leads to, into the scene. Complaints: the text is no path, or nothing has
/// that name, attribute or part, with the nearest that there is.
Reading<SlotAt> slot_at(const NamedThings& things, std::string_view path);
Reading<SlotAt> slot_at(Scene& scene, std::string_view path);

/// Whether a path leads to a slot.
bool has_slot(const NamedThings& things, std::string_view path);

}  // namespace pliant::xml
