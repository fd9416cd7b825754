#pragma once

#include <algorithm>
#include <cmath>

#include "pliant/core/field.hpp"

namespace pliant {

// Small vector algebra with the sums written out, so that their order is fixed here and not by a
// library. Internal to forces.

/// Three components. GCC vectorises Eigen's vectors by their components, and then no longer the
/// loops over positions that they are in.
struct Triple {
  double x = 0, y = 0, z = 0;

  constexpr Triple() = default;
  constexpr Triple(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  Triple(const Vector3d& a) : x(a.x()), y(a.y()), z(a.z()) {}
  operator Vector3d() const { return {x, y, z}; }
};

/// f of each component.
template <class F, class... Triples>
Triple by_component(const F& f, const Triples&... of) {
  return {f(of.x...), f(of.y...), f(of.z...)};
}

inline Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Triple operator-(const Triple& a, const Triple& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Triple operator*(double s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Triple operator/(const Triple& a, double s) { return {a.x / s, a.y / s, a.z / s}; }

inline double dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double length(const Triple& a) { return std::sqrt(dot(a, a)); }

inline double largest_component(const Triple& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

/// The unit vector along `a`; 0 for the vector of length 0.
inline Triple normalised(const Triple& a) {
  // Scaled by the largest component first: the square of a tiny or huge length would underflow or
  // overflow.
  const double largest = largest_component(a);
  const Triple scaled = a / largest;
  const Triple unit = scaled / length(scaled);
  return by_component([&](double x) { return largest == 0 ? 0 : x; }, unit);
}

}  // namespace pliant
