#pragma once

#include <cmath>

namespace pliant::timeline {

/// An unevaluated sum high + low with |low| <= ulp(high)/2: twice the digits of a double.
struct Pair {
  double high = 0;
  double low = 0;
};

// Error-free transformations: the pair equals the exact result. They need neither a fused
// multiply-add nor a wider type, so they are bit-identical everywhere. Source: Dekker, A
// floating-point technique for extending the available precision; Knuth, TAOCP 2, 4.2.2.

inline Pair exact_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

inline Pair exact_difference(double a, double b) { return exact_sum(a, -b); }

/// Veltkamp's split into two halves of at most 26 bits. Requires: |a| < 1e300.
inline Pair halves(double a) {
  const double shifted = 134217729.0 * a;  // 2^27 + 1
  const double high = shifted - (shifted - a);
  return {high, a - high};
}

inline Pair exact_product(double a, Pair a_halves, double b, Pair b_halves) {
  const double product = a * b;
  const double error = ((a_halves.high * b_halves.high - product) + a_halves.high * b_halves.low +
                        a_halves.low * b_halves.high) +
                       a_halves.low * b_halves.low;
  return {product, error};
}

inline Pair exact_product(double a, double b) { return exact_product(a, halves(a), b, halves(b)); }

// Sums and multiples of pairs, accurate to about 2^-104: enough for values computed once per
// segment.

inline Pair operator+(Pair a, Pair b) {
  const Pair sum = exact_sum(a.high, b.high);
  return exact_sum(sum.high, sum.low + (a.low + b.low));
}

inline Pair operator*(double factor, Pair a) {
  const Pair product = exact_product(factor, a.high);
  return exact_sum(product.high, product.low + factor * a.low);
}

}  // namespace pliant::timeline
