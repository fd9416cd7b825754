#pragma once

#include <optional>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::gltf {

/// The parts of a glTF file: a .gltf is text alone.
struct Container {
  std::string_view json;
  std::optional<std::string_view> binary = {};  ///< the chunk of bytes of a .glb
};

/// Takes a .glb apart, or takes the bytes for a .gltf where they do not begin as a .glb does. What
/// it gives is part of `bytes`. Errors, without a file: another version than 2; lengths that are
/// not those of the file and its chunks; a first chunk that is no JSON.
Result<Container> open_container(std::string_view bytes);

}  // namespace pliant::gltf
