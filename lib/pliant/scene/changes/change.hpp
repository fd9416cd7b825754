#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A change of one attribute of a scene, as if its file said so. docs/sweeps.md.
struct SceneChange {
  enum class Kind {
    Set,    ///< `PATH=TEXT`: takes the place of the attribute, of its <animate> or its <path>
    Times,  ///< `PATH*=K`: a numeric channel, keys and all, times K at every frame
    Plus,   ///< `PATH+=V`: plus V
  };
  Kind kind = Kind::Set;
  /// `scene.attribute` or `NAME.attribute`: an attribute of the element or of its parts, but not
  /// its name. `NAME.center.progress` of a position on a path; `NAME.attribute.x`, `.y`, `.z`: one
  /// component of a vector channel, while the others stay as they are.
  std::string path;
  std::string text = {};  ///< as the attribute takes it in a file

  std::string typed() const;  ///< `poke.magnitude*=2`
  std::string told() const;   ///< the beginning of that, for messages

  /// Whether another path is of the same value, or of a part of it.
  bool overlaps(const SceneChange& other) const;
};

/// Reads `PATH=TEXT`, `PATH*=K` or `PATH+=V`. Errors: InvalidInput: it is none of these.
Result<SceneChange> parse_change(std::string_view typed);

/// Makes changes, all or none, and checks the scene. Files are relative to the folder of the
/// scene's file, and must be in the folder `root` or below; empty: anywhere.
///
/// Errors: InvalidInput, the message begins with the change as it was typed: no such object,
/// attribute or component, with the nearest; a value that the attribute does not take, with its
/// rule; a channel that is not numeric, or not given; two changes of one value. What `check_scene`
/// and `check_channels` find in the changed scene.
Result<void> change_scene(Scene& scene, std::span<const SceneChange> changes,
                          const std::string& root = {});

/// The same for changes as typed after `--set`, which each message begins with. Errors: those of
/// `parse_change` too.
Result<void> change_scene(Scene& scene, std::span<const std::string> typed,
                          const std::string& root = {});

/// The same without the checks of the changed scene: of each value only the range.
Result<void> make_changes(Scene& scene, std::span<const SceneChange> changes,
                          const std::string& root = {});

/// Whether the scene has a value of one of these paths.
bool has_some_value(const Scene& scene, std::span<const std::string> paths);

/// The path of the first channel whose curve or path is adjusted, by Times or Plus or in a
/// component; null: none is.
std::optional<std::string> first_adjusted_channel(const Scene& scene);

}  // namespace pliant
