#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// Refuses what assimp 5.2 takes on trust and then reads past the end of, or never gets done with:
/// a Collada accessor that reaches past its array, index lists that are no whole numbers, a chunk
/// of a .glb that reaches past the file, a layer of an FBX file without its number; and parts
/// within parts without end, in each of the formats. `ending` is the file's, in lower case without
/// its dot; others pass. Errors: the thing that is wrong, with the line of a Collada file.
Result<void> check_for_assimp(std::string_view bytes, std::string_view ending);

}  // namespace pliant
