#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/read_assimp.hpp"

namespace pliant {

/// The endings of the mesh files that `read_mesh` reads, in lower case with their dots.
std::vector<std::string> mesh_endings();

/// Reads one object of a mesh file with the reader that the file's ending, in any case, names:
/// `read_obj`, `read_ply`, `read_gltf`, or `read_assimp` for FBX and Collada, which keeps the
/// limits. `object` names the
/// one to take when the file holds several; `uv_set`, counted from 0, is the set of (u,v): OBJ and
/// PLY have one. What the file refers to lies in the folder `root` or below; empty: in its own.
/// Errors: InvalidInput for another ending; those of the readers. Requires: 0 <= uv_set <
/// max_uv_sets.
Result<Mesh> read_mesh(const std::filesystem::path& file, const std::string& object = {},
                       int uv_set = 0, const std::filesystem::path& root = {},
                       const ReadLimits& limits = {});

/// The files that `read_mesh` may open besides this one, there or not: buffers of a glTF. None of a
/// file that cannot be read.
std::vector<std::filesystem::path> mesh_references(const std::filesystem::path& file,
                                                   const std::filesystem::path& root = {});

}  // namespace pliant
