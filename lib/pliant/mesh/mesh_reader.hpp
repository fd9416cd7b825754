#pragma once

#include <span>

namespace pliant {

/// The file of the program that `mesh/reader` is built into.
extern const std::span<const unsigned char> mesh_reader_program;

}  // namespace pliant
