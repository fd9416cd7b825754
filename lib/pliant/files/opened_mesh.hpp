#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

class OpenFile;

/// The memory that reading takes for a byte of a mesh file and of those that it refers to: the
/// file, its mesh, and as much twice more while it is read. [bytes]
inline constexpr std::size_t bytes_to_read_byte = 4;

/// `read_mesh` of a file that is open: by `read_obj`, `read_ply`, `read_gltf`, or `read_assimp` for
/// FBX and Collada, which alone uses the memory of `context`. Files that it refers to must be in
/// the folder `root` or below; empty: in its own folder. Requires: 0 <= uv_set < max_uv_sets.
Result<Mesh> read_mesh(const OpenFile& file, const std::string& object, int uv_set,
                       const std::filesystem::path& root, const RunContext& context,
                       std::span<const std::string> attributes);

/// The files that `read_mesh` may open besides this one, existing or not: buffers of a glTF. Empty
/// for a file that cannot be read, or if the work was stopped.
std::vector<std::filesystem::path> mesh_references(const OpenFile& file,
                                                   const std::filesystem::path& root,
                                                   const StopRequest& should_stop = {});

}  // namespace pliant
