#pragma once

#include <string>

#include "pliant/files/boxed/program/read_scene.hpp"

namespace pliant {

/// Writes the scene as a `MeshMessage`: the names of all objects, which are nodes with faces, and
/// the object with the given name; the name of its mesh if no node has it; the only object if
/// `object` is empty. `uv_set` is the set of (u,v) to write. False if writing fails.
bool write_message(int descriptor, const AssimpScene& read, const std::string& object, int uv_set);

}  // namespace pliant
