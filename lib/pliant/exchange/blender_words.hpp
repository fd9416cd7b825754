#pragma once

#include <string_view>

namespace pliant::exchange {

// Words of Blender's Keyframe.interpolation in the order of `Ease`, of Keyframe.easing in the order
// of `EaseSide`, and of FModifierCycles.
inline constexpr std::string_view blender_eases[] = {"SINE", "QUAD", "CUBIC", "QUART",  "QUINT",
                                                     "EXPO", "CIRC", "BACK",  "BOUNCE", "ELASTIC"};
inline constexpr std::string_view blender_sides[] = {"EASE_IN", "EASE_OUT", "EASE_IN_OUT"};
inline constexpr std::string_view blender_cycles[] = {"NONE", "REPEAT", "REPEAT_OFFSET", "MIRROR"};

}  // namespace pliant::exchange
