#pragma once

#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Most texture-coordinate sets that a mesh of a file can have.
inline constexpr int max_uv_sets = 8;

/// Reads one object of a glTF (.gltf, .glb), FBX (.fbx) or Collada (.dae) file through assimp.
///
/// An *object* is a node of the file's scene graph that carries faces; a node's meshes, which most
/// formats split by material, become one, in the order of the file. The transforms of the node and
/// of all above it are applied, in double; Collada's unit and up axis count as the outermost, so
/// that its meshes arrive in metres with +y up, while FBX keeps the file's unit and axes. Bones,
/// morph targets and animation are not.
///
/// Vertices come in assimp's order: glTF's as in the file; FBX and Collada have one for each corner
/// of a face, in the order of the faces. Faces keep their corners. Points and lines are passed
/// over. assimp holds coordinates in single precision.
///
/// (u,v) are those of the set `uv_set`, one pair a vertex, v upwards as in OBJ: glTF's v runs down
/// and becomes 1 - v.
///
/// Materials keep their names; corners share a normal where the file's normals and the positions
/// are equal. glTF without normals is flat, as that format has it; the others are smooth.
///
/// `object` names the node, or if no node has that name, a mesh of it. Empty: the file's only one.
///
/// Errors, naming the file: a file that assimp refuses, with its reason; a reference to a file that
/// cannot be read; no faces; an object that is not there, or none named where there are several; a
/// UV set that the object lacks; a transform that is not affine; what `check_mesh` finds;
/// OutOfMemory. Unreadable: the file cannot be read, or is larger than 4 GiB with all that it
/// refers to. Requires: 0 <= uv_set < max_uv_sets.
Result<Mesh> read_assimp(const std::filesystem::path& file, const std::string& object = {},
                         int uv_set = 0);

}  // namespace pliant
