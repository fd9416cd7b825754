#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace pliant {

constexpr std::uint64_t most_glb_bytes = std::numeric_limits<std::uint32_t>::max();

/// All of a .glb that is before its numbers: the header, the chunk of JSON and, if there are
/// numbers, the head of their chunk (glTF 2.0, 4.4). Null: the file would be larger than
/// `most_glb_bytes`. Requires: a multiple of four bytes of numbers. Internal to output.
std::optional<std::string> glb_head(std::string json, std::uint64_t number_bytes);

}  // namespace pliant
