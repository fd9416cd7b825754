#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/findings.hpp"

namespace pliant::xml {

/// A surface, a force or a group that has a name.
struct Named {
  std::string_view element;
  std::string name;
  TextPlace place;
};

/// Checks a scene except for its channels: values within their ranges; the rules between values;
/// names unique; targets and groups exist. Rules between values that `is_sound` rejects are left
/// out. `named` contains all that have a name, in a file also those that could not be read.
void check_whole(const Scene& scene, std::span<const Named> named, const ChannelFilter& is_sound,
                 Findings& findings);

/// A force in a group may have fewer targets than the group; other targets have no effect.
void note_idle_targets(const Scene& scene, Findings& findings);

}  // namespace pliant::xml
