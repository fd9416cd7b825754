#include "pliant/timeline/edit/bernstein.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::Bernstein;

/// The value by de Casteljau's algorithm.
double value_of(Bernstein polynomial, double u) {
  for (std::size_t count = polynomial.size(); count > 1; --count) {
    for (std::size_t i = 0; i + 1 < count; ++i) {
      polynomial[i] += u * (polynomial[i + 1] - polynomial[i]);
    }
  }
  return polynomial.front();
}

Bernstein some_polynomial(Whim& whim, int degree) {
  Bernstein polynomial;
  for (int i = 0; i <= degree; ++i) polynomial.push_back(whim.between(-2, 2));
  return polynomial;
}

TEST_CASE("polynomials are multiplied, composed and subtracted", "[timeline][bernstein]") {
  Whim whim(1);
  for (int round = 0; round < 300; ++round) {
    const Bernstein a = some_polynomial(whim, 3);
    const Bernstein b = some_polynomial(whim, 1 + whim.upto(2));
    const double u = whim.between(0, 1);
    const double at_b = value_of(b, u);
    CAPTURE(round, u);
    REQUIRE_THAT(value_of(timeline::product(a, b), u), WithinAbs(value_of(a, u) * at_b, 1e-14));
    REQUIRE_THAT(value_of(timeline::composed(a, b), u), WithinAbs(value_of(a, at_b), 1e-11));
    REQUIRE_THAT(value_of(timeline::difference(a, b), u), WithinAbs(value_of(a, u) - at_b, 1e-14));
  }
}

TEST_CASE("the size of a polynomial is bounded tightly", "[timeline][bernstein]") {
  Whim whim(2);
  for (int round = 0; round < 300; ++round) {
    const Bernstein polynomial = some_polynomial(whim, whim.upto(9));
    double sampled = 0;
    for (int i = 0; i <= 2000; ++i) {
      sampled = std::max(sampled, std::fabs(value_of(polynomial, i / 2000.0)));
    }
    const double bound = timeline::size_bound(polynomial, 100);
    CAPTURE(round, sampled, bound);
    REQUIRE(bound >= sampled - 1e-14);
    REQUIRE(bound <= sampled + 0.11);  // a thousandth of the limit
    const double tight = timeline::size_bound(polynomial, 1.01 * bound);
    REQUIRE(tight >= sampled - 1e-14);
    REQUIRE(tight <= 1.003 * sampled + 1e-4);
    REQUIRE(timeline::size_bound(polynomial, sampled / 2) >= sampled / 2);
  }
  CHECK(timeline::size_bound({0, 0, 0}, 1) == 0);
}

}  // namespace
}  // namespace pliant::testing
