#pragma once

#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/findings.hpp"

namespace pliant::xml {

/// Complains of surfaces that cannot meet the colliders that target them.
void check_colliders(const Scene& scene, const ChannelFilter& is_sound, Findings& findings);

}  // namespace pliant::xml
