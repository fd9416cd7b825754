#pragma once

#include <string_view>

#include "pliant/mesh/read_assimp.hpp"
#include "pliant/mesh/run_boxed.hpp"

namespace pliant {

/// `read_assimp` by another program than the one this library carries: for tests of what becomes of
/// one that crashes, hangs or lies. It runs twice, at the same time and with other bytes in memory
/// that it has not written: where the answers differ, they are not of the file alone. Not for other
/// rooms.
Result<Mesh> read_boxed(std::string_view program, const std::filesystem::path& file,
                        const std::string& object, int uv_set, const ReadLimits& limits);

/// What reading a file of so many bytes may take, of the clock, memory and answer.
BoxLimits box_limits(std::size_t file_bytes, std::size_t max_memory);

}  // namespace pliant
