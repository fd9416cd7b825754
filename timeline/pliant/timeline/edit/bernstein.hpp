#pragma once

#include <vector>

namespace pliant::timeline {

/// A polynomial over [0, 1] by its degree + 1 Bernstein coefficients. It never leaves their range.
/// Source: Farin, Curves and Surfaces for CAGD, chapters 5 and 6.
using Bernstein = std::vector<double>;

Bernstein product(const Bernstein& a, const Bernstein& b);

/// The cubic with coefficients b0..b3 composed with the polynomial `inner`: degree 3·degree.
Bernstein composed(const Bernstein& cubic, const Bernstein& inner);

/// outer - other; `other` may have the lower degree.
Bernstein difference(const Bernstein& outer, const Bernstein& other);

/// An upper bound of the maximum norm of a polynomial over [0, 1], too large by at most a
/// thousandth of the norm or of `limit`; if the norm exceeds `limit`, any number between the two.
double size_bound(const Bernstein& polynomial, double limit);

}  // namespace pliant::timeline
