#include "pliant/mesh/triangles/point_tree.hpp"

#include <algorithm>
#include <numeric>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a tree of points holds each point once, in boxes that fit", "[mesh][point_tree]") {
  for (const int count : {0, 1, 32, 33, 1000}) {
    Field points = Field::Random(count, 3);
    if (count == 1000) points.topRows(200).setConstant(0.5);  // many in one place
    const PointTree tree(points);
    std::vector<int> rows = tree.rows();
    for (int k = 0; k < count; ++k) CHECK(tree.points().row(k) == points.row(rows[k]));
    std::sort(rows.begin(), rows.end());
    std::vector<int> all(count);
    std::iota(all.begin(), all.end(), 0);
    CHECK(rows == all);
    REQUIRE(tree.parts().empty() == (count == 0));
    for (const PointTree::Part& part : tree.parts()) {
      const auto held = tree.points().middleRows(part.first, part.count);
      CHECK(held.colwise().minCoeff().transpose() == part.low);
      CHECK(held.colwise().maxCoeff().transpose() == part.high);
      if (part.is_leaf()) {
        CHECK(part.count <= PointTree::leaf_size);
        continue;
      }
      const PointTree::Part &a = tree.parts()[part.child], &b = tree.parts()[part.child + 1];
      CHECK(a.first == part.first);
      CHECK(b.first == a.first + a.count);
      CHECK(a.count + b.count == part.count);
    }
  }
}
