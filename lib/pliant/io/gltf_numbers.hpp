#pragma once

#include <filesystem>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

// The file with the numbers of a .gltf, OUT.0123456789abcdef.bin: named by what it holds, so that a
// .gltf never refers to another one's numbers, whenever the program ends.

/// Beside `gltf`. The digits are the first 16 of the hash of the file's bytes.
std::filesystem::path numbers_file(const std::filesystem::path& gltf, const Hash& hash);

/// Whether a file of that name may be one that `numbers_file` gives, of whatever hash: writing
/// `gltf` may write it, replace it by the same bytes, or remove it.
bool is_numbers_file(const std::filesystem::path& gltf, std::string_view name);

/// Removes those of `gltf` that neither it nor any other .gltf in the folder names. What cannot be
/// read or removed stays, and what does not have the hash that its name says. Not for other rooms.
void remove_unnamed_numbers(const std::filesystem::path& gltf);

}  // namespace pliant
