
#include <cmath>
#include <random>

#include "pliant/exchange/rotations.hpp"
#include "support/catch.hpp"

namespace pliant::exchange {
namespace {

Matrix3d turn(const Value<3>& degrees, RotateOrder order) {
  return make_transform({0, 0, 0}, {degrees[0], degrees[1], degrees[2]}, {1, 1, 1}, order).linear;
}

TEST_CASE("angles and quaternions turn alike in every order", "[exchange][euler]") {
  std::mt19937 bits(7);
  std::uniform_real_distribution<double> angle(-400, 400);
  const auto order = static_cast<RotateOrder>(GENERATE(range(0, 6)));
  for (int k = 0; k < 500; ++k) {
    Value<3> degrees{angle(bits), angle(bits), angle(bits)};
    if (k % 5 == 0) degrees[static_cast<std::size_t>(axes(order)[1])] = k % 2 == 0 ? 90 : -90;
    CAPTURE(static_cast<int>(order), degrees);
    const Quaternion rotation = quaternion_near(degrees, order, {0, 0, 0, 1});
    // The same angles, if those beside them are near.
    const Value<3> near{degrees[0] + 20, degrees[1] - 10, degrees[2] + 15};
    const Value<3> back = euler_near(rotation, order, near);
    CHECK((turn(back, order) - turn(degrees, order)).cwiseAbs().maxCoeff() < 1e-7);
    if (k % 5 == 0) continue;  // many angles turn alike there
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::fabs(back[c] - near[c]) <= 360);
    const Value<3> same = euler_near(rotation, order, degrees);
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::fabs(same[c] - degrees[c]) < 1e-6);
  }
}

TEST_CASE("angles follow a turn without jumps", "[exchange][euler]") {
  Value<3> beside{0, 0, 0};
  for (int degrees = 0; degrees <= 1080; degrees += 10) {
    const double half = degrees * 3.14159265358979323846 / 360;
    beside = euler_near({0, 0, std::sin(half), std::cos(half)}, RotateOrder::Xyz, beside);
    CHECK(std::fabs(beside[2] - degrees) < 1e-9);
  }
}

TEST_CASE("a slerp has constant speed and takes the shorter way", "[exchange][euler]") {
  const Quaternion from{0, 0, 0, 1};
  const double half = 3.14159265358979323846 / 6;
  const Quaternion to{0, -std::sin(half), 0, -std::cos(half)};  // 60 degrees about y
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const Value<3> angles = euler_near(slerp(from, to, share), RotateOrder::Xyz, {0, 0, 0});
    CHECK(std::fabs(angles[1] - 60 * share) < 1e-12);
  }
}

}  // namespace
}  // namespace pliant::exchange
