#include "pliant/region/combine.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "pliant/region/closed_boxes.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

std::vector<Box> random_boxes(std::mt19937& random, int most, int extent) {
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  std::vector<Box> boxes;
  for (int k = pick(0, most); k > 0; --k) {
    const int i = pick(0, extent), j = pick(0, extent);
    boxes.push_back({i, i + pick(-1, 6), j, j + pick(0, 6)});
  }
  return boxes;
}

bool share_a_node(const Box& a, const Box& b) {
  for (int j = a.j0; j <= a.j1; ++j) {
    for (int i = a.i0; i <= a.i1; ++i) {
      if (b.contains(i, j)) return true;
    }
  }
  return false;
}

// SPEC 5 word for word: any two boxes that share a node become one, until none do.
std::vector<Box> merged_one_by_one(std::vector<Box> boxes) {
  std::erase_if(boxes, [](const Box& box) { return box.is_empty(); });
  for (bool is_done = false; !is_done;) {
    is_done = true;
    for (std::size_t a = 0; a < boxes.size() && is_done; ++a) {
      for (std::size_t b = a + 1; b < boxes.size() && is_done; ++b) {
        if (!share_a_node(boxes[a], boxes[b])) continue;
        boxes[a].include(boxes[b]);
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(b));
        is_done = false;
      }
    }
  }
  return boxes;
}

bool is_cell(const std::vector<Box>& boxes, int i, int j) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    return box.contains(i, j) && box.contains(i + 1, j + 1);
  });
}

bool is_interior(const std::vector<Box>& boxes, int i, int j) {
  return is_cell(boxes, i - 1, j - 1) && is_cell(boxes, i, j - 1) && is_cell(boxes, i - 1, j) &&
         is_cell(boxes, i, j);
}

}  // namespace

TEST_CASE("islands are the fixpoint of merging, whatever the order", "[region][islands]") {
  std::mt19937 random(3);
  int merges = 0, apart = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<Box> boxes = random_boxes(random, 9, 24);
    const std::vector<Box> islands = merged(boxes);
    std::vector<Box> expected = merged_one_by_one(boxes);
    CHECK(std::is_permutation(islands.begin(), islands.end(), expected.begin(), expected.end()));
    std::shuffle(boxes.begin(), boxes.end(), random);
    CHECK(merged(boxes) == islands);
    merges += islands.size() < boxes.size();
    apart += islands.size() > 1;
  }
  CHECK(merges > 100);
  CHECK(apart > 100);
}

TEST_CASE("a merged box that meets a third takes it in", "[region][islands]") {
  // The first two share one node; only their common box reaches the third.
  const std::vector<Box> boxes{{0, 2, 0, 2}, {2, 6, 2, 6}, {5, 8, 0, 1}};
  CHECK(merged(boxes) == std::vector<Box>{{0, 8, 0, 6}});
  CHECK(merged(std::vector<Box>{{0, 2, 0, 2}, {3, 5, 0, 2}}).size() == 2);  // no shared node
}

TEST_CASE("the interior of a union is the nodes whose four cells are inside", "[region][union]") {
  std::mt19937 random(5);
  int shapes = 0, several = 0, none = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<Box> boxes = random_boxes(random, 5, 12);
    const std::vector<Region> regions = combine(boxes, Combine::Union);
    std::vector<Patch> patches;
    if (!regions.empty()) patches = regions[0].patches;
    for (int j = -1; j < 22; ++j) {
      for (int i = -1; i < 22; ++i) {
        const auto holding = std::count_if(patches.begin(), patches.end(),
                                           [&](const Patch& patch) { return patch.holds(i, j); });
        REQUIRE(holding == is_interior(boxes, i, j));
      }
    }
    for (const Patch& patch : patches) {
      shapes += !patch.is_rectangle();
      CHECK(patch.box.columns() >= 3);
      CHECK(patch.box.rows() >= 3);
    }
    several += patches.size() > 1;
    none += patches.empty();
    std::shuffle(boxes.begin(), boxes.end(), random);
    CHECK(combine(boxes, Combine::Union) == regions);
  }
  CHECK(shapes > 50);
  CHECK(several > 50);
  CHECK(none > 10);
}

