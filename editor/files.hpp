#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant::editor {

/// Differs if a file was written, deleted, or replaced by another one; empty: there is none.
using FileStamp = std::vector<std::int64_t>;
FileStamp stamp_of(const std::filesystem::path& file);

/// A file in a folder that contains it also if links are followed; it need not be there. Errors:
/// InvalidInput: it is not in the folder, or is there and no regular file.
Result<std::filesystem::path> place_in(const std::string& folder, const std::string& file);

/// Scenes and meshes in a folder and some below it, relative to it, the newest first; at most 200.
std::vector<std::string> scenes_below(const std::string& folder);
std::vector<std::string> meshes_below(const std::string& folder);

}  // namespace pliant::editor
