#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The most bytes of a scene file.
inline constexpr std::size_t largest_scene_file = std::size_t{256} << 20U;

/// Reads a scene file, version 1 (docs/scene-format.md). Mesh paths are relative to its folder;
/// `Simulation::make` reads the meshes. A mesh may be anywhere, but the files it refers to must be
/// in the folder `root` or below; empty: the folder of the scene. Errors: every problem of the file
/// in one `Error`, in the order of lines: malformed XML, after which nothing further is checked;
/// otherwise structure, words, names, numbers, ranges, keys (InvalidInput). A file that cannot be
/// opened or read, or is larger than 256 MiB (Unreadable).
Result<Scene> load_scene(const std::string& file, const std::string& root = {});

/// Reads a scene from text. `name` is the file's name in messages; mesh paths are relative to
/// `folder`, which is also used as `root` if that is empty. Errors as `load_scene`.
Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& folder,
                          const std::string& root = {});

}  // namespace pliant
