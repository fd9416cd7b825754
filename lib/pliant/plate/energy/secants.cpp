#include "pliant/plate/energy/secants.hpp"

#include <utility>

namespace pliant {
void add_scaled(std::vector<double>& to, double part, const std::vector<double>& of) {
  double* const sums = to.data();
  const double* const numbers = of.data();
  const std::size_t size = to.size();
  for (std::size_t k = 0; k < size; ++k) sums[k] += part * numbers[k];
}

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sums[8] = {};
  const std::size_t whole = a.size() / 8 * 8;
  for (std::size_t k = 0; k < whole; k += 8) {
    for (std::size_t n = 0; n < 8; ++n) sums[n] += a[k + n] * b[k + n];
  }
  for (std::size_t k = whole; k < a.size(); ++k) sums[0] += a[k] * b[k];
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

void Secants::learn(Numbers way, Numbers product, Numbers change) {
  const double curvature = dot_product(way, change);
  // Rounding may leave nothing to learn.
  if (!(curvature > 1e-4 * dot_product(way, product))) return;
  if (secants_.size() == most_) secants_.pop_front();
  secants_.push_back({std::move(way), std::move(product), std::move(change), curvature});
}

Secants::Numbers Secants::to_solve(Numbers gradient) {
  parts_.resize(secants_.size());
  for (std::size_t k = secants_.size(); k-- > 0;) {
    const Secant& one = secants_[k];
    parts_[k] = dot_product(one.way, gradient) / one.curvature;
    add_scaled(gradient, -parts_[k], one.change);
  }
  return gradient;
}

void Secants::finish(Numbers& way, Numbers& product) const {
  for (std::size_t k = 0; k < secants_.size(); ++k) {
    const Secant& one = secants_[k];
    const double part = parts_[k] - dot_product(one.change, way) / one.curvature;
    add_scaled(way, part, one.way);
    add_scaled(product, part, one.product);
  }
}

}  // namespace pliant
