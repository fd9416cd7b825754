#include "pliant/plate/plate.hpp"

#include <cmath>

#include "pliant/plate/plate_problem.hpp"

namespace pliant {

double Stiffness::least_c() const {
  // The root of the product is right at equality (b = d = 2 gives 2, the two roots a little more);
  // the two roots are used if the product overflows or underflows.
  const double root = std::isnormal(b * d) ? std::sqrt(b * d) : std::sqrt(b) * std::sqrt(d);
  return -2 * root;
}

bool Stiffness::is_elliptic() const { return b > 0 && d > 0 && c > least_c(); }

bool operator==(const PlateSystem& one, const PlateSystem& other) {
  if (!(one.outline == other.outline) || !(one.stiffness == other.stiffness) ||
      one.shift != other.shift || one.goal != other.goal || one.is_even() != other.is_even()) {
    return false;
  }
  if (one.is_even()) return true;
  if (one.poisson != other.poisson || one.drag != other.drag) return false;
  return one.factors == other.factors ||
         (one.factors && other.factors && *one.factors == *other.factors);
}

}  // namespace pliant
