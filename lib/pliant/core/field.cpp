#include "pliant/core/field.hpp"

namespace pliant {

bool are_equal(const Field& a, const Field& b) { return a.rows() == b.rows() && a == b; }

LongestVector longest_vector(const Field& field) {
  LongestVector longest;
  const double square = field.rowwise().squaredNorm().maxCoeff(&longest.row);
  longest.length = std::sqrt(square);
  constexpr double least_exact = 1e-300;  // of squares: below it they lose digits
  if (std::isfinite(square) && square > least_exact) return longest;
  const double scale = field.cwiseAbs().maxCoeff();
  if (!(scale > 0) || !std::isfinite(scale)) return longest;
  longest.length =
      scale * std::sqrt((field / scale).rowwise().squaredNorm().maxCoeff(&longest.row));
  return longest;
}

}  // namespace pliant
