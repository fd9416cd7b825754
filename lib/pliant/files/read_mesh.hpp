#pragma once

#include <span>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Reads one object of a mesh file with the reader for the file's ending, in any case: OBJ, PLY,
/// glTF, FBX or Collada; docs/meshes.md. The mesh is as the file has it: vertices keep its order.
///
/// `object` chooses the object if the file has several; `uv_set`, counted from 0, is the set of
/// (u,v): OBJ and PLY have one. Files that it refers to must be in its folder or below.
/// `attributes` names numbers at the vertices that the mesh keeps, of PLY and glTF.
///
/// Errors, naming the file: InvalidInput for another ending, a file that is not of its format, an
/// object, set or attribute that it lacks, and several objects if none is chosen; Unreadable;
/// OutOfMemory; Interrupted.
Result<Mesh> read_mesh(const std::string& file, const std::string& object = {}, int uv_set = 0,
                       std::span<const std::string> attributes = {},
                       const StopRequest& should_stop = {});

}  // namespace pliant
