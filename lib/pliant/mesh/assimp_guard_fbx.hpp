#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// The part of `check_for_assimp` for FBX files, text or binary: layers without their number, parts
/// within parts without end, and models that are linked to lie within themselves, or to be copied
/// without end.
Result<void> check_fbx(std::string_view bytes);

}  // namespace pliant
