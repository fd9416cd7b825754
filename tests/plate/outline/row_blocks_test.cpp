#include "pliant/plate/outline/row_blocks.hpp"

#include "support/catch.hpp"
#include "support/unions.hpp"

using namespace pliant;

TEST_CASE("runs of rows hold each interior node once, in order", "[plate][schwarz]") {
  for (const auto& [name, grid, interior] : pliant::testing::union_plates(40)) {
    CAPTURE(name);
    const RowBlocks rows(Outline(grid, interior));
    InteriorMask seen(interior.size(), 0);
    std::vector<int> rims(interior.size(), 0);
    long last = -1;
    for (std::size_t block = 0; block < rows.block_count(); ++block) {
      for (const auto& [first, count] : rows.runs(block)) {
        REQUIRE(first > last);
        for (long node = first; node < first + count; ++node) seen[node] = 1;
        last = first + count - 1;
        CHECK(first / grid.columns == last / grid.columns);
      }
      for (const auto& [node, along_u, along_v] : rows.edges(block)) {
        rims[node] += 10 * along_u + along_v;
      }
    }
    CHECK(seen == interior);
    int wrong = 0;
    for (int node = 0; node < grid.node_count(); ++node) {
      if (!interior[node]) {
        wrong += rims[node] != 0;
        continue;
      }
      const int along_u = !interior[node - 1] + !interior[node + 1];
      const int along_v = !interior[node - grid.columns] + !interior[node + grid.columns];
      wrong += rims[node] != 10 * along_u + along_v;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a sum in lanes takes each product once", "[plate][schwarz]") {
  for (long count = 0; count < 40; ++count) {
    std::vector<double> a(40, 1e300), b(40, 1e300);  // numbers beyond the end would be noticed
    double expected = 0;
    for (long k = 0; k < count; ++k) {
      a[k] = static_cast<double>(k + 1);
      b[k] = static_cast<double>(3 * k - 7);
      expected += a[k] * b[k];  // integers: exact in any order
    }
    LaneSum sum;
    sum.add(a.data(), b.data(), count / 2);
    sum.add(a.data() + count / 2, b.data() + count / 2, count - count / 2);
    CHECK(sum.total() == expected);
  }
}
