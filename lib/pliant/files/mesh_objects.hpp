#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"

namespace pliant {

/// The endings of the files that are read as meshes, in lower case with their dots.
std::vector<std::string> mesh_endings();

/// An object of a mesh file, which a scene can choose.
struct FileObject {
  std::string name = {};       ///< whole; empty: it has none
  std::string choice = {};     ///< what chooses it: its name, `NAME#2`, or `#3` (docs/meshes.md)
  std::uint64_t vertices = 0;  ///< of the mesh that is read
  std::uint64_t faces = 0;     ///< likewise
};

/// The objects of a mesh file, in its order, at least one.
/// Errors: InvalidInput for another ending, for a file that is not of its format, or one without
/// faces; Unreadable; OutOfMemory; Interrupted.
Result<std::vector<FileObject>> mesh_objects(const std::filesystem::path& file,
                                             const RunContext& context = {});

}  // namespace pliant
