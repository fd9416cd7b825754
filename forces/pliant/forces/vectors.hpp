#pragma once

#include <algorithm>
#include <cmath>

#include "pliant/core/field.hpp"

namespace pliant {

// Small vector algebra with the sums written out, so that their order is fixed here and not by a
// library. Internal to forces.

inline double dot(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

inline Vector3d cross(const Vector3d& a, const Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

inline double length(const Vector3d& a) { return std::sqrt(dot(a, a)); }

inline double largest_component(const Vector3d& a) {
  return std::max({std::abs(a.x()), std::abs(a.y()), std::abs(a.z())});
}

/// The unit vector along `a`; 0 for the vector of length 0.
inline Vector3d normalised(const Vector3d& a) {
  // Scaled by the largest component first: the square of a tiny or huge length would underflow or
  // overflow.
  const double largest = largest_component(a);
  if (largest == 0) return Vector3d::Zero();
  const Vector3d scaled = a / largest;
  return scaled / length(scaled);
}

}  // namespace pliant
