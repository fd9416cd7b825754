#pragma once

#include <string>

#include "pliant/mesh/reader/read_scene.hpp"

namespace pliant {

/// Writes what was read as a `MeshMessage`: the names of all objects, which are nodes with faces,
/// and the one that `object` names; by its mesh where no node has the name, and the only one where
/// it is empty. `uv_set` is the one whose numbers are wanted. False where they cannot be written.
bool write_message(int descriptor, const AssimpScene& read, const std::string& object, int uv_set);

}  // namespace pliant
