#include "pliant/core/elementary.hpp"

#include <cmath>
#include <numbers>

#include <sleef.h>

namespace pliant {

double exp_of(double x) { return Sleef_cinz_expd1_u10purec(x); }
double log_of(double x) { return Sleef_cinz_logd1_u10purec(x); }
double sin_of(double radians) { return Sleef_cinz_sind1_u10purec(radians); }
double cos_of(double radians) { return Sleef_cinz_cosd1_u10purec(radians); }
double asin_of(double x) { return Sleef_cinz_asind1_u10purec(x); }

SineCosine sine_cosine_of_degrees(double degrees) {
  // fmod and remainder are exact, so the quarter and the rest of the angle have no rounding error;
  // the rest is in [-45, 45], and only its conversion to radians rounds.
  const double angle = std::fmod(degrees, 360.0);
  const double rest = std::remainder(angle, 90.0);
  const int quarter = static_cast<int>(std::lround((angle - rest) / 90.0)) & 3;
  const double radians = rest * (std::numbers::pi / 180.0);
  const SineCosine base{sin_of(radians), cos_of(radians)};
  switch (quarter) {
    case 0:
      return base;
    case 1:
      return {base.cosine, -base.sine};
    case 2:
      return {-base.sine, -base.cosine};
    default:
      return {-base.cosine, base.sine};
  }
}

}  // namespace pliant
