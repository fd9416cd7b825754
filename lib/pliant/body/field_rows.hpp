#pragma once

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

// Copies between fields on all nodes of a grid and fields on the nodes of a patch's box, row by
// row. Internal to body.

/// The rows of a box, from a field on all nodes (#box nodes x 3), in the memory of `reuse`.
Field rows_of(const Grid& grid, const Box& box, const Field& nodes, Field reuse);
PlasticField rows_of(const Grid& grid, const Box& box, const PlasticField& nodes,
                     PlasticField reuse);

/// Writes the rows of a box into a field on all nodes.
void put_rows(const Grid& grid, const Box& box, const PlasticField& rows, PlasticField& nodes);

/// The same for the difference a - b.
Field difference_of(const Grid& grid, const Box& box, const Field& a, const Field& b, Field reuse);

/// Writes the solution of a patch, positions and velocities on its box, into fields on all nodes,
/// interior nodes only. `reference` (#nodes x 3) is added to the positions; null: nothing is added.
/// Returns whether all numbers are finite; if not, the fields may be partly written.
bool put_interior(const Grid& grid, const Patch& patch, const Field& displacement,
                  const Field& velocity, const Field* reference, Field& positions,
                  Field& velocities);

/// Copies all nodes except the interior of the rectangle `hole`; empty: copies all.
void copy_around(const Grid& grid, const Box& hole, const Field& from, Field& to);

/// Sets all nodes to 0 except the interior of the rectangle `hole`; empty: sets all.
void clear_around(const Grid& grid, const Box& hole, Field& nodes);

}  // namespace pliant
