#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The text of a scene file in which some channels have the values of `changed`, and all other
/// bytes stay. `paths` name them: `NAME.magnitude` of a force, `NAME.density`, `NAME.damping` or
/// `NAME.dampingRatio` of a surface. A constant may be any number; a curve has the keys of the text
/// with other values.
///
/// Errors: InvalidInput if the text cannot be read, names no such force or surface, or does not say
/// afterwards what `changed` says. `file`, `folder` and `root` are as for `parse_scene`.
Result<std::string> changed_text(std::string_view text, const Scene& changed,
                                 std::span<const std::string> paths, const std::string& file,
                                 const std::string& folder, const std::string& root = {});

}  // namespace pliant
