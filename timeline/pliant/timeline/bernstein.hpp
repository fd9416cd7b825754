#pragma once

#include <vector>

namespace pliant::timeline {

/// A polynomial over [0, 1] by its Bernstein coefficients, degree + 1 of them. It never leaves the
/// interval that they span. Source: Farin, Curves and Surfaces for CAGD, chapters 5 and 6.
using Bernstein = std::vector<double>;

Bernstein product(const Bernstein& a, const Bernstein& b);

/// The cubic with coefficients b0..b3 at the places that `inner` runs through: degree 3·degree.
Bernstein composed(const Bernstein& cubic, const Bernstein& inner);

/// outer - other, of which the second may have the lower degree.
Bernstein difference(const Bernstein& outer, const Bernstein& other);

/// An upper bound of the size of a polynomial over [0, 1], at most a thousandth of itself or of
/// `limit` too large; when the size exceeds `limit` any number between the two.
double size_bound(const Bernstein& polynomial, double limit);

}  // namespace pliant::timeline
