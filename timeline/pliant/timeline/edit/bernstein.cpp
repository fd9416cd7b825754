#include "pliant/timeline/edit/bernstein.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pliant::timeline {

namespace {

double binomial(std::size_t n, std::size_t k) {
  double result = 1;
  for (std::size_t i = 1; i <= k; ++i) {
    result = result * static_cast<double>(n - k + i) / static_cast<double>(i);
  }
  return result;  // exact for the small degrees here
}

/// de Casteljau at the middle: `polynomial` becomes the left half, the right one is returned.
Bernstein halve(Bernstein& polynomial) {
  Bernstein right = polynomial;
  for (std::size_t round = 0; round + 1 < right.size(); ++round) {
    polynomial[round] = right.front();
    for (std::size_t i = 0; i + 1 + round < right.size(); ++i) {
      right[i] = (right[i] + right[i + 1]) / 2;
    }
  }
  polynomial.back() = right.front();
  return right;
}

}  // namespace

Bernstein product(const Bernstein& a, const Bernstein& b) {
  const std::size_t m = a.size() - 1;
  const std::size_t n = b.size() - 1;
  Bernstein result(m + n + 1, 0.0);
  for (std::size_t i = 0; i <= m; ++i) {
    for (std::size_t j = 0; j <= n; ++j) {
      result[i + j] += binomial(m, i) * binomial(n, j) * (a[i] * b[j]);
    }
  }
  for (std::size_t k = 0; k <= m + n; ++k) result[k] /= binomial(m + n, k);
  return result;
}

Bernstein composed(const Bernstein& cubic, const Bernstein& inner) {
  Bernstein rest = inner;  // 1 - inner
  for (double& each : rest) each = 1 - each;
  const Bernstein inner_squared = product(inner, inner);
  const Bernstein rest_squared = product(rest, rest);
  const Bernstein terms[] = {product(rest, rest_squared), product(inner, rest_squared),
                             product(inner_squared, rest), product(inner_squared, inner)};
  Bernstein result(terms[0].size(), 0.0);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = cubic[0] * terms[0][i] + 3 * (cubic[1] * terms[1][i]) +
                3 * (cubic[2] * terms[2][i]) + cubic[3] * terms[3][i];
  }
  return result;
}

Bernstein difference(const Bernstein& outer, const Bernstein& other) {
  Bernstein result = outer;
  // Multiplied by one, which raises the degree.
  const Bernstein raised = product(other, Bernstein(outer.size() - other.size() + 1, 1.0));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= raised[i];
  return result;
}

double size_bound(const Bernstein& polynomial, double limit) {
  constexpr double tolerance = 1e-3;
  constexpr int most_halvings = 24;
  double reached = 0;  // the largest absolute value found
  double bound = 0;
  std::vector<std::pair<Bernstein, int>> parts = {{polynomial, 0}};
  while (!parts.empty()) {
    auto [part, depth] = std::move(parts.back());
    parts.pop_back();
    double hull = 0;
    for (const double each : part) hull = std::max(hull, std::fabs(each));
    reached = std::max({reached, std::fabs(part.front()), std::fabs(part.back())});
    if (reached > limit) return reached;
    const bool is_settled = hull <= std::max((1 + tolerance) * reached, tolerance * limit);
    if (is_settled || depth == most_halvings) {
      bound = std::max(bound, hull);
      continue;
    }
    Bernstein right = halve(part);
    parts.emplace_back(std::move(right), depth + 1);
    parts.emplace_back(std::move(part), depth + 1);
  }
  return bound;
}

}  // namespace pliant::timeline
