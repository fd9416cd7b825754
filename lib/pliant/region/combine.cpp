#include "pliant/region/combine.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/region/box_places.hpp"
#include "pliant/region/closed_boxes.hpp"

namespace pliant {
namespace {

bool has_cells(const Box& box) { return box.columns() >= 2 && box.rows() >= 2; }

// Columns and rows as a box counts them: in a closed grid, from its first one on.
class CountedFrom {
 public:
  CountedFrom(const Grid& grid, const Box& box)
      : first_u_(box.i0),
        first_v_(box.j0),
        lap_u_(grid.is_closed_u ? grid.columns : 0),
        lap_v_(grid.is_closed_v ? grid.rows : 0) {}

  int column(int i) const { return lap_u_ == 0 ? i : counted(i, first_u_, lap_u_); }
  int row(int j) const { return lap_v_ == 0 ? j : counted(j, first_v_, lap_v_); }

 private:
  static int counted(int line, int first, int lap) {
    return line < first ? line + lap : line >= first + lap ? line - lap : line;
  }

  int first_u_, first_v_;
  int lap_u_, lap_v_;  // 0: open
};

// A 0 or 1 for each node, or each cell, of a box; a cell has the index of its first node.
class Marks {
 public:
  Marks(const Grid& grid, const Box& box)
      : from_(grid, box),
        box_(box),
        marks_(std::size_t(box.columns()) * std::size_t(box.rows()), 0) {}

  const CountedFrom& from() const { return from_; }
  std::uint8_t& at(int i, int j) { return marks_[place(from_.column(i), from_.row(j))]; }
  bool has(int i, int j) const {
    i = from_.column(i);
    j = from_.row(j);
    return box_.contains(i, j) && marks_[place(i, j)] != 0;
  }

 private:
  std::size_t place(int i, int j) const {
    return std::size_t(j - box_.j0) * std::size_t(box_.columns()) + std::size_t(i - box_.i0);
  }

  CountedFrom from_;
  Box box_;
  std::vector<std::uint8_t> marks_;
};

// The cells of a box. A ring has one more, across the seam.
Box cells_of(const Grid& grid, const Box& box) {
  return {box.i0, box.i1 - !grid.is_ring_u(box), box.j0, box.j1 - !grid.is_ring_v(box)};
}

Marks cells_of(const Grid& grid, const Region& region) {
  Marks marks(grid, region.box);
  for (const Box& part : region.parts) {
    const Box cells = cells_of(grid, part);
    for (int j = cells.j0; j <= cells.j1; ++j) {
      for (int i = cells.i0; i <= cells.i1; ++i) marks.at(i, j) = 1;
    }
  }
  return marks;
}

bool is_box(const Grid& grid, const Region& region) {
  if (region.parts.size() == 1) return true;
  const Marks marks = cells_of(grid, region);
  const Box cells = cells_of(grid, region.box);
  for (int j = cells.j0; j <= cells.j1; ++j) {
    for (int i = cells.i0; i <= cells.i1; ++i) {
      if (!marks.has(i, j)) return false;
    }
  }
  return true;
}

// The boxes that have cells and are not inside another one; in an order that does not depend on the
// input's.
std::vector<Box> union_parts(const Grid& grid, std::span<const Box> boxes) {
  std::vector<Box> sorted;
  for (const Box& box : boxes) {
    if (has_cells(box)) sorted.push_back(box);
  }
  const auto place = [](const Box& box) { return std::tuple(box.j0, box.i0, -box.j1, -box.i1); };
  std::sort(sorted.begin(), sorted.end(),
            [&](const Box& a, const Box& b) { return place(a) < place(b); });
  std::vector<Box> parts;
  for (const Box& box : sorted) {
    const bool is_inside = std::any_of(parts.begin(), parts.end(),
                                       [&](const Box& part) { return holds(grid, part, box); });
    if (!is_inside) parts.push_back(box);
  }
  return parts;
}

// A patch whose interior nodes are in these columns and rows: they and the rim around them. It is a
// ring if its rims meet behind it.
Patch patch_around(const Grid& grid, const LineMarks& lines) {
  Box box = lines.box();
  box = placed(grid, {box.i0 - 1, box.i1 + 1, box.j0 - 1, box.j1 + 1});
  return {box, {}, grid.is_ring_u(box), grid.is_ring_v(box)};
}

// Removes one patch from `left`, the interior nodes that belong to no patch yet: the nodes
// connected to node (i,j) by steps to the eight neighbours.
Patch take_patch(const Grid& grid, Marks& left, int i, int j) {
  std::vector<std::pair<int, int>> nodes = {{i, j}};
  left.at(i, j) = 0;
  Patch patch;
  for (std::size_t next = 0; next < nodes.size(); ++next) {
    const auto [p, q] = nodes[next];
    patch.box.include({p - 1, p + 1, q - 1, q + 1});
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        if (!left.has(p + di, q + dj)) continue;
        left.at(p + di, q + dj) = 0;
        nodes.emplace_back(left.from().column(p + di), left.from().row(q + dj));
      }
    }
  }
  if (!grid.is_open()) {
    LineMarks lines(grid);
    for (const auto& [p, q] : nodes) lines.include({p, p, q, q});
    patch = patch_around(grid, lines);
  }
  const Box& box = patch.box;
  const Box inner = patch.inner();
  if (nodes.size() == std::size_t(inner.columns()) * std::size_t(inner.rows())) return patch;
  patch.interior.assign(std::size_t(box.columns()) * std::size_t(box.rows()), 0);
  const CountedFrom from(grid, box);
  for (const auto& [p, q] : nodes) {
    patch.interior[std::size_t(from.row(q) - box.j0) * std::size_t(box.columns()) +
                   std::size_t(from.column(p) - box.i0)] = 1;
  }
  return patch;
}

