#include "pliant/plate/overlap/rectangle_cover.hpp"

#include <algorithm>
#include <map>
#include <random>

#include "support/catch.hpp"
#include "support/unions.hpp"

using namespace pliant;
using pliant::testing::union_plate;
using pliant::testing::union_plates;
using pliant::testing::UnionPlate;

namespace {

bool is_interior(const UnionPlate& plate, const Box& box) {
  for (int j = box.j0; j <= box.j1; ++j) {
    for (int i = box.i0; i <= box.i1; ++i) {
      if (!plate.interior[plate.grid.node(i, j)]) return false;
    }
  }
  return true;
}

// Rectangles of interior nodes, none of which can be enlarged, and which together contain all
// nodes.
void check_cover(const UnionPlate& plate, const std::vector<Box>& cover) {
  InteriorMask covered(plate.interior.size(), 0);
  for (const Box& box : cover) {
    CHECK(is_interior(plate, box));
    for (const Box& larger :
         {Box{box.i0 - 1, box.i1, box.j0, box.j1}, Box{box.i0, box.i1 + 1, box.j0, box.j1},
          Box{box.i0, box.i1, box.j0 - 1, box.j1}, Box{box.i0, box.i1, box.j0, box.j1 + 1}}) {
      CHECK_FALSE(is_interior(plate, larger));
    }
    for (int j = box.j0; j <= box.j1; ++j) {
      for (int i = box.i0; i <= box.i1; ++i) covered[plate.grid.node(i, j)] = 1;
    }
  }
  CHECK(covered == plate.interior);
}

UnionPlate transposed(const UnionPlate& plate) {
  const Grid& grid = plate.grid;
  UnionPlate result{plate.name, {grid.rows, grid.columns, grid.hv, grid.hu}, plate.interior};
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      result.interior[result.grid.node(j, i)] = plate.interior[grid.node(i, j)];
    }
  }
  return result;
}

}  // namespace

TEST_CASE("outlines of few boxes are covered by few overlapping rectangles", "[plate][cover]") {
  const std::map<std::string, std::size_t> expected = {
      {"L", 2}, {"T", 2}, {"plus", 2}, {"U", 3}, {"ring", 4}, {"thin strip", 3}, {"neck", 4}};
  for (const int side : {41, 64, 100}) {
    for (const UnionPlate& plate : union_plates(side)) {
      CAPTURE(side, plate.name);
      const auto cover = cover_by_rectangles(plate.outline());
      CHECK(cover.size() == expected.at(plate.name));
      check_cover(plate, cover);
    }
  }
}

TEST_CASE("boxes that only touch are joined by a rectangle across", "[plate][cover]") {
  const UnionPlate plate = union_plate("touching", 41, {{0, 20, 0, 26}, {20, 40, 13, 40}});
  const auto cover = cover_by_rectangles(plate.outline());
  check_cover(plate, cover);
  CHECK(std::count(cover.begin(), cover.end(), Box{1, 39, 14, 25}) == 1);
}

TEST_CASE("a cover of random boxes is one, or there is none", "[plate][cover]") {
  std::mt19937 random(5);
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  int covered = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Box> boxes;
    for (int k = pick(2, 6); k > 0; --k) {
      const int i = pick(0, 30), j = pick(0, 30);
      boxes.push_back({i, i + pick(4, 30), j, j + pick(4, 30)});
    }
    const Patch patch = combine(boxes, Combine::Union).at(0).patches.at(0);
    if (patch.is_rectangle()) continue;
    const UnionPlate plate{"random", {patch.box.columns(), patch.box.rows(), 1, 1}, patch.interior};
    const auto cover = cover_by_rectangles(plate.outline());
    const UnionPlate other = transposed(plate);
    CHECK(cover_by_rectangles(other.outline()).empty() == cover.empty());
    CHECK(cover.size() <= std::size_t{max_cover_rectangles});
    if (cover.empty()) continue;
    check_cover(plate, cover);
    ++covered;
  }
  CHECK(covered > 100);
}

TEST_CASE("ragged outlines are not covered", "[plate][cover]") {
  std::vector<Box> stairs;
  for (int k = 0; k < 20; ++k) stairs.push_back({0, 4 + 2 * k, 0, 44 - 2 * k});
  const UnionPlate plate = union_plate("stairs", 45, stairs);
  CHECK(cover_by_rectangles(plate.outline()).empty());

  UnionPlate ragged = pliant::testing::ell(81);
  std::mt19937 random(3);
  for (int j = 1; j < 80; ++j) {
    // A side that goes in and out from row to row, as recovering nodes leave it.
    for (int i = 70 + static_cast<int>(random() % 8); i < 80; ++i) {
      ragged.interior[ragged.grid.node(i, j)] = 0;
    }
  }
  CHECK(cover_by_rectangles(ragged.outline()).empty());
}
