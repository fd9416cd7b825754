#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/text.hpp"

/// The paths that name the values of a scene: of `--set`, sweeps, channels and operations.
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

/// What paths lead into.
struct PathScope {
  std::function<std::vector<std::string_view>()> names;  ///< of its objects
  /// The format of an object, then those of its shape and its parts; none: nothing has the name.
  std::function<std::vector<const ElementFormat*>(const std::string& name)> elements;
};

/// Those of a scene, which must outlive it.
PathScope scope_of(const Scene& scene);

/// The attribute that a path leads to.
struct ResolvedPath {
  ValuePath path;
  std::string_view element;  ///< that has the attribute
  const AttributeFormat* format = nullptr;
};

/// Where a path leads. Complaints: the text is no path, or nothing has that name, attribute or
/// part, with the nearest that there is.
Checked<ResolvedPath> resolve(const PathScope& scope, std::string_view path);

/// A path into a scene, with the value that it leads to.
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
  Collider* collider(const std::string& name) const { return found(colliders_, name); }
  /// See `PathScope`.
  std::vector<const ElementFormat*> elements(const std::string& name) const;

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
  ByName<Collider> colliders_;
};

/// As `resolve`, with the slot in the scene. Complaints also: the value cannot be changed.
Checked<SlotAt> slot_at(const NamedThings& things, std::string_view path);
Checked<SlotAt> slot_at(Scene& scene, std::string_view path);

}  // namespace pliant::xml
