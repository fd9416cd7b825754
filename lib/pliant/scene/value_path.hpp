#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/scene/scene.hpp"
#include "pliant/scene/slot.hpp"
#include "pliant/scene/text.hpp"

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

/// The slot that a path leads to, into `scene`. Complaints: the text is no path, or nothing has
/// that name, attribute or part, with the nearest that there is.
Reading<SlotAt> slot_at(Scene& scene, std::string_view path);

}  // namespace pliant::xml
