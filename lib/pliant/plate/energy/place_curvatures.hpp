#pragma once

#include <array>
#include <cstddef>

#include "pliant/plate/energy/plate_energy.hpp"

namespace pliant {

// Curvatures of one place, a node of a grid or a triangle: uu of all components at work, then vv,
// then uv. docs/model.md, "Plasticity". Internal to plate.

/// Those of x, y and z: a row of a `PlasticField`.
using PlaceCurvatures = std::array<double, 9>;

/// C k for the form C of the place.
template <std::size_t Size>
std::array<double, Size> moments_of(const Moduli<double>& form, const std::array<double, Size>& k) {
  constexpr std::size_t components = Size / 3;
  std::array<double, Size> m;
  for (std::size_t n = 0; n < components; ++n) {
    const double uu = k[n], vv = k[components + n];
    m[n] = form.uu * uu + form.coupling * vv;
    m[components + n] = form.coupling * uu + form.vv * vv;
    m[2 * components + n] = form.uv * k[2 * components + n];
  }
  return m;
}

/// a . C b, the sum over the components.
template <std::size_t Size>
double product_of(const Moduli<double>& form, const std::array<double, Size>& a,
                  const std::array<double, Size>& b) {
  const std::array<double, Size> m = moments_of(form, b);
  double sum = 0;
  for (std::size_t n = 0; n < Size; ++n) sum += a[n] * m[n];
  return sum;
}

}  // namespace pliant
