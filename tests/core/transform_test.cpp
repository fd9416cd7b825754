#include "pliant/core/transform.hpp"

#include <numbers>

#include <Eigen/Geometry>

#include "support/catch.hpp"

using namespace pliant;

namespace {

Field random_points(int count) {
  std::srand(5);  // Eigen's Random uses rand
  return Field::Random(count, 3);
}

}  // namespace

TEST_CASE("the identity changes no bit", "[core][transform]") {
  const Transform identity = make_transform({0, 0, 0}, {0, 0, 0}, {1, 1, 1}, RotateOrder::Xyz);
  const Field points = random_points(50);
  CHECK(to_world(identity, points) == points);
  CHECK(vectors_to_object(identity, points) == points);
}

TEST_CASE("rotations apply in the order that is named, after the scale", "[core][transform]") {
  const Vector3d degrees(20, -35, 110);
  const Vector3d scale(2, 0.5, -1.5);
  const Vector3d translate(1, 2, 3);
  const auto about = [&](int axis) -> Eigen::Matrix3d {
    const double radians = degrees[axis] * std::numbers::pi / 180;
    return Eigen::AngleAxisd(radians, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
  };
  struct Case {
    RotateOrder order;
    int first, second, third;
  };
  const Case c = GENERATE(Case{RotateOrder::Xyz, 0, 1, 2}, Case{RotateOrder::Xzy, 0, 2, 1},
                          Case{RotateOrder::Yxz, 1, 0, 2}, Case{RotateOrder::Yzx, 1, 2, 0},
                          Case{RotateOrder::Zxy, 2, 0, 1}, Case{RotateOrder::Zyx, 2, 1, 0});
  const Eigen::Matrix3d expected =
      about(c.third) * about(c.second) * about(c.first) * scale.asDiagonal();
  const Transform transform = make_transform(translate, degrees, scale, c.order);
  CHECK((transform.linear - expected).cwiseAbs().maxCoeff() < 1e-15);

  const Field points = random_points(20);
  const Field world = to_world(transform, points);
  const Field expected_world = (points * expected.transpose()).rowwise() + translate.transpose();
  CHECK((world - expected_world).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("a vector comes back from world space", "[core][transform]") {
  const Transform transform =
      make_transform({5, 6, 7}, {10, 200, -40}, {3, 0.1, -2}, RotateOrder::Zxy);
  const Field vectors = random_points(20);
  const Field back = vectors_to_object(transform, vectors_to_world(transform, vectors));
  CHECK((back - vectors).cwiseAbs().maxCoeff() < 1e-13);  // condition 30, a few ulps
}

TEST_CASE("quarter turns keep a lattice exact", "[core][transform]") {
  const Transform turn = make_transform({0, 0, 0}, {90, 0, 180}, {1, 1, 1}, RotateOrder::Xyz);
  Field p(1, 3);
  p << 1, 2, 3;  // about x by 90: (1, -3, 2); about z by 180: (-1, 3, 2)
  Field expected(1, 3);
  expected << -1, 3, 2;
  CHECK(to_world(turn, p) == expected);
}

TEST_CASE("a flattening transform is not invertible", "[core][transform]") {
  CHECK_FALSE(make_transform({0, 0, 0}, {30, 0, 0}, {1, 0, 1}, RotateOrder::Xyz).is_invertible());
  CHECK(make_transform({0, 0, 0}, {30, 0, 0}, {1e-30, 1, 1}, RotateOrder::Xyz).is_invertible());
  // 1 / 1e-320 overflows a double.
  CHECK_FALSE(
      make_transform({0, 0, 0}, {0, 0, 0}, {1, 1e-320, 1}, RotateOrder::Xyz).is_invertible());
}

TEST_CASE("tiny and huge scales are undone, though their volume is no number",
          "[core][transform]") {
  const double size = GENERATE(1e-300, 1e-120, 1e120, 1e300);
  const Transform transform =
      make_transform({0, 0, 0}, {30, -50, 110}, {size, -2 * size, 0.5 * size}, RotateOrder::Xyz);
  REQUIRE(transform.is_invertible());
  const Field vectors = random_points(20);
  const Field back = vectors_to_object(transform, vectors_to_world(transform, vectors));
  CHECK((back - vectors).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("a transform reflects if it has an odd number of negative scales", "[core][transform]") {
  for (const double size : {1e-120, 1.0, 1e120}) {
    for (int signs = 0; signs < 8; ++signs) {
      Vector3d scale;
      for (int axis = 0; axis < 3; ++axis) scale[axis] = (signs >> axis & 1) != 0 ? -size : size;
      const Transform transform = make_transform({}, {10, 20, 30}, scale, RotateOrder::Zyx);
      CAPTURE(size, signs);
      CHECK(transform.is_mirrored() == (scale[0] / size * scale[1] / size * scale[2] / size < 0));
    }
  }
  CHECK_FALSE(make_transform({}, {}, {-1, 0, 1}, RotateOrder::Xyz).is_mirrored());
  CHECK_FALSE(Transform().is_mirrored());
}
