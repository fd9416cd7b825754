#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Writes a mesh to a file from which `read_mesh`, asked for its attributes, reads the same mesh to
/// the bit. What tells of a file counts as nothing of the mesh: `object`, which an .obj keeps as
/// far as a line can, `left_out`, `first_index` and `file_vertices`; and normals may get other
/// numbers. The ending chooses the format:
/// - .obj keeps materials and groups, but no attributes, and normals only if the shape tells them
///   apart;
/// - .ply, binary, keeps attributes and all normals, but no materials and groups.
///
/// The file appears whole or not at all. Errors, naming the file: InvalidInput for another ending,
/// for a mesh that `check_mesh` refuses, and for one that the format cannot keep to the bit, naming
/// what would be lost; Unwritable; Interrupted. Cost: the file's bytes in memory, and reading them.
Result<void> write_mesh(const Mesh& mesh, const std::string& file,
                        const StopRequest& should_stop = {});

/// The bytes of that file; nothing is written. Errors: as `write_mesh`.
Result<std::string> mesh_bytes(const Mesh& mesh, const std::string& file,
                               const StopRequest& should_stop = {});

}  // namespace pliant
