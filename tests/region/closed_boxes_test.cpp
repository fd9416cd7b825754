#include "pliant/region/closed_boxes.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "pliant/region/region.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;

namespace {

using NodeSet = std::set<int>;

Grid closed_grid(std::mt19937& random) {
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const int closed = pick(1, 3);
  return {pick(3, 12), pick(3, 9), 1, 1, (closed & 1) != 0, (closed & 2) != 0};
}

Box random_box(const Grid& grid, std::mt19937& random) {
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const int i = pick(0, grid.columns - 1), j = pick(0, grid.rows - 1);
  const int u = std::min(pick(0, 12), grid.is_closed_u ? grid.columns - 1 : grid.columns - 1 - i);
  const int v = std::min(pick(0, 9), grid.is_closed_v ? grid.rows - 1 : grid.rows - 1 - j);
  return placed(grid, {i, i + u, j, j + v});
}

std::vector<Box> random_boxes(const Grid& grid, int most, std::mt19937& random) {
  std::vector<Box> boxes(std::uniform_int_distribution<std::size_t>(1, most)(random));
  for (Box& box : boxes) box = random_box(grid, random);
  return boxes;
}

NodeSet nodes_of(const Grid& grid, const Box& box) {
  NodeSet nodes;
  for (int j = box.j0; j <= box.j1; ++j) {
    for (int i = box.i0; i <= box.i1; ++i)
      nodes.insert(j % grid.rows * grid.columns + i % grid.columns);
  }
  return nodes;
}

bool includes(const NodeSet& outer, const NodeSet& inner) {
  return std::includes(outer.begin(), outer.end(), inner.begin(), inner.end());
}

// All boxes of a grid: those that start first come first, and of these the smallest.
std::vector<Box> all_boxes(const Grid& grid) {
  std::vector<Box> boxes;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      for (int v = 0; v < grid.rows; ++v) {
        for (int u = 0; u < grid.columns; ++u) {
          const Box box{i, i + u, j, j + v};
          const bool fits_u = box.i1 < grid.columns || grid.is_closed_u;
          const bool fits_v = box.j1 < grid.rows || grid.is_closed_v;
          if (fits_u && fits_v) boxes.push_back(box);
        }
      }
    }
  }
  return boxes;
}

// The smallest box that holds the nodes; of several, the one that begins first.
Box slow_box_around(const Grid& grid, const NodeSet& nodes) {
  Box best;
  int least = grid.node_count() + 1;
  for (const Box& box : all_boxes(grid)) {
    if (box.columns() * box.rows() >= least || !includes(nodes_of(grid, box), nodes)) continue;
    best = box;
    least = box.columns() * box.rows();
  }
  return best;
}

Box turned(const Grid& grid, Box box, int by) {
  const int columns = box.columns();
  if (columns == grid.columns) return box;
  box.i0 = (box.i0 + by) % grid.columns;
  box.i1 = box.i0 + columns - 1;
  return box;
}

NodeSet interior_nodes(const Grid& grid, const Patch& patch) {
  NodeSet nodes;
  for (int j = patch.box.j0; j <= patch.box.j1; ++j) {
    for (int i = patch.box.i0; i <= patch.box.i1; ++i) {
      if (patch.holds(i, j)) nodes.insert(grid.node_round(i, j));
    }
  }
  return nodes;
}

}  // namespace

