#include "pliant/plate/overlap/subdomain.hpp"

#include <algorithm>

namespace pliant {

Subdomain subdomain_of(const Outline& outline, const Box& box) {
  const Grid& grid = outline.grid();
  Subdomain subdomain{box, {}, {}};
  for (int j = box.j0; j <= box.j1; ++j) {
    const bool is_end = j == box.j0 || j == box.j1;
    for (int i = box.i0; i <= box.i1; ++i) {
      // In other rows, only the two nodes at the ends.
      if (!is_end && i == box.i0 + 1 && box.i1 > i) i = box.i1;
      const int along_u =
          (i == box.i0 && outline.holds(i - 1, j)) + (i == box.i1 && outline.holds(i + 1, j));
      const int along_v =
          (j == box.j0 && outline.holds(i, j - 1)) + (j == box.j1 && outline.holds(i, j + 1));
      if (along_u + along_v > 0) subdomain.facing.push_back({grid.node(i, j), along_u, along_v});
    }
  }
  for (int j = std::max(1, box.j0 - 2); j <= std::min(grid.rows - 2, box.j1 + 2); ++j) {
    for (int i = std::max(1, box.i0 - 2); i <= std::min(grid.columns - 2, box.i1 + 2); ++i) {
      if (box.contains(i, j)) {
        i = box.i1;
      } else if (outline.holds(i, j)) {
        subdomain.around.push_back(grid.node(i, j));
      }
    }
  }
  return subdomain;
}

std::size_t move_independent_back(std::vector<Box>& cover) {
  std::vector<Box> back;
  for (std::size_t k = cover.size(); k-- > 0;) {
    const Box& box = cover[k];
    const Box reach{box.i0 - 2, box.i1 + 2, box.j0 - 2, box.j1 + 2};
    const bool is_free = std::all_of(back.begin(), back.end(), [&](const Box& other) {
      return intersection(reach, other).is_empty();
    });
    if (!is_free) continue;
    back.insert(back.begin(), box);
    cover.erase(cover.begin() + static_cast<std::ptrdiff_t>(k));
  }
  cover.insert(cover.end(), back.begin(), back.end());
  return back.size();
}

}  // namespace pliant