TEST_CASE("patches do not neighbour each other", "[region][union]") {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Region> regions = combine(random_boxes(random, 5, 14), Combine::Union);
    if (regions.empty()) continue;
    const std::vector<Patch> patches = regions[0].patches;
    for (std::size_t a = 0; a < patches.size(); ++a) {
      const Box& box = patches[a].box;
      for (int j = box.j0; j <= box.j1; ++j) {
        for (int i = box.i0; i <= box.i1; ++i) {
          if (!patches[a].holds(i, j)) continue;
          for (std::size_t b = 0; b < patches.size(); ++b) {
            for (int k = 0; k < 9 && a != b; ++k) {
              REQUIRE_FALSE(patches[b].holds(i - 1 + k % 3, j - 1 + k / 3));
            }
          }
        }
      }
    }
  }
}

TEST_CASE("a union that is a box is that box", "[region][union]") {
  const std::vector<Box> halves{{2, 6, 1, 9}, {6, 8, 1, 9}, {3, 5, 3, 4}};
  CHECK(combine(halves, Combine::Union) == combine(std::vector<Box>{{2, 8, 1, 9}}, Combine::Box));
  CHECK(combine(halves, Combine::Union)[0].patches == std::vector<Patch>{Patch{{2, 8, 1, 9}, {}}});
  // With a column of nodes between them they are two.
  const std::vector<Region> apart =
      combine(std::vector<Box>{{2, 5, 1, 9}, {6, 8, 1, 9}}, Combine::Union);
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].box == Box{2, 8, 1, 9});
  CHECK(apart[0].patches == std::vector<Patch>{Patch{{2, 5, 1, 9}, {}}, Patch{{6, 8, 1, 9}, {}}});
}

TEST_CASE("thin boxes have cells but no interior, lines have neither", "[region][union]") {
  CHECK(combine(std::vector<Box>{{1, 1, 0, 9}, {4, 4, 4, 4}}, Combine::Union).empty());
  const std::vector<Region> strip = combine(std::vector<Box>{{1, 2, 0, 9}}, Combine::Union);
  REQUIRE(strip.size() == 1);
  CHECK(strip[0].patches.empty());
  // Two adjacent strips have an interior together, and so has a strip beside a box.
  CHECK(combine(std::vector<Box>{{1, 2, 0, 9}, {2, 3, 0, 9}}, Combine::Union)[0].patches ==
        std::vector<Patch>{Patch{{1, 3, 0, 9}, {}}});
  const std::vector<Region> wider =
      combine(std::vector<Box>{{0, 4, 0, 4}, {4, 5, 0, 2}}, Combine::Union);
  CHECK(wider[0].box == Box{0, 5, 0, 4});
  REQUIRE(wider[0].patches.size() == 1);
  CHECK(wider[0].patches[0].interior_count() == 10);
}

namespace {

// One pair after another, as long as two boxes meet.
std::vector<Box> slowly_merged(std::vector<Box> boxes, const Grid& grid) {
  std::vector<Box> islands;
  for (Box box : boxes) {
    if (box.is_empty()) continue;
    for (auto met = islands.begin(); met != islands.end();) {
      if (!meet(grid, *met, box)) {
        ++met;
        continue;
      }
      box = box_around(grid, std::array{box, *met});
      islands.erase(met);
      met = islands.begin();
    }
    islands.push_back(box);
  }
  std::ranges::sort(islands, {}, [](const Box& box) { return std::pair(box.j0, box.i0); });
  return islands;
}

}  // namespace

TEST_CASE("many boxes are merged as a few are", "[region][combine]") {
  std::mt19937 random(3);
  const auto chance = [&](int count) {
    return static_cast<int>(random() % static_cast<unsigned>(count));
  };
  for (int round = 0; round < 200; ++round) {
    const Grid grid{40, 30, 1, 1, round % 3 == 1, round % 5 == 1};
    std::vector<Box> boxes;
    for (int k = chance(60); k >= 0; --k) {
      const int i = chance(40), j = chance(30), columns = chance(6), rows = chance(6);
      const int last_u = grid.is_closed_u ? i + columns : std::min(i + columns, 39);
      const int last_v = grid.is_closed_v ? j + rows : std::min(j + rows, 29);
      boxes.push_back({i, last_u, j, last_v});
    }
    CAPTURE(round);
    CHECK(merged(boxes, grid) == slowly_merged(boxes, grid));
  }
}
