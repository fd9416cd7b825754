#include "pliant/plate/energy/secants.hpp"

#include <utility>

namespace pliant {

double dot(const PlateKernels& kernels, const std::vector<double>& a,
           const std::vector<double>& b) {
  return kernels.dot_product(static_cast<long>(a.size()), a.data(), b.data());
}

void add(const PlateKernels& kernels, std::vector<double>& to, double part,
         const std::vector<double>& of) {
  kernels.add_scaled(static_cast<long>(to.size()), to.data(), part, of.data());
}

void Secants::learn(Numbers& way, Numbers& product, Numbers& change) {
  const double curvature = dot(kernels_, way, change);
  // Rounding may leave nothing to learn.
  if (!(curvature > 1e-4 * dot(kernels_, way, product))) return;
  Secant next;
  if (secants_.size() == most_) {
    next = std::move(secants_.front());
    secants_.pop_front();
  }
  next.way.swap(way);
  next.product.swap(product);
  next.change.swap(change);
  next.curvature = curvature;
  secants_.push_back(std::move(next));
}

void Secants::to_solve(Numbers& gradient) {
  parts_.resize(secants_.size());
  for (std::size_t k = secants_.size(); k-- > 0;) {
    const Secant& one = secants_[k];
    parts_[k] = dot(kernels_, one.way, gradient) / one.curvature;
    add(kernels_, gradient, -parts_[k], one.change);
  }
}

void Secants::finish(Numbers& way, Numbers& product) const {
  for (std::size_t k = 0; k < secants_.size(); ++k) {
    const Secant& one = secants_[k];
    const double part = parts_[k] - dot(kernels_, one.change, way) / one.curvature;
    add(kernels_, way, part, one.way);
    add(kernels_, product, part, one.product);
  }
}

}  // namespace pliant
