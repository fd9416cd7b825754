#include "pliant/plate/time_steps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"

namespace pliant {

namespace {

// 1e-9: a quotient that is an integer except for rounding must not add a step.
double step_count(double interval, double dt) { return std::ceil(interval / dt - 1e-9); }

}  // namespace

Result<void> check_time_step(double interval, double dt) {
  PLIANT_EXPECTS(interval > 0);
  if (!(dt > 0) || !std::isfinite(dt)) {
    return fail(ErrorCode::InvalidInput, fmt::format("is {}, but must be greater than 0", dt));
  }
  if (const double count = step_count(interval, dt); count > max_steps) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("is {}, which makes {} steps in a frame of {} s; at most {} are allowed", dt,
                    count, interval, max_steps));
  }
  return {};
}

TimeSteps divide_interval(double interval, double dt, Stepping stepping) {
  PLIANT_EXPECTS(check_time_step(interval, dt).has_value());
  if (stepping == Stepping::Exact) {
    const int count = std::max(1, static_cast<int>(step_count(interval, dt)));
    return {count, interval / count};
  }
  int count = 0;
  double t = 0;
  do {
    t += dt;
    ++count;
  } while (t < interval);
  return {count, dt};
}

}  // namespace pliant