std::vector<Patch> patches_of(const Grid& grid, const Region& region) {
  const Box& box = region.box;
  if (box.columns() < 3 || box.rows() < 3) return {};
  const Patch whole{box, {}, grid.is_ring_u(box), grid.is_ring_v(box)};
  if (region.parts.size() == 1) return {whole};
  const Marks cells = cells_of(grid, region);
  Marks left(grid, box);
  const Box inner = whole.inner();
  for (int j = inner.j0; j <= inner.j1; ++j) {
    for (int i = inner.i0; i <= inner.i1; ++i) {
      left.at(i, j) =
          cells.has(i - 1, j - 1) && cells.has(i, j - 1) && cells.has(i - 1, j) && cells.has(i, j);
    }
  }
  std::vector<Patch> patches;
  for (int j = inner.j0; j <= inner.j1; ++j) {
    for (int i = inner.i0; i <= inner.i1; ++i) {
      if (left.has(i, j)) patches.push_back(take_patch(grid, left, i, j));
    }
  }
  return patches;
}

// Requires: parts.
Region region_of(const Grid& grid, std::vector<Box> parts) {
  Region region;
  region.box = box_around(grid, parts);
  region.parts = std::move(parts);
  if (is_box(grid, region)) region.parts = {region.box};
  region.patches = patches_of(grid, region);
  return region;
}

}  // namespace

std::vector<Box> merged(std::span<const Box> boxes, const Grid& grid) {
  std::map<int, Box> found;  // by number: the islands so far, in the order in which they were made
  BoxPlaces places(grid);
  int number = 0;
  for (Box box : boxes) {
    if (box.is_empty()) continue;
    // Merges each island that the box meets; the larger box may meet others.
    std::set<int> met;
    const auto find_met = [&] {
      for (const int island : places.meeting(box)) {
        places.remove(found[island], island);
        met.insert(island);
      }
    };
    find_met();
    while (!met.empty()) {
      const int island = *met.begin();
      box = box_around(grid, std::array{box, found[island]});
      found.erase(island);
      met.erase(island);
      find_met();
    }
    places.insert(box, number);
    found.emplace(number++, box);
  }
  std::vector<Box> islands;
  for (const auto& [of, box] : found) islands.push_back(box);
  std::sort(islands.begin(), islands.end(), [](const Box& a, const Box& b) {
    return std::tuple(a.j0, a.i0) < std::tuple(b.j0, b.i0);
  });
  return islands;
}

std::vector<Region> combine(std::span<const Box> boxes, Combine how, const Grid& grid) {
  std::vector<Region> regions;
  switch (how) {
    case Combine::Box: {
      const Box all = box_around(grid, boxes);
      if (!all.is_empty()) regions.push_back(region_of(grid, {all}));
      break;
    }
    case Combine::Islands:
      for (const Box& island : merged(boxes, grid)) regions.push_back(region_of(grid, {island}));
      break;
    case Combine::Union:
      if (auto parts = union_parts(grid, boxes); !parts.empty()) {
        regions.push_back(region_of(grid, std::move(parts)));
      }
      break;
  }
  return regions;
}

bool Patch::is_held() const {
  const bool has_rim = !interior.empty() && !has_held_nodes;
  return is_held_within || has_rim || edges.hold(is_ring_u, is_ring_v);
}

int Patch::interior_count() const {
  if (interior.empty()) return inner().columns() * inner().rows();
  return static_cast<int>(std::count(interior.begin(), interior.end(), std::uint8_t{1}));
}

}  // namespace pliant
