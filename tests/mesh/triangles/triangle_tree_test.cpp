#include "pliant/mesh/triangles/triangle_tree.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;

namespace {

struct Soup {
  Field points;
  std::vector<std::array<int, 3>> triangles;

  Vector3d at(int triangle, const std::array<double, 3>& weights) const {
    Vector3d point = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      point += weights[k] * points.row(triangles[triangle][k]).transpose();
    return point;
  }
};

// Triangles at random, some of them segments, points and needles.
Soup soup_of(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  Soup soup;
  soup.points.resize(3 * count, 3);
  for (double& number : soup.points.reshaped()) number = anywhere(random);
  for (int k = 0; k < count; ++k) {
    soup.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    auto rows = soup.points.middleRows(3 * k, 3);
    for (int row = 1; row < 3; ++row) rows.row(row) = rows.row(0) + 0.2 * rows.row(row);
    if (k % 7 == 0) rows.row(2) = rows.row(1);
    if (k % 11 == 0) rows.row(1) = rows.row(2) = rows.row(0);
    if (k % 13 == 0) rows.row(2) = 0.5 * rows.row(0) + (0.5 + 1e-12) * rows.row(1);
  }
  return soup;
}

// By a search over a fine set of points of each triangle: never less than the distance.
double sampled_distance(const Soup& soup, int triangle, const Vector3d& p) {
  constexpr int parts = 24;
  double least = 1e300;
  for (int a = 0; a <= parts; ++a) {
    for (int b = 0; a + b <= parts; ++b) {
      const std::array<double, 3> weights = {double(a) / parts, double(b) / parts,
                                             double(parts - a - b) / parts};
      least = std::min(least, (soup.at(triangle, weights) - p).norm());
    }
  }
  return least;
}

}  // namespace

TEST_CASE("no point of any triangle is closer than the closest", "[mesh][triangle_tree]") {
  const Soup soup = soup_of(300, 5);
  const TriangleTree tree(soup.points, soup.triangles);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> anywhere(-1.5, 1.5);
  for (int round = 0; round < testing::rounds(60); ++round) {
    const Vector3d p(anywhere(random), anywhere(random), anywhere(random));
    const ClosestPoint found = tree.closest(p);
    for (const double weight : found.weights) CHECK((weight >= 0 && weight <= 1));
    CHECK(std::abs(found.weights[0] + found.weights[1] + found.weights[2] - 1) < 1e-15);
    const double distance = (soup.at(found.triangle, found.weights) - p).norm();
    double sampled = 1e300;
    for (int k = 0; k < 300; ++k) sampled = std::min(sampled, sampled_distance(soup, k, p));
    CHECK(distance <= sampled * (1 + 1e-12));
    // The samples are 0.4 / 24 apart at most.
    CHECK(sampled - distance < 0.02);
  }
}

TEST_CASE("a corner is found exactly", "[mesh][triangle_tree]") {
  const Soup soup = soup_of(200, 3);
  const TriangleTree tree(soup.points, soup.triangles);
  for (int row = 0; row < 600; ++row) {
    const Vector3d corner = soup.points.row(row).transpose();
    const ClosestPoint found = tree.closest(corner);
    CHECK(soup.at(found.triangle, found.weights) == corner);
  }
}

TEST_CASE("of equally close triangles the first is found", "[mesh][triangle_tree]") {
  // Every triangle twice, in an order that is not that of the tree.
  Soup soup = soup_of(100, 9);
  const std::vector<std::array<int, 3>> once = soup.triangles;
  soup.triangles.insert(soup.triangles.end(), once.rbegin(), once.rend());
  const TriangleTree tree(soup.points, soup.triangles);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> anywhere(-1.5, 1.5);
  for (int round = 0; round < 200; ++round) {
    const Vector3d p(anywhere(random), anywhere(random), anywhere(random));
    CHECK(tree.closest(p).triangle < 100);
  }
  // A point above the middle of a square's diagonal is as close to both of its halves.
  Field square(4, 3);
  square << 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1;
  CHECK(TriangleTree(square, {{0, 1, 2}, {0, 2, 3}}).closest({0.5, 1, 0.5}).triangle == 0);
  CHECK(TriangleTree(square, {{0, 2, 3}, {0, 1, 2}}).closest({0.5, 1, 0.5}).triangle == 0);
}
