#include "pliant/mesh/triangles/weld.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;

namespace {

// By all pairs, again and again until nothing changes.
std::vector<int> welded_slowly(const Field& points, double distance) {
  std::vector<int> first(static_cast<std::size_t>(points.rows()));
  std::iota(first.begin(), first.end(), 0);
  for (bool changes = true; changes;) {
    changes = false;
    for (int a = 0; a < points.rows(); ++a) {
      for (int b = 0; b < points.rows(); ++b) {
        if ((points.row(a) - points.row(b)).norm() > distance || first[a] == first[b]) continue;
        first[a] = first[b] = std::min(first[a], first[b]);
        changes = true;
      }
    }
  }
  return first;
}

}  // namespace

TEST_CASE("points are welded as by looking at all pairs", "[mesh][weld]") {
  std::mt19937 random(7);
  for (const double distance : {0.0, 0.01, 0.05, 0.2, 5.0}) {
    Field points = Field::Random(300, 3);
    points.col(2) *= 0.1;
    for (int k = 0; k < 60; ++k) {
      points.row(static_cast<int>(random() % 300)) = points.row(static_cast<int>(random() % 300));
    }
    CHECK(welded(points, distance).value() == welded_slowly(points, distance));
  }
}

TEST_CASE("a chain of points is one, however long", "[mesh][weld]") {
  Field points = Field::Zero(2000, 3);
  for (int k = 0; k < 2000; ++k) points(k, 0) = (k * 1237) % 2000;
  CHECK(welded(points, 1.0).value() == std::vector<int>(2000, 0));
  std::vector<int> apart(2000);
  std::iota(apart.begin(), apart.end(), 0);
  CHECK(welded(points, 0.999).value() == apart);
}

TEST_CASE("only equal points are welded at a distance of 0", "[mesh][weld]") {
  Field points(5, 3);
  points << 0, 0, 0, 1e-300, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1 + 1e-15;
  CHECK(welded(points, 0).value() == std::vector{0, 1, 0, 3, 4});
}

TEST_CASE("many points in little room are welded in little time", "[mesh][weld]") {
  // By all pairs these are 4e10 distances.
  Field points = Field::Random(testing::is_sanitized ? 2000 : 200'000, 3);
  const std::vector<int> all = welded(points, 0.3).value();
  CHECK(std::all_of(all.begin(), all.end(), [](int first) { return first == 0; }));
}

TEST_CASE("points of which almost all pairs are almost near are refused", "[mesh][weld]") {
  // A circle and a short piece of its axis, askew, so that boxes do not tell them apart.
  constexpr int count = 3000;
  const Vector3d u = Vector3d(1, -1, 0).normalized(), v = Vector3d(1, 1, -2).normalized();
  const Vector3d axis = Vector3d(1, 1, 1).normalized();
  Field points(2 * count, 3);
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count;
    points.row(k) = (1 + 1e-12) * (std::cos(angle) * u + std::sin(angle) * v).transpose();
    points.row(count + k) = 1e-6 * (static_cast<double>(k) / count - 0.5) * axis.transpose();
  }
  int asked = 0;
  const auto first = welded(points, 1, [&] { return ++asked < 0; });
  REQUIRE_FALSE(first);
  CHECK_THAT(first.error().message, Catch::Matchers::Contains("give the attribute weld"));
  CHECK(asked < 400);
  // Nearer, or farther away, they are welded.
  std::vector<int> all(2 * count, 0);
  CHECK(welded(points, 1 + 1e-11).value() == all);
  std::fill(all.begin() + count, all.end(), count);
  CHECK(welded(points, 0.5).value() == all);
}
