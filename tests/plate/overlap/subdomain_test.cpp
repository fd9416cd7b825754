#include "pliant/plate/overlap/subdomain.hpp"

#include <algorithm>

#include "pliant/plate/overlap/rectangle_cover.hpp"
#include "support/catch.hpp"
#include "support/unions.hpp"

using namespace pliant;
using pliant::testing::union_plates;
using pliant::testing::UnionPlate;

namespace {

Box wider(const Box& box) { return {box.i0 - 2, box.i1 + 2, box.j0 - 2, box.j1 + 2}; }

// Whether the stencil at a node reads a node of the box.
bool reads(int i, int j, const Box& box) {
  const int across = std::max({0, box.i0 - i, i - box.i1});
  const int along = std::max({0, box.j0 - j, j - box.j1});
  return across + along <= 2;
}

}  // namespace

TEST_CASE("a subdomain knows the nodes that its clamped sides cut off", "[plate][cover]") {
  for (const UnionPlate& plate : union_plates(41)) {
    CAPTURE(plate.name);
    const Outline outline = plate.outline();
    const Grid& grid = plate.grid;
    for (const Box& box : cover_by_rectangles(outline)) {
      const Subdomain subdomain = subdomain_of(outline, box);
      std::size_t facing = 0;
      for (int j = 1; j + 1 < grid.rows; ++j) {
        for (int i = 1; i + 1 < grid.columns; ++i) {
          if (!outline.holds(i, j)) continue;
          const auto is_cut = [&](int di, int dj) {
            return !box.contains(i + di, j + dj) && outline.holds(i + di, j + dj) ? 1 : 0;
          };
          const int along_u = is_cut(-1, 0) + is_cut(1, 0), along_v = is_cut(0, -1) + is_cut(0, 1);
          const long node = grid.node(i, j);
          if (box.contains(i, j) && along_u + along_v > 0) {
            ++facing;
            CHECK(std::count_if(subdomain.facing.begin(), subdomain.facing.end(),
                                [&](const RowBlocks::Edge& edge) {
                                  return edge.node == node && edge.along_u == along_u &&
                                         edge.along_v == along_v;
                                }) == 1);
          }
          const auto times = std::count(subdomain.around.begin(), subdomain.around.end(), node);
          if (box.contains(i, j)) CHECK(times == 0);
          if (!box.contains(i, j) && reads(i, j, box)) CHECK(times == 1);
        }
      }
      CHECK(subdomain.facing.size() == facing);
      CHECK(std::all_of(subdomain.around.begin(), subdomain.around.end(), [&](long node) {
        return outline.holds(static_cast<int>(node) % grid.columns,
                             static_cast<int>(node) / grid.columns);
      }));
    }
  }
}

TEST_CASE("rectangles at the back of a cover do not meet, and all others meet one",
          "[plate][cover]") {
  for (const UnionPlate& plate : union_plates(41)) {
    CAPTURE(plate.name);
    const std::vector<Box> before = cover_by_rectangles(plate.outline());
    std::vector<Box> cover = before;
    const std::size_t count = move_independent_back(cover);
    REQUIRE(count > 0);
    CHECK(cover.back() == before.back());  // the largest
    CHECK(std::is_permutation(cover.begin(), cover.end(), before.begin(), before.end()));
    const auto back = cover.end() - static_cast<std::ptrdiff_t>(count);
    const auto meetings = [&](const Box& box) {
      return std::count_if(back, cover.end(), [&](const Box& other) {
        return !intersection(wider(box), other).is_empty();
      });
    };
    CHECK(std::all_of(back, cover.end(), [&](const Box& box) { return meetings(box) == 1; }));
    CHECK(std::all_of(cover.begin(), back, [&](const Box& box) { return meetings(box) > 0; }));
  }
}
