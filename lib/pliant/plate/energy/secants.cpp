#include "pliant/plate/energy/secants.hpp"

#include <utility>

namespace pliant {

void Secants::learn(Numbers way, Numbers product, Numbers change) {
  const double curvature = dot(way, change);
  // Rounding may leave nothing to learn.
  if (!(curvature > 1e-4 * dot(way, product))) return;
  if (secants_.size() == most_) secants_.pop_front();
  secants_.push_back({std::move(way), std::move(product), std::move(change), curvature});
}

Secants::Numbers Secants::to_solve(Numbers gradient) {
  parts_.resize(secants_.size());
  for (std::size_t k = secants_.size(); k-- > 0;) {
    const Secant& one = secants_[k];
    parts_[k] = dot(one.way, gradient) / one.curvature;
    add(gradient, -parts_[k], one.change);
  }
  return gradient;
}

void Secants::finish(Numbers& way, Numbers& product) const {
  for (std::size_t k = 0; k < secants_.size(); ++k) {
    const Secant& one = secants_[k];
    const double part = parts_[k] - dot(one.change, way) / one.curvature;
    add(way, part, one.way);
    add(product, part, one.product);
  }
}

}  // namespace pliant
