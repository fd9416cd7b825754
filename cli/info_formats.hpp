#pragma once

#include <string>

#include "json.hpp"
#include "scene_facts.hpp"

namespace pliant::cli {

/// The output of `pliant info --json`: docs/info.md. In text that is not UTF-8, such as some file
/// names, invalid bytes become U+FFFD.
std::string info_json(const SceneFacts& facts);

/// A preview in that output.
Json preview_json(const Preview& preview, const Scene& scene);

/// The text that `pliant info` prints about a scene.
std::string info_text(const SceneFacts& facts);

}  // namespace pliant::cli
