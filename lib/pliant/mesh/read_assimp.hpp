#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Most texture-coordinate sets that a mesh of a file can have.
inline constexpr int max_uv_sets = 8;

/// What reading a mesh file may take.
struct ReadLimits {
  /// Of the process that reads an FBX or Collada file; it gets 512 MB at least, since that counts
  /// the libraries too, and no more than the file's size gives reason for. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();

  /// Asked while that process works; reading then ends at once, with Interrupted.
  StopRequest should_stop = {};
};

/// Reads one object of an FBX (.fbx) or Collada (.dae) file through assimp.
///
/// assimp reads outside its buffers where a file is made for it. So it works in a process of its
/// own, which can reach nothing but this file and a pipe, with bounds on memory and time, and what
/// it answers is checked as if the file's author had written it. docs/architecture.md.
///
/// An *object* is a node of the file's scene graph that carries faces; a node's meshes, which most
/// formats split by material, become one, in the order of the file. The transforms of the node and
/// of all above it are applied, in double; Collada's unit and up axis count as the outermost, so
/// that its meshes arrive in metres with +y up, while FBX keeps the file's unit and axes. Bones,
/// morph targets and animation are not.
///
/// There is one vertex for each corner of a face, in the order of the faces. Faces keep their
/// corners. Points and lines are passed over. assimp holds coordinates in single precision.
///
/// (u,v) are those of the set `uv_set`, one pair a vertex, v upwards as in OBJ.
///
/// Materials keep their names; corners share a normal where the file's normals and the positions
/// are equal, and are smooth without normals.
///
/// `object` names the node, or if no node has that name, a mesh of it. Empty: the file's only one.
///
/// Errors, naming the file: a file that assimp refuses, with its reason; one that makes it crash,
/// run on, or need more memory than `limits` and the file's size give; no faces; an object that is
/// not there, or none named where there are several; a UV set that the object lacks; a transform
/// that is not affine; what `check_mesh` finds; OutOfMemory; Interrupted. Unreadable: the file
/// cannot be read, or is larger than 4 GiB, or no process can be started for it.
/// Requires: 0 <= uv_set < max_uv_sets. Any number of threads may read at once.
Result<Mesh> read_assimp(const std::filesystem::path& file, const std::string& object = {},
                         int uv_set = 0, const ReadLimits& limits = {});

}  // namespace pliant
