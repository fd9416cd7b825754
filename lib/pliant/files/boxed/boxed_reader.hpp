#pragma once

#include <span>
#include <string_view>

#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/files/boxed/run_boxed.hpp"

namespace pliant {

/// The executable file of the program `mesh/reader`.
extern const std::span<const unsigned char> mesh_reader_program;

/// `read_assimp` with another program than the embedded one: for tests of programs that crash, hang
/// or lie. Runs the program twice, at the same time and with different bytes in uninitialised
/// memory: if the answers differ, they depend on more than the file. Internal to mesh.
Result<Mesh> read_boxed(std::string_view program, const OpenFile& file, const std::string& object,
                        int uv_set, const RunContext& context);

/// The limits for a file of this size: time, memory and size of the answer.
BoxLimits box_limits(std::size_t file_bytes, std::size_t max_memory);

}  // namespace pliant
