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
    REQUIRE(tree.clusters().empty() == (count == 0));
    for (const PointTree::Cluster& cluster : tree.clusters()) {
      const auto held = tree.points().middleRows(cluster.first, cluster.count);
      CHECK(held.colwise().minCoeff().transpose() == cluster.low);
      CHECK(held.colwise().maxCoeff().transpose() == cluster.high);
      if (cluster.is_leaf()) {
        CHECK(cluster.count <= PointTree::leaf_size);
        continue;
      }
      const PointTree::Cluster &a = tree.clusters()[cluster.child],
                               &b = tree.clusters()[cluster.child + 1];
      CHECK(a.first == cluster.first);
      CHECK(b.first == a.first + a.count);
      CHECK(a.count + b.count == cluster.count);
    }
  }
}
