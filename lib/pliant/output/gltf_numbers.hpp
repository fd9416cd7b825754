#pragma once

#include <filesystem>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

// The file with the numbers of a .gltf, OUT.0123456789abcdef.bin: named by its content, so that a
// .gltf never refers to the numbers of another one, even if the program is killed.

/// In the folder of `gltf`. The digits are the first 16 of the hash of the file's bytes.
std::filesystem::path numbers_file(const std::filesystem::path& gltf, const Hash& hash);

/// Whether a file of that name may be a result of `numbers_file`, for any hash: writing `gltf` may
/// write it, replace it by the same bytes, or remove it.
bool is_numbers_file(const std::filesystem::path& gltf, std::string_view name);

/// Removes number files of `gltf` to which no .gltf in the folder refers. Files that cannot be read
/// or removed are kept, and so are those whose content does not have the hash in their name.
/// Internal to output.
void remove_unnamed_numbers(const std::filesystem::path& gltf);

}  // namespace pliant
