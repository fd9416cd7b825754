#pragma once

#include "pliant/core/result.hpp"

namespace pliant {

/// How many steps fill an interval. SPEC 4.
enum class Stepping {
  Exact,      ///< equal steps, at most dt long, that fill the interval, as thesis 4.3 requires
  Overshoot,  ///< steps of dt until the end is reached or passed: the loop of thesis 5.3 (L10)
};

/// How a step goes on in time. docs/model.md, "Time".
enum class Integrator {
  BackwardEuler,  ///< first order; takes energy away
  Newmark,        ///< the trapezoidal rule: second order; keeps the energy of an undamped plate;
                  ///< only of plates with density
  Exact,          ///< the solution of the equation at the end, of load and tangents that change
                  ///< evenly; only of plates with density or damping
};

/// Equal steps in time.
struct TimeSteps {
  int count = 1;      ///< >= 1; Exact: the parts that each of its own steps is divided into
  double length = 1;  ///< [s], > 0; Exact: of the whole interval
  Integrator integrator = Integrator::BackwardEuler;

  bool are_exact() const { return integrator == Integrator::Exact; }
  bool are_reflected() const { return integrator == Integrator::Newmark; }

  /// The length of the backward Euler steps that are solved: a step of Newmark's is one of half its
  /// length, reflected. [s]
  double solved_length() const { return are_reflected() ? length / 2 : length; }
};

/// The most steps in an interval.
inline constexpr int max_steps = 100'000;

/// Whether steps of dt [s] can fill an interval [s]. Requires: interval > 0.
/// Errors: dt not > 0 or not finite; more than `max_steps` steps.
Result<void> check_time_step(double interval, double dt);

/// Divides an interval [s] into steps of dt [s]. Exact: max(1, ceil(interval/dt - 1e-9)) equal
/// steps. Overshoot: t += dt in double precision until t >= interval. Requires: `check_time_step`
/// succeeds.
TimeSteps divide_interval(double interval, double dt, Stepping stepping);

}  // namespace pliant
