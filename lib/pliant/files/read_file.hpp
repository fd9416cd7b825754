#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

class OpenFile;

/// All bytes of a file. Errors: Unreadable, naming the file and the reason: it does not exist, is a
/// folder, may not be read, or is larger than `max_bytes`. Interrupted.
Result<std::string> read_file(const std::filesystem::path& file,
                              std::size_t max_bytes = std::size_t{4} << 30,
                              const StopRequest& should_stop = {});

/// The same of an open file, from its beginning.
Result<std::string> read_file(const OpenFile& file, std::size_t max_bytes = std::size_t{4} << 30,
                              const StopRequest& should_stop = {});

/// Passes the bytes of a file to `take`, in pieces, until it returns false. Errors: as `read_file`,
/// for a file of any size.
Result<void> read_pieces(const std::filesystem::path& file,
                         const std::function<bool(std::string_view)>& take);
Result<void> read_pieces(const OpenFile& file, const std::function<bool(std::string_view)>& take);

/// The hash of an open file's bytes, in little memory. Errors: as `read_file`, for a file of any
/// size.
Result<Hash> hash_of_file(const OpenFile& file, const StopRequest& should_stop = {});

/// Whether a file exists, is not a folder and may be read; does not open it. Errors: as
/// `read_file`.
Result<void> check_readable(const std::filesystem::path& file);

}  // namespace pliant
