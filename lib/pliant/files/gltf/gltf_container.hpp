#pragma once

#include <optional>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::gltf {

/// The parts of a glTF file; a .gltf has only text.
struct Container {
  std::string_view json;
  std::optional<std::string_view> binary = {};  ///< the binary chunk of a .glb
};

/// Splits a .glb, or treats the bytes as a .gltf if they do not begin like a .glb. The result
/// refers to `bytes`. Errors, without a file: another version than 2; lengths that do not match the
/// file and its chunks; a first chunk that is not JSON.
Result<Container> open_container(std::string_view bytes);

}  // namespace pliant::gltf
