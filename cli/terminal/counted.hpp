#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pliant::cli {

/// "1 frame", "2 frames"; with `many`, "1 vertex", "2 vertices".
std::string counted(std::int64_t count, std::string_view one, std::string_view many = {});

}  // namespace pliant::cli
