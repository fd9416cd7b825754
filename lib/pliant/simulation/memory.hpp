#pragma once

#include <cstddef>

#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

// What the parts of a run take, known before they are allocated. Not for other rooms.

/// A mesh. [bytes]
std::size_t bytes_of(const Mesh& mesh);

/// The mesh that `make_mesh` makes. Requires: columns, rows >= 3. [bytes]
std::size_t bytes_of(const GridSheet& sheet);

/// Besides the mesh: finding the grid, and then the state, one frame's step without the solver's
/// factor, the frame itself and its way into a file. An upper bound, reached where a force selects
/// the whole surface. [bytes]
std::size_t bytes_to_run(std::size_t vertex_count);

}  // namespace pliant
