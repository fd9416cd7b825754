#pragma once

#include <cstddef>
#include <string>

#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"

namespace pliant {

class OpenFile;

// The memory that parts of a run need, known before it is allocated. Internal to sampling.

/// A mesh. [bytes]
std::size_t bytes_of(const Mesh& mesh);

/// The memory for reading a mesh file. [bytes]
std::size_t bytes_to_read(const OpenFile& file);

/// The same for the files that it refers to, which are known only after reading it: that needs
/// memory itself. [bytes]
std::size_t bytes_to_read_references(const OpenFile& file, const std::string& root,
                                     const StopRequest& should_stop);

/// The mesh that `make_mesh` makes. Requires: columns, rows >= 3. [bytes]
std::size_t bytes_of(const GridSheet& sheet);

/// A mesh that is written from nodes, and its weights. [bytes]
std::size_t bytes_of(const WrittenSize& size);

/// The memory besides the mesh: for finding the grid, then for the state, one frame's step without
/// the solver's factor, the frame and writing it to a file. An upper bound, reached if a force
/// selects the whole surface. [bytes]
std::size_t bytes_to_run(std::size_t vertex_count);

/// What reading a mesh as a surface of triangles, and cutting its regions, takes besides. An upper
/// bound. [bytes]
std::size_t bytes_as_surface(const Mesh& mesh);
std::size_t bytes_as_surface(const GridSheet& sheet);

/// The faces of the nodes of a grid. [bytes]
std::size_t bytes_of_faces(const Mesh& mesh);

/// The memory for binding vertices to a driver, and for moving them. `surface`: the driver's
/// triangles; null: they are made of `mesh`. An upper bound. [bytes]
std::size_t bytes_to_bind(std::size_t vertex_count, const TriangleSurface* surface,
                          const Mesh& mesh);

}  // namespace pliant
