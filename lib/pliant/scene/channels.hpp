#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/scene/scene.hpp"

namespace pliant {

/// A channel of a scene with its path, `NAME.attribute`; of a position that follows a path it is
/// `NAME.attribute.progress`.
struct NamedChannel {
  std::string path;
  std::variant<const Channel<1>*, const Channel<3>*, const Switch*> channel;

  bool is_animated() const;
};

/// All channels, constant ones too, surface by surface, then force by force, then group by group,
/// each in the order of docs/scene-format.md. They point into `scene`, which must outlive them and
/// not change.
std::vector<NamedChannel> channels_of(const Scene& scene);

/// Why a path does not lead to a channel of the scene: `"poke" has no attribute "magnitud"; did you
/// mean "magnitude"? …`.
std::string no_channel(const Scene& scene, std::string_view path);

}  // namespace pliant
