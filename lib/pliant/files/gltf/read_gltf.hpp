#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

class OpenFile;

/// Returns the bytes of the file that a relative URI in a glTF refers to, at most `max_bytes`.
using ReadReference =
    std::function<Result<std::string>(const std::string& uri, std::size_t max_bytes)>;

/// Reads one object of a glTF 2 file, .gltf or .glb, from its bytes.
///
/// An *object* is a node of the displayed scene that has faces; the primitives of its mesh, which
/// are split by material, are combined in the order of the file. The transforms of the node and of
/// all its ancestors are applied, in double. Skins, morph targets and animation are ignored.
///
/// Vertices keep their order. Primitives with the same positions, normals and (u,v) share their
/// vertices. Faces are the triangles, strips and fans. Coordinates are bit-identical to the file's
/// unless a node transforms them. Where the transforms reflect the object, its faces are turned
/// round, so that they keep their outer sides.
///
/// As other programs do, it leaves out primitives of points and lines, (u,v) that are no numbers,
/// and required extensions that concern looks only; `Mesh::left_out` counts them.
/// KHR_mesh_quantization is read. A file without a scene shows all its nodes.
///
/// (u,v) are those of the set `uv_set`, one pair per vertex, v upwards as in OBJ: 1 - v of the
/// file.
///
/// Materials keep their names; corners share a normal if the file's normals and the positions are
/// equal. A primitive without normals is flat, as the format requires.
///
/// `attributes` names attributes of the author's own, such as `_SOFT`, that the mesh keeps; every
/// primitive must have them.
///
/// `object` chooses it by the name of the node or, if no node has it, of a mesh of the node
/// (`find_objects`). Empty: the only one.
///
/// `name` is the file's name in messages. Errors, naming it: not glTF 2, with the line, but without
/// quoting the text, which may be of any file; a required extension that is not supported; an
/// offset, count, stride or index out of range; nodes of the file that are within themselves; a
/// node that occurs twice in the scene; a reference that cannot be read; no faces; an object that
/// does not exist, or no name given and several objects; a UV set or an attribute that the object
/// lacks; a transform that is not affine; more elements than the bytes allow; those of
/// `check_mesh`; OutOfMemory; Interrupted. Requires: 0 <= uv_set < max_uv_sets.
Result<Mesh> parse_gltf(std::string_view bytes, const std::string& name,
                        const ReadReference& read_reference = {}, const std::string& object = {},
                        int uv_set = 0, std::span<const std::string> attributes = {},
                        const StopRequest& should_stop = {});

/// Reads a file. Files that it refers to must be in the folder `root` or below (`find_reference`);
/// empty: in its own folder. Errors: as `parse_gltf`; Unreadable: the file cannot be read, or is
/// larger than 4 GiB with all that it refers to.
Result<Mesh> read_gltf(const OpenFile& file, const std::string& object, int uv_set,
                       const std::filesystem::path& root, std::span<const std::string> attributes,
                       const StopRequest& should_stop = {});

/// The objects of a file; their numbers are not read. Errors: as `read_gltf`.
Result<std::vector<FileObject>> gltf_objects(const std::filesystem::path& file,
                                             const StopRequest& should_stop = {});

/// The files with buffers of a glTF file, existing or not, each once; those that may not be read
/// are omitted. Empty if the file is not glTF, or if the work was stopped.
std::vector<std::filesystem::path> gltf_references(const OpenFile& file,
                                                   const std::filesystem::path& root,
                                                   const StopRequest& should_stop = {});

}  // namespace pliant
