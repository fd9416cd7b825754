#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "pliant/core/hash.hpp"

namespace pliant {

// The file with the numbers of a .gltf, OUT.0123456789abcdef.bin: named by its content, so that a
// .gltf never refers to the numbers of another one, even if the program is killed.

/// In the folder of `gltf`. The digits are the first 16 of the hash of the file's bytes.
std::filesystem::path numbers_file(const std::filesystem::path& gltf, const Hash& hash);

/// Whether a file of that name may be a result of `numbers_file`, for any hash: writing `gltf` may
/// write it, replace it by the same bytes, or remove it.
bool is_numbers_file(const std::filesystem::path& gltf, std::string_view name);

/// The files with numbers that `gltf` refers to as it is on the disk: those of an earlier bake to
/// that name. Internal to output.
std::vector<std::filesystem::path> numbers_named_by(const std::filesystem::path& gltf);

/// Removes those of the files to which no .gltf or .glb in the folder refers, however it escapes
/// their names. Files that cannot be read or removed are kept, and so are those whose content does
/// not have the hash in their name, and all of them if it cannot be known. Internal to output.
void remove_unnamed_numbers(const std::filesystem::path& gltf,
                            std::vector<std::filesystem::path> files);

}  // namespace pliant