TEST_CASE("boxes of a closed grid meet, hold and are held as their nodes do", "[region][closed]") {
  std::mt19937 random(21);
  int twice = 0, rings = 0;
  for (int trial = 0; trial < testing::rounds(400); ++trial) {
    const Grid grid = closed_grid(random);
    const Box a = random_box(grid, random), b = random_box(grid, random);
    CAPTURE(grid.columns, grid.rows, grid.is_closed_u, grid.is_closed_v, a.i0, a.i1, a.j0, a.j1,
            b.i0, b.i1, b.j0, b.j1);
    const NodeSet of_a = nodes_of(grid, a), of_b = nodes_of(grid, b);
    NodeSet expected;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          std::inserter(expected, expected.end()));
    NodeSet shared;
    int visits = 0, visited = 0;
    for_each_shared(grid, a, b, [&](const Box& box) {
      CHECK(holds(a, box));  // in the columns and rows of a
      visited += box.columns() * box.rows();
      ++visits;
      shared.merge(nodes_of(grid, box));
    });
    CHECK(shared == expected);
    CHECK(visited == static_cast<int>(expected.size()));  // each node once
    CHECK(meet(grid, a, b) == !expected.empty());
    CHECK(holds(grid, a, b) == includes(of_a, of_b));
    const Box around = box_around(grid, std::vector{a, b});
    NodeSet both = of_a;
    both.insert(of_b.begin(), of_b.end());
    CHECK(around == slow_box_around(grid, both));
    NodeSet stretches;
    for (int j = a.j0; j <= a.j1; ++j) {
      int count = 0;
      for_each_stretch(grid, a.i0, a.i1, j, [&](int node, int offset, int length) {
        CHECK(offset == count);
        count += length;
        for (int k = 0; k < length; ++k) {
          CHECK(node + k == grid.node_round(a.i0 + offset + k, j));
          stretches.insert(node + k);
        }
      });
      CHECK(count == a.columns());
    }
    CHECK(stretches == of_a);
    twice += visits > 1;
    rings += grid.is_ring_u(around) || grid.is_ring_v(around);
  }
  CHECK(twice > testing::rounds(20));
  CHECK(rings > testing::rounds(50));
}

TEST_CASE("of equal runs round a grid the one that starts first is taken", "[region][closed]") {
  const Grid grid{12, 5, 1, 1, true, false};
  const auto around = [&](std::vector<int> columns) {
    LineMarks marks(grid);
    for (const int column : columns) marks.include(column, 2);
    return marks.box();
  };
  CHECK(around({0, 6}) == Box{0, 6, 2, 2});
  CHECK(around({3, 9}) == Box{3, 9, 2, 2});
  CHECK(around({1, 5, 9}) == Box{1, 9, 2, 2});
  CHECK(around({0, 11}) == Box{11, 12, 2, 2});
  CHECK(around({0, 1, 10}) == Box{10, 13, 2, 2});
  CHECK(around({0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11}) == Box{6, 16, 2, 2});
  CHECK(around({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) == Box{0, 11, 2, 2});
  CHECK(around({}).is_empty());
}

TEST_CASE("regions of a closed grid are those of its cells, counted round",
          "[region][closed][union]") {
  std::mt19937 random(22);
  int rings = 0, crossing = 0, masks = 0, several = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Grid grid = closed_grid(random);
    std::vector<Box> boxes = random_boxes(grid, 4, random);
    CAPTURE(trial, grid.columns, grid.rows, grid.is_closed_u, grid.is_closed_v);
    // A cell has the number of its first node; those of a ring go all round.
    NodeSet cells;
    for (const Box& box : boxes) {
      const int last_u = box.i1 - !grid.is_ring_u(box), last_v = box.j1 - !grid.is_ring_v(box);
      for (int j = box.j0; j <= last_v; ++j) {
        for (int i = box.i0; i <= last_u; ++i) cells.insert(grid.node_round(i, j));
      }
    }
    const auto has_cell = [&](int i, int j) {
      if ((!grid.is_closed_u && i < 0) || (!grid.is_closed_v && j < 0)) return false;
      return cells.count(grid.node_round(i, j)) > 0;
    };
    NodeSet interior;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        if (has_cell(i, j) && has_cell(i - 1, j) && has_cell(i, j - 1) && has_cell(i - 1, j - 1))
          interior.insert(grid.node(i, j));
      }
    }
    const auto regions = combine(boxes, Combine::Union, grid);
    std::shuffle(boxes.begin(), boxes.end(), random);
    REQUIRE(combine(boxes, Combine::Union, grid) == regions);
    if (regions.empty()) continue;
    REQUIRE(regions.size() == 1);
    NodeSet found;
    for (const Patch& patch : regions[0].patches) {
      const NodeSet nodes = interior_nodes(grid, patch);
      CHECK(static_cast<int>(nodes.size()) == patch.interior_count());
      for (const int node : nodes) CHECK(found.insert(node).second);
      // It has a place for each of the eight neighbours.
      const Box inner = patch.inner();
      for (int j = inner.j0; j <= inner.j1; ++j) {
        for (int i = inner.i0; i <= inner.i1; ++i) {
          if (!patch.holds(i, j)) continue;
          CHECK((patch.is_ring_u || (i > patch.box.i0 && i < patch.box.i1)));
          CHECK((patch.is_ring_v || (j > patch.box.j0 && j < patch.box.j1)));
        }
      }
      CHECK(patch.box == placed(grid, patch.box));
      CHECK(patch.is_ring_u == grid.is_ring_u(patch.box));
      CHECK(patch.is_ring_v == grid.is_ring_v(patch.box));
      CHECK(patch.inner().columns() >= 1);
      CHECK(holds(grid, regions[0].box, patch.box));
      rings += patch.is_ring_u || patch.is_ring_v;
      crossing += patch.box.i1 >= grid.columns || patch.box.j1 >= grid.rows;
      masks += !patch.interior.empty();
    }
    CHECK(found == interior);
    several += regions[0].patches.size() > 1;

    for (const Box& island : merged(boxes, grid)) {
      const auto region = combine(std::vector{island}, Combine::Islands, grid);
      REQUIRE(region.size() == 1);
      CHECK(region[0].box == island);
    }
  }
  CHECK(rings > 100);
  CHECK(crossing > 50);
  CHECK(masks > 100);
  CHECK(several > 10);
}

