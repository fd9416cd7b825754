#include "pliant/plate/small_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

SmallModes small_modes(std::vector<double> matrix, std::size_t size) {
  const auto at = [&](std::size_t row, std::size_t column) -> double& {
    return matrix[row * size + column];
  };
  std::vector<double> vectors(size * size, 0);  // row by row, an eigenvector each
  for (std::size_t k = 0; k < size; ++k) vectors[k * size + k] = 1;
  constexpr int most_sweeps = 50;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool is_diagonal = true;
    for (std::size_t p = 0; p < size; ++p) {
      for (std::size_t q = p + 1; q < size; ++q) {
        const double beside = at(p, q);
        // Too small to change what is on the diagonal.
        if (at(p, p) + beside == at(p, p) && at(q, q) + beside == at(q, q)) continue;
        is_diagonal = false;
        const double half = (at(q, q) - at(p, p)) / (2 * beside);
        const double root = std::sqrt(1 + half * half);
        const double tangent = half >= 0 ? 1 / (half + root) : 1 / (half - root);
        const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
        for (std::size_t k = 0; k < size; ++k) {
          const double a = at(k, p), b = at(k, q);
          at(k, p) = cosine * a - sine * b;
          at(k, q) = sine * a + cosine * b;
        }
        for (std::size_t k = 0; k < size; ++k) {
          const double a = at(p, k), b = at(q, k);
          at(p, k) = cosine * a - sine * b;
          at(q, k) = sine * a + cosine * b;
          double& of_p = vectors[p * size + k];
          double& of_q = vectors[q * size + k];
          const double v = of_p, w = of_q;
          of_p = cosine * v - sine * w;
          of_q = sine * v + cosine * w;
        }
      }
    }
    if (is_diagonal) break;
  }
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return at(a, a) < at(b, b); });
  SmallModes modes;
  for (const std::size_t k : order) {
    modes.values.push_back(at(k, k));
    modes.vectors.insert(modes.vectors.end(), vectors.begin() + k * size,
                         vectors.begin() + (k + 1) * size);
  }
  return modes;
}

}  // namespace pliant
