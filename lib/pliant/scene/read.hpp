#pragma once

#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Reads a scene file, version 1 (docs/scene-format.md), and the files that it includes. Paths in a
/// file are relative to its folder; `Simulation::make` reads the meshes. All files that the scene
/// leads to must be in the folder `root` or below. Empty: those that it names may be anywhere, and
/// those that a mesh refers to must be in the folder of the file that names the mesh, or below.
/// Errors: every problem of the file in one `Error`, in the order of lines: malformed XML, or what
/// is wrong with including and defining, after which nothing further is checked; otherwise
/// structure, words, names, numbers, ranges, keys (InvalidInput). A file that cannot be opened or
/// read, or is larger than 256 MiB (Unreadable). Interrupted.
Result<Scene> load_scene(const std::string& file, const std::string& root = {},
                         const StopRequest& should_stop = {});

/// Reads a scene from text. `name` is the file's name in messages; paths in it are relative to
/// `folder`. Errors as `load_scene`.
Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& folder,
                          const std::string& root = {}, const StopRequest& should_stop = {});

}  // namespace pliant