TEST_CASE("islands of a closed grid share no node and hold every box", "[region][closed]") {
  std::mt19937 random(23);
  int merges = 0, apart = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Grid grid = closed_grid(random);
    std::vector<Box> boxes = random_boxes(grid, 5, random);
    const std::vector<Box> islands = merged(boxes, grid);
    for (std::size_t a = 0; a < islands.size(); ++a) {
      for (std::size_t b = a + 1; b < islands.size(); ++b)
        CHECK_FALSE(meet(grid, islands[a], islands[b]));
    }
    for (const Box& box : boxes) {
      CHECK(std::any_of(islands.begin(), islands.end(),
                        [&](const Box& island) { return holds(grid, island, box); }));
    }
    std::shuffle(boxes.begin(), boxes.end(), random);
    CHECK(merged(boxes, grid) == islands);
    merges += islands.size() < boxes.size();
    apart += islands.size() > 1;
  }
  CHECK(merges > 100);
  CHECK(apart > 30);
}

TEST_CASE("boxes that are moved round a grid make the same plates", "[region][closed]") {
  std::mt19937 random(24);
  int solved = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Grid grid = closed_grid(random);
    grid.is_closed_u = true;
    const std::vector<Box> boxes = random_boxes(grid, 3, random);
    const int by = std::uniform_int_distribution<int>(1, grid.columns - 1)(random);
    std::vector<Box> moved;
    for (const Box& box : boxes) moved.push_back(turned(grid, box, by));
    const auto before = combine(boxes, Combine::Union, grid);
    const auto after = combine(moved, Combine::Union, grid);
    REQUIRE(before.size() == after.size());
    NodeSet expected, found;
    for (const Region& region : before) {
      for (const Patch& patch : region.patches) {
        for (const int node : interior_nodes(grid, patch))
          expected.insert(node / grid.columns * grid.columns +
                          (node % grid.columns + by) % grid.columns);
      }
    }
    for (const Region& region : after) {
      for (const Patch& patch : region.patches) found.merge(interior_nodes(grid, patch));
    }
    CHECK(found == expected);
    solved += !found.empty();
  }
  CHECK(solved > 50);
}
