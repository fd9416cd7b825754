#pragma once

#include <memory>
#include <string>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

namespace pliant {

/// The result of assimp for a file: a scene owned by `importer`; or null, with the reason.
struct AssimpScene {
  std::unique_ptr<Assimp::Importer> importer;
  const aiScene* scene = nullptr;
  bool is_other_format = false;  ///< the bytes do not have the format of that ending
  std::string reason;            ///< assimp's own words; they may quote the file
};

/// Reads the bytes of a file with assimp's readers for an ending, such as "fbx". No
/// post-processing: nothing is reordered, joined, split into triangles or dropped. Throws
/// std::bad_alloc.
AssimpScene read_scene(std::string bytes, const std::string& ending);

}  // namespace pliant
