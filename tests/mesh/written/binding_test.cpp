#include "pliant/mesh/written/binding.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Field scattered(int count, double height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> within(-0.7, 0.7);
  Field points(count, 3);
  for (int k = 0; k < count; ++k)
    points.row(k) << within(random), height * within(random), within(random);
  return points;
}

// A value for each row.
template <class Function>
Field values_at(const Field& points, const Function& f) {
  Field values(points.rows(), 3);
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    values.row(k) = f(Vector3d(points.row(k).transpose())).transpose();
  return values;
}

double largest(const Field& difference) { return difference.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("points follow what is affine exactly", "[mesh][binding]") {
  for (const bool has_quads : {false, true}) {
    const TriangleSurface driver = make_surface(square(9, 2, 0.3, has_quads)).value();
    const Field points = scattered(300, 0, 4);
    const Binding binding = Binding::make(driver, {}, points).value();
    const auto moved = [](const Vector3d& p) {
      return Vector3d(1 + p.x() - 2 * p.z(), 3 * p.x() + 0.5, p.z() - 7);
    };
    const Field displacements = binding.displacements(values_at(driver.rest, moved));
    CHECK(largest(displacements - values_at(points, moved)) < 1e-13);
  }
}

TEST_CASE("points above the driver follow its plane, and keep their height", "[mesh][binding]") {
  // Without a gradient off the plane, D is w at the closest point.
  const TriangleSurface driver = make_surface(square(9, 2, 0.3)).value();
  const Field points = scattered(300, 1, 4);
  const auto moved = [](const Vector3d& p) { return Vector3d(p.z(), p.x() + 2 * p.z(), 1); };
  const Field displacements =
      Binding::make(driver, {}, points).value().displacements(values_at(driver.rest, moved));
  CHECK(largest(displacements - values_at(points, moved)) < 1e-13);
}

TEST_CASE("on even triangles points follow bends of second degree", "[mesh][binding]") {
  // The triangles around a node within are the same after half a turn, so that its gradient is
  // exact.
  const auto even = [](int count) {
    std::vector<Vector3d> positions;
    std::vector<std::vector<int>> faces;
    for (int j = 0; j <= count; ++j) {
      for (int i = 0; i <= count; ++i) {
        positions.emplace_back(2.0 * i / count - 1, 0, 2.0 * j / count - 1);
        const int a = j * (count + 1) + i, b = a + 1, c = a + count + 1, d = c + 1;
        if (i < count && j < count) faces.insert(faces.end(), {{a, c, d}, {a, d, b}});
      }
    }
    return make_surface(mesh_of(positions, faces)).value();
  };
  const TriangleSurface driver = even(12);
  const Field points = scattered(400, 0, 6);
  const auto error = [&](const TriangleSurface& of, const auto& moved) {
    return largest(Binding::make(of, {}, points).value().displacements(values_at(of.rest, moved)) -
                   values_at(points, moved));
  };
  const auto bent = [](const Vector3d& p) {
    return Vector3d(0, p.x() * p.x() - 3 * p.x() * p.z() + 2 * p.z() * p.z(), p.x() * p.z());
  };
  CHECK(error(driver, bent) < 1e-14);
  const auto wave = [](const Vector3d& p) { return Vector3d(0, std::sin(2 * p.x() + p.z()), 0); };
  const double coarse = error(driver, wave), fine = error(even(24), wave);
  CAPTURE(coarse, fine);
  CHECK(std::log2(coarse / fine) > 2.7);  // third order
}

TEST_CASE("a point on a node moves as the node, others by the formula", "[mesh][binding]") {
  const TriangleSurface driver = make_surface(sphere(2)).value();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  const Field w = values_at(driver.rest, [&](const Vector3d&) {
    return Vector3d(any(random), any(random), any(random));
  });
  CHECK(largest(Binding::make(driver, {}, driver.rest).value().displacements(w) - w) < 1e-15);

  // By the formula of SPEC 8, "Proxies", triangle by triangle.
  const int count = driver.node_count();
  std::vector<Matrix3d> sums(static_cast<std::size_t>(count), Matrix3d::Zero());
  std::vector<double> areas(static_cast<std::size_t>(count), 0);
  for (int face = 0; face < driver.face_count(); ++face) {
    const auto nodes = driver.nodes_of(face);
    REQUIRE(nodes.size() == 3);
    const auto x = [&](int k) { return Vector3d(driver.rest.row(nodes[k]).transpose()); };
    // Gradients of the barycentric coordinates by least squares in the plane.
    Eigen::Matrix<double, 3, 2> sides;
    sides << x(1) - x(0), x(2) - x(0);
    const Eigen::Matrix<double, 2, 3> inverse =
        (sides.transpose() * sides).inverse() * sides.transpose();
    Eigen::Matrix<double, 3, 2> change;
    change << (w.row(nodes[1]) - w.row(nodes[0])).transpose(),
        (w.row(nodes[2]) - w.row(nodes[0])).transpose();
    const double area = (x(1) - x(0)).cross(x(2) - x(0)).norm() / 2;
    for (const int node : nodes) {
      sums[node] += area * change * inverse;
      areas[node] += area;
    }
  }
  const int face = 17;
  const auto nodes = driver.nodes_of(face);
  const std::array<double, 3> weights = {0.2, 0.5, 0.3};
  Vector3d q = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) q += weights[k] * driver.rest.row(nodes[k]).transpose();
  Vector3d expected = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vector3d way = q - driver.rest.row(nodes[k]).transpose();
    expected +=
        weights[k] * (w.row(nodes[k]).transpose() + 0.5 * sums[nodes[k]] / areas[nodes[k]] * way);
  }
  Field points(1, 3);
  const auto x = [&](int k) { return Vector3d(driver.rest.row(nodes[k]).transpose()); };
  const Vector3d normal = (x(1) - x(0)).cross(x(2) - x(0)).normalized();
  points.row(0) = (q + 0.01 * normal).transpose();
  const Field displacement = Binding::make(driver, {}, points).value().displacements(w);
  CHECK(largest(displacement - expected.transpose()) < 1e-13);
}

