#include "pliant/body/patch_rows.hpp"

#include <limits>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

namespace {

constexpr int node_count = 63;

// Every number differs from all others.
template <class Rows = Field>
Rows numbered(int rows, double first) {
  Rows field(rows, Rows::ColsAtCompileTime);
  for (int k = 0; k < field.size(); ++k) field.data()[k] = first + k;
  return field;
}

// The nodes of rows 0, 1, 2, ...: side by side, apart, and in an order that crosses a seam.
const std::vector<std::vector<int>> patches = {
    {}, {0}, {5, 6, 7, 20, 21, 40, 62}, {7, 8, 0, 1, 16, 17, 9, 10}};

std::vector<RowRun> runs_of(const std::vector<int>& nodes) {
  std::vector<RowRun> runs;
  for (std::size_t k = 0; k < nodes.size(); ++k) add_row(runs, nodes[k], static_cast<int>(k));
  return runs;
}

}  // namespace

TEST_CASE("runs are as long as nodes and rows go on", "[body][rows]") {
  CHECK(runs_of(patches[2]).size() == 4);
  CHECK(runs_of(patches[3]).size() == 4);
  std::vector<RowRun> runs = runs_of({3, 4});
  add_row(runs, 5, 7);  // a row is left out
  CHECK(runs.size() == 2);
}

TEST_CASE("rows are taken from nodes and put to nodes", "[body][rows]") {
  for (const std::vector<int>& nodes : patches) {
    const std::vector<RowRun> runs = runs_of(nodes);
    const int count = static_cast<int>(nodes.size());
    const Field a = numbered(node_count, 0), b = numbered(node_count, 0.25) * 3;
    Field rows(count, 3), differences(count, 3), back = b;
    take_rows(runs, a, rows);
    take_difference(runs, a, b, differences);
    put_rows(runs, rows, back);
    PlasticField plastic_rows(count, 9);
    const auto plastic = numbered<PlasticField>(node_count, 0);
    take_rows(runs, plastic, plastic_rows);
    Field expected = b;
    for (int row = 0; row < count; ++row) {
      const int node = nodes[static_cast<std::size_t>(row)];
      CHECK(rows.row(row) == a.row(node));
      CHECK(differences.row(row) == a.row(node) - b.row(node));
      CHECK(plastic_rows.row(row) == plastic.row(node));
      expected.row(node) = a.row(node);
    }
    CHECK(back == expected);
  }
}

TEST_CASE("a solution is put to the nodes of its runs, and nowhere else", "[body][rows]") {
  for (const std::vector<int>& nodes : patches) {
    const int count = static_cast<int>(nodes.size());
    const PlateState state{numbered(count, 1000), numbered(count, 2000)};
    const Field reference = numbered(node_count, 5000);
    for (const bool has_reference : {true, false}) {
      Field positions = Field::Zero(node_count, 3), velocities = positions, expected = positions;
      CHECK(put_motion(runs_of(nodes), state, has_reference ? &reference : nullptr, positions,
                       velocities));
      for (int row = 0; row < count; ++row) {
        const int node = nodes[static_cast<std::size_t>(row)];
        expected.row(node) = state.displacement.row(row);
        if (has_reference) expected.row(node) += reference.row(node);
        CHECK(velocities.row(node) == state.velocity.row(row));
      }
      CHECK(positions == expected);
      CHECK((velocities.col(0).array() != 0).count() == count);
    }
  }
}

TEST_CASE("a number of a solution that is not finite is told, on the rim it does not matter",
          "[body][rows]") {
  const std::vector<RowRun> runs = {{10, 1, 3}, {20, 5, 1}};  // rows 0 and 4 are the rim's
  const double bad =
      GENERATE(std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN());
  for (int row = 0; row < 6; ++row) {
    for (const bool is_velocity : {false, true}) {
      PlateState state{numbered(6, 0), numbered(6, 0)};
      (is_velocity ? state.velocity : state.displacement)(row, 2) = bad;
      Field positions = Field::Zero(node_count, 3), velocities = positions;
      const bool is_rim = row == 0 || row == 4;
      CHECK(put_motion(runs, state, nullptr, positions, velocities) == is_rim);
    }
  }
}

TEST_CASE("around a hole and in it are all nodes", "[body][rows]") {
  const Field from = numbered(node_count, 1), old = numbered(node_count, 1000);
  for (std::size_t k = 0; k < 3; ++k) {  // those whose nodes ascend
    const std::vector<RowRun> hole = runs_of(patches[k]);
    Field copied = old, cleared = old, expected = from;
    copy_around(hole, from, copied);
    clear_around(hole, node_count, cleared);
    for (const int node : patches[k]) expected.row(node) = old.row(node);
    CHECK(copied == expected);
    for (const int node : patches[k]) cleared.row(node) -= old.row(node);
    CHECK(cleared.isZero(0));
  }
}
