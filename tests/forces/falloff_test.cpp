#include "pliant/forces/falloff.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace pliant;
using pliant::testing::WithinAbs;

TEST_CASE("every falloff starts at 1 and never rises", "[forces][falloff]") {
  const Falloff kind =
      GENERATE(Falloff::Constant, Falloff::Linear, Falloff::Smooth, Falloff::Gaussian);
  CHECK(falloff(kind, 0) == 1);
  double before = 1;
  for (int k = 1; k <= 400; ++k) {
    const double now = falloff(kind, k / 200.0);
    CHECK(now <= before);
    CHECK(now >= 0);
    before = now;
  }
}

TEST_CASE("falloffs follow their formulas", "[forces][falloff]") {
  const double s = GENERATE(take(100, random(0.0, 2.0)));
  CAPTURE(s);
  const double x = s < 1 ? 1 - s : 0;
  CHECK(falloff(Falloff::Constant, s) == 1);
  CHECK(falloff(Falloff::Linear, s) == x);
  CHECK_THAT(falloff(Falloff::Smooth, s), WithinAbs(3 * x * x - 2 * x * x * x, 1e-15));
  CHECK_THAT(falloff(Falloff::Gaussian, s), WithinAbs(std::exp(-4.5 * s * s), 1e-15));
}

TEST_CASE("the smooth falloff joins both ends with slope 0", "[forces][falloff]") {
  const double h = 1e-6;
  CHECK_THAT((falloff(Falloff::Smooth, h) - 1) / h, WithinAbs(0, 10 * h));  // -3 h + O(h^2)
  CHECK_THAT(falloff(Falloff::Smooth, 1 - h) / h, WithinAbs(0, 10 * h));
}
