#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

struct FileObject;
class OpenFile;

/// The most texture-coordinate sets of a mesh in a file.
inline constexpr int max_uv_sets = 8;

/// Reads one object of an FBX (.fbx) or Collada (.dae) file through assimp.
///
/// assimp reads outside its buffers for files made to exploit it. So it runs in a process of its
/// own, which can access only this file and a pipe, with limits on memory and time, and its answer
/// is checked like untrusted input. docs/architecture.md. The process may use what is available of
/// the run's memory, but at least 512 MB, since that includes the libraries, and no more than the
/// file's size justifies; it ends when the run is stopped.
///
/// An *object* is a node of the file's scene graph that has faces; a node's meshes, which most
/// formats split by material, are combined in the order of the file. The transforms of the node and
/// of all its ancestors are applied, in double; Collada's unit and up axis count as the outermost
/// transform, so that its meshes are in metres with +y up, while FBX keeps the file's unit and
/// axes. Bones, morph targets and animation are ignored.
///
/// There is one vertex for each corner of a face, in the order of the faces. Faces keep their
/// corners. Points and lines are left out, and `Mesh::left_out` counts them. assimp stores
/// coordinates in single precision.
///
/// (u,v) are those of the set `uv_set`, one pair per vertex, v upwards as in OBJ.
///
/// Materials keep their names; corners share a normal if the file's normals and the positions are
/// equal; without normals the surface is smooth.
///
/// `object` chooses it by the name of the node or, if no node has it, of a mesh of the node
/// (`find_objects`). Empty: the only one.
///
/// Where the transforms reflect the object, its faces are turned round, so that they keep their
/// outer sides.
///
/// Errors, naming the file: a file that assimp refuses, with its reason; one on which it crashes,
/// does not end, or needs more memory than it may use; no faces; an object that does not exist, or
/// no name given and several objects; a UV set that the object lacks; a transform that is not
/// affine; those of `check_mesh`; OutOfMemory; Interrupted. Unreadable: the file cannot be read, or
/// is larger than 4 GiB, or no process can be started for it. Requires: 0 <= uv_set < max_uv_sets.
/// Thread-safe.
Result<Mesh> read_assimp(const std::filesystem::path& file, const std::string& object = {},
                         int uv_set = 0, const RunContext& context = {});
Result<Mesh> read_assimp(const OpenFile& file, const std::string& object, int uv_set,
                         const RunContext& context);

/// The objects of the file. Errors: as `read_assimp`.
Result<std::vector<FileObject>> assimp_objects(const std::filesystem::path& file,
                                               const RunContext& context = {});

}  // namespace pliant
