#include "pliant/mesh/written/vertex_weights.hpp"

#include "support/catch.hpp"

using namespace pliant;

namespace {

const VertexWeights three_vertices = {
    .starts = {0, 1, 1, 4}, .nodes = {1, 2, 0, 1}, .weights = {1, 0.5, 0.25, 2}};

Field nodes_at(double shift) {
  Field nodes(3, 3);
  nodes << 1, 2, 3, 10, 20, 30, 100, 200, 300;
  return nodes.array() + shift;
}

}  // namespace

TEST_CASE("a vertex is the weighted sum of its nodes", "[mesh][vertex_weights]") {
  const Field vertices = three_vertices.apply(nodes_at(0));
  REQUIRE(vertices.rows() == 3);
  CHECK(vertices.row(0) == Eigen::RowVector3d(10, 20, 30));
  CHECK(vertices.row(1) == Eigen::RowVector3d(0, 0, 0));
  CHECK(vertices.row(2) == Eigen::RowVector3d(70.25, 140.5, 210.75));
}

TEST_CASE("a field that is reused keeps its memory", "[mesh][vertex_weights]") {
  Field vertices = three_vertices.apply(nodes_at(0));
  const double* const memory = vertices.data();
  vertices = three_vertices.apply(nodes_at(1), std::move(vertices));
  CHECK(vertices.data() == memory);
  CHECK(vertices.row(0) == Eigen::RowVector3d(11, 21, 31));
}
