#include "pliant/plate/plate.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a stiffness is elliptic just above c = -2 sqrt(bd)", "[plate]") {
  const double b = GENERATE(1.0, 3e-200, 4e200), d = GENERATE(1.0, 5e-200, 2e200);
  const double limit = Stiffness{b, 0, d}.least_c();
  CHECK_THAT(limit, pliant::testing::WithinRel(-2 * std::sqrt(b) * std::sqrt(d), 1e-15));
  CHECK(Stiffness{b, limit * (1 - 1e-15), d}.is_elliptic());
  CHECK_FALSE(Stiffness{b, limit, d}.is_elliptic());
  CHECK_FALSE(Stiffness{b, limit * (1 + 1e-15), d}.is_elliptic());
  CHECK_FALSE(Stiffness{0, 1, d}.is_elliptic());
  CHECK_FALSE(Stiffness{b, 1, -d}.is_elliptic());
  CHECK_FALSE(Stiffness{b, std::nan(""), d}.is_elliptic());
}

TEST_CASE("a stiffness at the very bound is not elliptic", "[plate]") {
  // Two roots of 2 multiply to a little more than 2, so c = -4 would be accepted.
  const double b = GENERATE(2.0, 3.0, 5.0, 7.0, 0.1);
  CHECK_FALSE(Stiffness{b, -2 * b, b}.is_elliptic());
  CHECK(Stiffness{b, std::nextafter(-2 * b, 0), b}.is_elliptic());
}
