#pragma once

namespace pliant {

// The elementary functions used to compute a state. The last bit of libm's results depends on the
// CPU (glibc picks an implementation at run time), so these use SLEEF's bit-consistent scalar
// functions, which never use fused multiply-add: bit-identical on every machine of an architecture.
// Error at most 1 ulp. sqrt is exact everywhere and needs no wrapper.

double exp_of(double x);        ///< eˣ
double log_of(double x);        ///< natural logarithm; Requires: x > 0
double sin_of(double radians);  ///< Requires: finite
double cos_of(double radians);  ///< Requires: finite
double asin_of(double x);       ///< [rad]; Requires: |x| <= 1

/// Sine and cosine of one angle.
struct SineCosine {
  double sine = 0;
  double cosine = 1;
};

/// Sine and cosine of an angle in degrees, exact at every multiple of 90 (so that a quarter turn
/// maps a lattice to a lattice) and periodic without drift. Requires: finite.
SineCosine sine_cosine_of_degrees(double degrees);

}  // namespace pliant
