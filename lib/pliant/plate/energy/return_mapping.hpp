#pragma once

#include <array>
#include <cmath>

#include "pliant/plate/energy/plate_energy.hpp"

namespace pliant {

// How the material of a plate flows at one place, a node of a grid or a triangle. docs/model.md,
// "Plasticity". Internal to plate. Source: Simo & Hughes, Computational Inelasticity (1998).

/// Curvatures of one place, a row of a `PlasticField`: uu in x, y, z, then vv, then uv.
using PlaceCurvatures = std::array<double, 9>;

/// C k for the form C of the place.
inline PlaceCurvatures moments_of(const Moduli<double>& form, const PlaceCurvatures& k) {
  PlaceCurvatures m;
  for (int n = 0; n < 3; ++n) {
    m[n] = form.uu * k[n] + form.coupling * k[3 + n];
    m[3 + n] = form.coupling * k[n] + form.vv * k[3 + n];
    m[6 + n] = form.uv * k[6 + n];
  }
  return m;
}

/// a . C b, the sum over x, y and z.
inline double product_of(const Moduli<double>& form, const PlaceCurvatures& a,
                         const PlaceCurvatures& b) {
  const PlaceCurvatures m = moments_of(form, b);
  double sum = 0;
  for (int n = 0; n < 3; ++n) sum += a[n] * m[n] + a[3 + n] * m[3 + n] + a[6 + n] * m[6 + n];
  return sum;
}

/// A place that flows, eq. (8j): its plastic curvatures grow by `whole` xi. As its curvatures
/// change by dk, they change by whole dk + along xi (xi . C dk).
struct Flow {
  double whole = 0, along = 0;
  PlaceCurvatures xi = {};

  /// `squared` is xi . C xi. Requires: it is more than the yield stress squared.
  Flow(const PlasticLaw& law, const PlaceCurvatures& xi_of_place, double squared)
      : xi(xi_of_place) {
    const double q = std::sqrt(squared);
    const double share = 1 / (1 + law.hardening);
    whole = share * (1 - law.yield / q);
    along = share * law.yield / (q * squared);
  }

  PlaceCurvatures change(const Moduli<double>& form, PlaceCurvatures dk) const {
    const double part = along * product_of(form, xi, dk);
    for (int k = 0; k < 9; ++k) dk[k] = whole * dk[k] + part * xi[k];
    return dk;
  }
};

}  // namespace pliant