TEST_CASE("nothing moves where the driver is still", "[mesh][binding]") {
  const TriangleSurface driver = make_surface(square(9, 2, 0.3)).value();
  const Field points = scattered(300, 1, 4);
  Field w = Field::Zero(driver.node_count(), 3);
  const Binding binding = Binding::make(driver, {}, points).value();
  CHECK(binding.displacements(w) == Field::Zero(300, 3));
  w(50, 1) = 1;  // a node: only what is near follows
  const Field displacements = binding.displacements(w);
  const Vector3d centre = driver.rest.row(50).transpose();
  for (int k = 0; k < 300; ++k) {
    const Vector3d way = points.row(k).transpose() - centre;
    if (std::hypot(way.x(), way.z()) > 1) CHECK(displacements.row(k) == Eigen::RowVector3d::Zero());
  }
}

TEST_CASE("points as far from thousands of triangles as from one are refused", "[mesh][binding]") {
  // A band of triangles around an axis, and points on it.
  constexpr int count = 8192;
  std::vector<Vector3d> places;
  std::vector<std::vector<int>> faces;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count;
    for (const double z : {-0.1, 0.1}) places.emplace_back(std::cos(angle), std::sin(angle), z);
    const int next = (k + 1) % count;
    faces.push_back({2 * k, 2 * next, 2 * k + 1});
    faces.push_back({2 * next, 2 * next + 1, 2 * k + 1});
  }
  const TriangleSurface band = make_surface(mesh_of(places, faces)).value();
  constexpr int point_count = 400;
  if (is_sanitized) return;  // millions of trials
  Field points = Field::Zero(point_count, 3);
  std::size_t asked = 0;
  const auto count_asks = [&] { return ++asked == 0; };
  const auto refused = Binding::make(band, {}, points, count_asks);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, contains_text("as far from thousands of triangles"));
  // All of it would ask more than twice as often.
  CHECK(asked < std::size_t{point_count} * 2 * count * 20 / StopPoll::parts_between / 2);
  points.col(0).setConstant(0.9);  // the same beside the axis
  CHECK(Binding::make(band, {}, points).has_value());
}

TEST_CASE("a binding is found where both meshes are placed", "[mesh][binding]") {
  const TriangleSurface driver = make_surface(square(9, 2, 0.3)).value();
  const Transform placed =
      make_transform({3, -2, 5}, {20, 60, -10}, {1.5, 0.5, -2}, RotateOrder::Xyz);
  const Field points = scattered(200, 0, 4);
  const auto moved = [](const Vector3d& p) { return Vector3d(p.x(), p.z(), p.x() - p.z()); };
  const Field displacements = Binding::make(driver, placed, to_world(placed, points))
                                  .value()
                                  .displacements(values_at(driver.rest, moved));
  CHECK(largest(displacements - values_at(points, moved)) < 1e-12);
}
