#include "pliant/region/combine.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

bool has_cells(const Box& box) { return box.columns() >= 2 && box.rows() >= 2; }

// A 0 or 1 for each node, or each cell, of a box; a cell has the index of its first node.
class Marks {
 public:
  explicit Marks(const Box& box)
      : box_(box), marks_(std::size_t(box.columns()) * std::size_t(box.rows()), 0) {}

  std::uint8_t& at(int i, int j) { return marks_[place(i, j)]; }
  bool has(int i, int j) const { return box_.contains(i, j) && marks_[place(i, j)] != 0; }

 private:
  std::size_t place(int i, int j) const {
    return std::size_t(j - box_.j0) * std::size_t(box_.columns()) + std::size_t(i - box_.i0);
  }

  Box box_;
  std::vector<std::uint8_t> marks_;
};

Marks cells_of(const Region& region) {
  Marks cells(region.box);
  for (const Box& part : region.parts) {
    for (int j = part.j0; j < part.j1; ++j) {
      for (int i = part.i0; i < part.i1; ++i) cells.at(i, j) = 1;
    }
  }
  return cells;
}

bool is_box(const Region& region) {
  if (region.parts.size() == 1) return true;
  const Marks cells = cells_of(region);
  for (int j = region.box.j0; j < region.box.j1; ++j) {
    for (int i = region.box.i0; i < region.box.i1; ++i) {
      if (!cells.has(i, j)) return false;
    }
  }
  return true;
}

// The boxes that have cells and are not inside another one; in an order that does not depend on the
// input's.
std::vector<Box> union_parts(std::span<const Box> boxes) {
  std::vector<Box> sorted;
  for (const Box& box : boxes) {
    if (has_cells(box)) sorted.push_back(box);
  }
  const auto place = [](const Box& box) { return std::tuple(box.j0, box.i0, -box.j1, -box.i1); };
  std::sort(sorted.begin(), sorted.end(),
            [&](const Box& a, const Box& b) { return place(a) < place(b); });
  std::vector<Box> parts;
  for (const Box& box : sorted) {
    const bool is_inside =
        std::any_of(parts.begin(), parts.end(), [&](const Box& part) { return holds(part, box); });
    if (!is_inside) parts.push_back(box);
  }
  return parts;
}

// Removes one patch from `left`, the interior nodes that belong to no patch yet: the nodes
// connected to node (i,j) by steps to the eight neighbours.
Patch take_patch(Marks& left, int i, int j) {
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
        nodes.emplace_back(p + di, q + dj);
      }
    }
  }
  const Box& box = patch.box;
  const std::size_t in_box = std::size_t(box.columns() - 2) * std::size_t(box.rows() - 2);
  if (nodes.size() == in_box) return patch;
  patch.interior.assign(std::size_t(box.columns()) * std::size_t(box.rows()), 0);
  for (const auto& [p, q] : nodes) {
    patch.interior[std::size_t(q - box.j0) * std::size_t(box.columns()) + std::size_t(p - box.i0)] =
        1;
  }
  return patch;
}

std::vector<Patch> patches_of(const Region& region) {
  const Box& box = region.box;
  if (box.columns() < 3 || box.rows() < 3) return {};
  if (region.parts.size() == 1) return {Patch{box, {}}};
  const Marks cells = cells_of(region);
  Marks left(box);
  for (int j = box.j0 + 1; j < box.j1; ++j) {
    for (int i = box.i0 + 1; i < box.i1; ++i) {
      left.at(i, j) =
          cells.has(i - 1, j - 1) && cells.has(i, j - 1) && cells.has(i - 1, j) && cells.has(i, j);
    }
  }
  std::vector<Patch> patches;
  for (int j = box.j0 + 1; j < box.j1; ++j) {
    for (int i = box.i0 + 1; i < box.i1; ++i) {
      if (left.has(i, j)) patches.push_back(take_patch(left, i, j));
    }
  }
  return patches;
}

// Requires: parts.
Region region_of(std::vector<Box> parts) {
  Region region;
  for (const Box& part : parts) region.box.include(part);
  region.parts = std::move(parts);
  if (is_box(region)) region.parts = {region.box};
  region.patches = patches_of(region);
  return region;
}

}  // namespace

std::vector<Box> merged(std::span<const Box> boxes) {
  std::vector<Box> islands;
  for (Box box : boxes) {
    if (box.is_empty()) continue;
    // Merges each island that the box meets; the larger box may meet others.
    for (auto met = islands.begin(); met != islands.end();) {
      if (intersection(*met, box).is_empty()) {
        ++met;
        continue;
      }
      box.include(*met);
      islands.erase(met);
      met = islands.begin();
    }
    islands.push_back(box);
  }
  std::sort(islands.begin(), islands.end(), [](const Box& a, const Box& b) {
    return std::tuple(a.j0, a.i0) < std::tuple(b.j0, b.i0);
  });
  return islands;
}

std::vector<Region> combine(std::span<const Box> boxes, Combine how) {
  std::vector<Region> regions;
  switch (how) {
    case Combine::Box: {
      Box all;
      for (const Box& box : boxes) all.include(box);
      if (!all.is_empty()) regions.push_back(region_of({all}));
      break;
    }
    case Combine::Islands:
      for (const Box& island : merged(boxes)) regions.push_back(region_of({island}));
      break;
    case Combine::Union:
      if (auto parts = union_parts(boxes); !parts.empty()) {
        regions.push_back(region_of(std::move(parts)));
      }
      break;
  }
  return regions;
}

int Patch::interior_count() const {
  if (is_rectangle()) return (box.columns() - 2) * (box.rows() - 2);
  return static_cast<int>(std::count(interior.begin(), interior.end(), std::uint8_t{1}));
}

}  // namespace pliant
