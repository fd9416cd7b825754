#pragma once

#include "pliant/simulation/frame.hpp"

namespace pliant::python {

/// How vectors are laid out in an array of `float` or `double`.
struct Layout {
  bool is_single = false;  ///< rounded to the nearest float
  bool is_by_rows = true;  ///< x, y, z of the first one, then of the next; or all x, all y, all z
};

/// Writes the positions of a surface, in world or object space, to memory that has room for them.
void fill(const SurfaceFrame& surface, bool in_world, void* to, Layout layout);

}  // namespace pliant::python
