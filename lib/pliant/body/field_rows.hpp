#pragma once

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

// Fields on all nodes of a grid and on the nodes of a patch's box, one taken to the other row by
// row. Not for other rooms.

/// The rows of a box out of a field on all nodes (#box nodes x 3), in the memory of `reuse`.
Field rows_of(const Grid& grid, const Box& box, const Field& nodes, Field reuse);

/// The same of the difference a - b.
Field difference_of(const Grid& grid, const Box& box, const Field& a, const Field& b, Field reuse);

/// Writes what a patch's plate became, positions and velocities on its box, into fields on all
/// nodes, interior nodes only. `reference` (#nodes x 3) is added to the positions; none: they are
/// what they are. Whether all of it is finite; the fields may otherwise be half written.
bool put_interior(const Grid& grid, const Patch& patch, const Field& displacement,
                  const Field& velocity, const Field* reference, Field& positions,
                  Field& velocities);

/// Copies all nodes but the interior of the rectangle `hole`, if it has one.
void copy_around(const Grid& grid, const Box& hole, const Field& from, Field& to);

/// Sets to 0 all nodes but the interior of the rectangle `hole`, if it has one.
void clear_around(const Grid& grid, const Box& hole, Field& nodes);

}  // namespace pliant
