#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant {

/// The file that a mesh file means by a relative URI, there or not, without symbolic links in its
/// path. It is looked for from the mesh file's folder, as the text has it or else with %20 and the
/// like decoded, and lies in the folder `root` or below it, wherever links lead; an empty `root` is
/// the mesh file's folder. Errors: InvalidInput, naming the URI: one with a scheme (file:, http:),
/// an absolute path, a file that lies elsewhere.
Result<std::filesystem::path> find_reference(const std::string& uri,
                                             const std::filesystem::path& mesh_file,
                                             const std::filesystem::path& root);

/// Its bytes. Errors besides, InvalidInput too: it cannot be read, is no regular file, or has more
/// than `max_bytes`.
Result<std::string> read_reference(const std::string& uri, const std::filesystem::path& mesh_file,
                                   const std::filesystem::path& root, std::size_t max_bytes);

}  // namespace pliant
