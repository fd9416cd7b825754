#pragma once

#include <span>
#include <string>

#include "cli/commands/scene_facts.hpp"
#include "cli/terminal/json.hpp"
#include "pliant/files/mesh_objects.hpp"

namespace pliant::cli {

/// The output of `pliant info --json`: docs/info.md. In text that is not UTF-8, such as some file
/// names, invalid bytes become U+FFFD.
std::string info_json(const SceneFacts& facts);

/// The objects of a mesh file, likewise.
std::string objects_json(const std::string& file, std::span<const FileObject> objects);

/// A preview in that output.
Json preview_json(const Preview& preview, const Scene& scene);

/// The text that `pliant info` prints about a scene.
std::string info_text(const SceneFacts& facts);

/// The text that it prints about a mesh file.
std::string objects_text(const std::string& file, std::span<const FileObject> objects);

}  // namespace pliant::cli
