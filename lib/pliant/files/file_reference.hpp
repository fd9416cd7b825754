#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The file that a relative URI in a mesh file refers to, existing or not, without symbolic links
/// in its path. The URI is resolved in the mesh file's folder, unchanged or else with %20 and the
/// like decoded. The file must be in the folder `root` or below it after links are resolved; an
/// empty `root` is the mesh file's folder. Errors: InvalidInput, naming the URI: one with a scheme
/// (file:, http:), an absolute path, a file outside `root`. Who reads the file opens it below the
/// root (`OpenFile`).
Result<std::filesystem::path> find_reference(const std::string& uri,
                                             const std::filesystem::path& mesh_file,
                                             const std::filesystem::path& root);

/// The bytes of that file. Further errors, also InvalidInput: it cannot be read, is not a regular
/// file, or has more than `max_bytes`; Interrupted.
Result<std::string> read_reference(const std::string& uri, const std::filesystem::path& mesh_file,
                                   const std::filesystem::path& root, std::size_t max_bytes,
                                   const StopRequest& should_stop = {});

}  // namespace pliant
