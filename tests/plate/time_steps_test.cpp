#include "pliant/plate/time_steps.hpp"

#include <limits>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;
using pliant::testing::WithinRel;

TEST_CASE("exact steps fill the interval", "[plate][time_steps]") {
  const double interval = 1.0 / GENERATE(24, 25, 30, 60, 12.5);
  const double dt = GENERATE(take(20, random(1e-4, 0.2)));
  const TimeSteps steps = divide_interval(interval, dt, Stepping::Exact);
  CHECK_THAT(steps.count * steps.length, WithinRel(interval, 1e-15));
  CHECK(steps.length <= dt * (1 + 1e-9));
  CHECK((steps.count == 1 || interval / (steps.count - 1) > dt));
}

TEST_CASE("a whole quotient asks for no step more, rounding or not", "[plate][time_steps]") {
  for (int count = 1; count <= 1000; ++count) {
    const double interval = 1.0 / 24;
    CHECK(divide_interval(interval, interval / count, Stepping::Exact).count == count);
  }
}

TEST_CASE("overshoot steps run the loop of the thesis", "[plate][time_steps]") {
  const auto count = [](double dt) {
    return divide_interval(1.0 / 24, dt, Stepping::Overshoot).count;
  };
  CHECK(count(0.01) == 5);  // 0.04 is less than 1/24, 0.05 is more
  CHECK(count(1) == 1);
  CHECK(count(1.0 / 240) == 10);  // ten times 1/240 is 1/24 in double precision, too
  // Eleven times 1/264 is an ulp less than 1/24: the loop runs once more, as the thesis's did.
  double sum = 0;
  for (int k = 0; k < 11; ++k) sum += 1.0 / 264;
  CHECK(sum < 1.0 / 24);
  CHECK(count(1.0 / 264) == 12);
  CHECK(divide_interval(1.0 / 24, 0.01, Stepping::Overshoot).length == 0.01);
}

TEST_CASE("time steps that cannot be are refused", "[plate][time_steps]") {
  CHECK(check_time_step(1.0 / 24, 0.01));
  CHECK(check_time_step(1, 1e-5));
  CHECK_THAT(check_time_step(1, 0.99e-5).error().message,
             Contains("101011 steps") && Contains("at most 100000"));
  for (const double dt : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity()}) {
    CHECK_THAT(check_time_step(1, dt).error().message, Contains("must be greater than 0"));
  }
  CHECK_FALSE(check_time_step(1, 5e-324));
}
