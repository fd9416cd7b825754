#pragma once

#include <span>

namespace pliant {

/// The executable file of the program `mesh/reader`.
extern const std::span<const unsigned char> mesh_reader_program;

}  // namespace pliant
