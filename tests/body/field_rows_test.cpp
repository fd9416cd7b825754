#include "pliant/body/field_rows.hpp"

#include <limits>

#include "support/catch.hpp"

using namespace pliant;

namespace {

// Every number differs from all others.
Field numbered(int rows, double first) {
  Field field(rows, 3);
  for (int k = 0; k < field.size(); ++k) field.data()[k] = first + k;
  return field;
}

// Calls f(node, row) for the nodes of a box: their numbers in the grid and in the box.
template <class F>
void for_nodes(const Grid& grid, const Box& box, const F& f) {
  for (int j = box.j0; j <= box.j1; ++j) {
    for (int i = box.i0; i <= box.i1; ++i) {
      f(grid.node_round(i, j), (j - box.j0) * box.columns() + i - box.i0);
    }
  }
}

}  // namespace

TEST_CASE("rows of a box are those of its nodes, also across a seam", "[body][rows]") {
  const Grid open{9, 7, 1, 1}, tube{9, 7, 1, 1, true};
  const std::pair<Grid, Box> cases[] = {
      {open, {2, 5, 1, 4}}, {open, open.box()}, {tube, {7, 11, 0, 6}}, {tube, tube.box()}};
  for (const auto& [grid, box] : cases) {
    const Field a = numbered(grid.node_count(), 0), b = numbered(grid.node_count(), 0.25) * 3;
    const Field rows = rows_of(grid, box, a, {});
    const Field differences = difference_of(grid, box, a, b, numbered(5, 0));  // in used memory
    REQUIRE(rows.rows() == box.columns() * box.rows());
    REQUIRE(differences.rows() == rows.rows());
    for_nodes(grid, box, [&, &a_ = a](int node, int row) {
      CHECK(rows.row(row) == a_.row(node));
      CHECK(differences.row(row) == a_.row(node) - b.row(node));
    });
  }
}

TEST_CASE("a solution is put into the interior of its patch, and nowhere else", "[body][rows]") {
  const Grid grid{9, 7, 1, 1}, tube{9, 7, 1, 1, true};
  Patch masked{{1, 5, 1, 5}, std::vector<std::uint8_t>(25, 0)};
  for (const int k : {6, 7, 12, 18}) masked.interior[static_cast<std::size_t>(k)] = 1;
  Patch ring{{0, 8, 1, 5}, {}};
  ring.is_ring_u = true;
  const std::pair<Grid, Patch> cases[] = {
      {grid, {{2, 6, 1, 5}, {}}}, {grid, masked}, {tube, {{6, 11, 1, 4}, {}}}, {tube, ring}};
  for (const auto& [of, patch] : cases) {
    const int count = patch.box.columns() * patch.box.rows();
    const Field w = numbered(count, 1000), v = numbered(count, 2000);
    const Field reference = numbered(of.node_count(), 5000);
    const bool has_reference = GENERATE(true, false);
    Field positions = Field::Zero(of.node_count(), 3), velocities = positions;
    CHECK(
        put_interior(of, patch, w, v, has_reference ? &reference : nullptr, positions, velocities));
    int put = 0;
    for_nodes(of, patch.box, [&, &p = patch](int node, int row) {
      const int i = p.box.i0 + row % p.box.columns(), j = p.box.j0 + row / p.box.columns();
      if (!p.holds(i, j)) return;
      ++put;
      const Eigen::RowVector3d base =
          has_reference ? Eigen::RowVector3d(reference.row(node)) : Eigen::RowVector3d(0, 0, 0);
      CHECK(positions.row(node) == base + w.row(row));
      CHECK(velocities.row(node) == v.row(row));
    });
    CHECK(put == patch.interior_count());
    CHECK((velocities.col(0).array() != 0).count() == put);
    CHECK((positions.col(0).array() != 0).count() == put);
  }
}

TEST_CASE("a number of a solution that is not finite is told, on the rim it does not matter",
          "[body][rows]") {
  const Grid grid{9, 7, 1, 1};
  const Patch patch{{2, 6, 1, 5}, {}};
  const double bad =
      GENERATE(std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN());
  for (const int row : {0, 6, 12, 24}) {
    for (const bool is_velocity : {false, true}) {
      Field w = numbered(25, 0), v = w, positions = Field::Zero(grid.node_count(), 3);
      Field velocities = positions;
      (is_velocity ? v : w)(row, 2) = bad;
      const bool is_rim = row == 0 || row == 24;
      CHECK(put_interior(grid, patch, w, v, nullptr, positions, velocities) == is_rim);
    }
  }
}

TEST_CASE("around a hole and in it are all nodes", "[body][rows]") {
  const Grid grid{9, 7, 1, 1};
  const Field from = numbered(grid.node_count(), 1), old = numbered(grid.node_count(), 1000);
  for (const Box& hole : {Box{}, Box{2, 6, 1, 5}, Box{0, 8, 0, 6}, Box{3, 4, 2, 5}}) {
    Field copied = old, cleared = old;
    copy_around(grid, hole, from, copied);
    clear_around(grid, hole, cleared);
    const Box inner{hole.i0 + 1, hole.i1 - 1, hole.j0 + 1, hole.j1 - 1};
    for_nodes(grid, grid.box(), [&](int node, int) {
      const bool is_kept = inner.contains(node % grid.columns, node / grid.columns);
      CHECK(copied.row(node) == (is_kept ? old : from).row(node));
      CHECK(cleared.row(node) == (is_kept ? old.row(node).eval() : Eigen::RowVector3d(0, 0, 0)));
    });
  }
}
