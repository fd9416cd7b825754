#include "pliant/core/elementary.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "support/catch.hpp"

using namespace pliant;

namespace {

// Error relative to the exact value, in ulps.
double ulps(double value, long double exact) {
  const auto nearest = static_cast<double>(exact);
  const double ulp = std::nextafter(std::abs(nearest), std::numeric_limits<double>::infinity()) -
                     std::abs(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact)) / ulp;
}

}  // namespace

TEST_CASE("elementary functions lie within an ulp of long double", "[core][elementary]") {
  const double x = GENERATE(take(200, random(-30.0, 30.0)));
  CAPTURE(x);
  // SLEEF guarantees 1.0 ulp for its u10 functions; half an ulp more for the rounding of our
  // measurement.
  CHECK(ulps(exp_of(x), std::exp(static_cast<long double>(x))) <= 1.5);
  CHECK(ulps(sin_of(x), std::sin(static_cast<long double>(x))) <= 1.5);
  CHECK(ulps(cos_of(x), std::cos(static_cast<long double>(x))) <= 1.5);
  CHECK(ulps(log_of(std::abs(x)), std::log(static_cast<long double>(std::abs(x)))) <= 1.5);
  CHECK(ulps(asin_of(x / 30), std::asin(static_cast<long double>(x / 30))) <= 1.5);
}

TEST_CASE("sine and cosine of whole quarter turns are exact", "[core][elementary]") {
  const int quarters = GENERATE(range(-9, 10));
  const double sines[] = {0, 1, 0, -1};
  const auto [sine, cosine] = sine_cosine_of_degrees(90.0 * quarters);
  CAPTURE(quarters);
  CHECK(sine == sines[quarters & 3]);
  CHECK(cosine == sines[(quarters + 1) & 3]);
}

TEST_CASE("sine and cosine of degrees agree with radians and repeat exactly",
          "[core][elementary]") {
  const double degrees = GENERATE(take(200, random(-720.0, 720.0)));
  const auto [sine, cosine] = sine_cosine_of_degrees(degrees);
  const long double radians =
      static_cast<long double>(degrees) * std::numbers::pi_v<long double> / 180;
  CAPTURE(degrees);
  CHECK(std::abs(sine - std::sin(radians)) <= 4e-16L);
  CHECK(std::abs(cosine - std::cos(radians)) <= 4e-16L);
  // A whole number of turns of an exact angle changes no bit.
  const double eighths = std::round(degrees * 8) / 8;
  CHECK(sine_cosine_of_degrees(eighths).sine ==
        sine_cosine_of_degrees(eighths + 360.0 * 1024).sine);
}
