#pragma once

#include <filesystem>
#include <string_view>

#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// Whether two paths lead to one file, there or not.
bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// What `file` is to a scene that was read from a file: "it is the scene", "it is a mesh of the
/// scene"; empty: neither.
std::string_view input_named(const std::filesystem::path& file, const Scene& scene);

}  // namespace pliant::cli
