#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Gives the bytes of the file that a glTF means by a relative URI, at most `max_bytes` of them.
using ReadReference =
    std::function<Result<std::string>(const std::string& uri, std::size_t max_bytes)>;

/// Reads one object of a glTF 2 file, .gltf or .glb, out of its bytes.
///
/// An *object* is a node of the scene that the file shows which carries faces; the primitives of
/// its mesh, which are split by material, become one, in the order of the file. The transforms of
/// the node and of all above it are applied, in double. Skins, morph targets and animation are not.
///
/// Vertices keep their order. Primitives over the same positions, normals and (u,v) share them.
/// Faces are the triangles, strips and fans; points and lines are passed over. Coordinates are the
/// file's to the last bit where no node moves them.
///
/// (u,v) are those of the set `uv_set`, one pair a vertex, v upwards as in OBJ: 1 - v of the
/// file's.
///
/// Materials keep their names; corners share a normal where the file's normals and the positions
/// are equal. A primitive without normals is flat, as the format has it.
///
/// `object` names the node, or if no node has that name, a mesh of it. Empty: the file's only one.
///
/// `name` stands for the file in messages. Errors, naming it: no glTF 2, with the line, and nothing
/// quoted of what may be any file; an extension that is required and not known; an offset, count,
/// stride or index outside what it points into, a node that stands twice in the scene; a reference
/// that cannot be read; no faces; an object that is not there, or none named where there are
/// several; a UV set that the object lacks; a transform that is not affine; more elements than the
/// bytes can hold; what `check_mesh` finds; OutOfMemory. Requires: 0 <= uv_set < max_uv_sets.
Result<Mesh> parse_gltf(std::string_view bytes, const std::string& name,
                        const ReadReference& read_reference = {}, const std::string& object = {},
                        int uv_set = 0);

/// Reads a file. What it refers to lies in the folder `root` or below (`find_reference`); empty: in
/// its own. Errors: as `parse_gltf`; Unreadable: the file cannot be read, or is larger than 4 GiB
/// with all that it refers to.
Result<Mesh> read_gltf(const std::filesystem::path& file, const std::string& object = {},
                       int uv_set = 0, const std::filesystem::path& root = {});

/// The files that hold buffers of a glTF file, there or not, each once; those that may not be read
/// are left out. None of a file that is no glTF.
std::vector<std::filesystem::path> gltf_references(const std::filesystem::path& file,
                                                   const std::filesystem::path& root = {});

}  // namespace pliant
