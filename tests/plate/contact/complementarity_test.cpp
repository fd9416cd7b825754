#include "pliant/plate/contact/complementarity.hpp"

#include <algorithm>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A plate of few unknowns: the inverse of its matrix is at hand.
struct Springs {
  Eigen::MatrixXd inverse;

  explicit Springs(int count) {
    const Eigen::MatrixXd part = Eigen::MatrixXd::Random(count, count);
    inverse = part * part.transpose() + 0.1 * Eigen::MatrixXd::Identity(count, count);
  }

  SolvedMatrix plate() const {
    return {
        inverse.rows(),
        [this](const Field& forces) -> Result<Field> { return Field(inverse * forces); },
        [this]() -> Result<SparseMatrix> { return SparseMatrix(inverse.inverse().sparseView()); }};
  }
};

std::vector<ContactRow> random_rows(int unknowns) {
  std::vector<ContactRow> rows;
  for (int k = 0; k < unknowns; ++k) {
    // Two rows at some unknowns, across each other.
    const int count = Vector3d::Random().x() > 0.5 ? 2 : 1;
    const Vector3d n = Vector3d::Random().normalized(), place = Vector3d::Random();
    for (int c = 0; c < count; ++c) {
      ContactRow& row = rows.emplace_back();
      row.unknown = k;
      row.normal = c == 0 ? n : n.unitOrthogonal();
      row.lift = Vector3d::Random().x();
      row.place = place;
    }
  }
  return rows;
}

}  // namespace

TEST_CASE("forces of contact push, and only where a row just holds", "[plate][contact]") {
  // The last one has more rows than are solved by a factor.
  for (int trial = 0; trial < 60; ++trial) {
    const int count = trial < 59 ? 1 + trial : 900;
    const Springs springs(count);
    const std::vector<ContactRow> rows = random_rows(count);
    InverseColumns columns({});
    Complementarity problem(columns, {});
    const auto forces = problem.solve(rows, {}, 1e-12, springs.plate());
    CAPTURE(count);
    REQUIRE(forces);
    Field all = Field::Zero(count, 3);
    for (std::size_t k = 0; k < rows.size(); ++k)
      all.row(rows[k].unknown) += (*forces)[k].transpose();
    const Field moved = springs.inverse * all;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double gap = rows[k].normal.dot(moved.row(rows[k].unknown)) - rows[k].lift;
      const double force = rows[k].normal.dot((*forces)[k]);
      CHECK(force >= -1e-12);
      CHECK(gap > -1e-9);
      CHECK(force * gap < 1e-8);
    }
  }
}

TEST_CASE("forces of contact do not depend on which columns are kept", "[plate][contact]") {
  const Springs springs(40);
  const std::vector<ContactRow> rows = random_rows(40);
  InverseColumns columns({}), kept({});
  std::vector<int> all(40);
  for (int k = 0; k < 40; ++k) all[static_cast<std::size_t>(k)] = k;
  REQUIRE(kept.take(all, 40, springs.plate().solve));
  Complementarity first({columns, {}}), second({kept, {}});
  const auto one = first.solve(rows, {}, 1e-12, springs.plate());
  const auto other = second.solve(rows, {}, 1e-12, springs.plate());
  REQUIRE(one);
  REQUIRE(other);
  CHECK(*one == *other);
}

TEST_CASE("forces of contact have the same bits for every width of vectors", "[plate][contact]") {
  const Springs springs(50);
  std::vector<ContactRow> rows = random_rows(50);
  for (ContactRow& row : rows) row.lift = std::abs(row.lift);
  std::vector<std::vector<Vector3d>> found;
  for (const int lanes : {1, 4, widest_lanes}) {
    RunContext context;
    context.most_lanes = lanes;
    InverseColumns columns(context);
    Complementarity problem(columns, context);
    const auto forces = problem.solve(rows, {}, 1e-12, springs.plate());
    REQUIRE(forces);
    found.push_back(*forces);
  }
  CHECK(found[0] == found[1]);
  CHECK(found[0] == found[2]);
}

TEST_CASE("friction resists the slip up to its bound, and what sticks does not move",
          "[plate][contact]") {
  for (int trial = 0; trial < 60; ++trial) {
    const int count = 1 + trial;
    const Springs springs(count);
    std::vector<ContactRow> rows;
    std::vector<double> bounds;
    for (int k = 0; k < count; ++k) {
      ContactRow& row = rows.emplace_back();
      row.unknown = k;
      row.normal = Vector3d::Random().normalized();
      row.lift = Vector3d::Random().x();
      row.slip = Vector3d::Random();
      row.sticks = k % 7 == 3;
      bounds.push_back(row.sticks ? 0 : std::max(0.0, 0.1 * Vector3d::Random().x()));
    }
    InverseColumns columns({});
    Complementarity problem(columns, {});
    const auto forces = problem.solve(rows, bounds, 1e-12, springs.plate());
    CAPTURE(count);
    REQUIRE(forces);
    Field all(count, 3);
    for (int k = 0; k < count; ++k) all.row(k) = (*forces)[static_cast<std::size_t>(k)].transpose();
    const Field moved = springs.inverse * all;
    for (int k = 0; k < count; ++k) {
      const auto row = static_cast<std::size_t>(k);
      const Vector3d& n = rows[row].normal;
      const Vector3d way = moved.row(k).transpose(), force = (*forces)[row];
      const Vector3d slip = rows[row].slip + way - n.dot(rows[row].slip + way) * n;
      const Vector3d across = force - n.dot(force) * n;
      const double gap = n.dot(way) - rows[row].lift;
      CAPTURE(k, bounds[row], slip.norm(), across.norm());
      if (rows[row].sticks) {
        CHECK(std::abs(gap) < 1e-9);
        CHECK(slip.norm() < 1e-9);
        continue;
      }
      CHECK(n.dot(force) > -1e-9);
      CHECK(gap > -1e-9);
      CHECK(across.norm() < bounds[row] + 1e-9);
      if (slip.norm() > 1e-7)
        CHECK((across + bounds[row] * slip.normalized()).norm() < 1e-6 * (1 + bounds[row]));
    }
  }
}
