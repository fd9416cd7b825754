#include "pliant/core/anderson_mixing.hpp"

#include <cmath>
#include <utility>

namespace pliant {
namespace {

// Four sums, so that an addition need not wait for the last one.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sums[4] = {0, 0, 0, 0};
  const std::size_t whole = a.size() / 4 * 4;
  for (std::size_t k = 0; k < whole; k += 4) {
    for (std::size_t n = 0; n < 4; ++n) sums[n] += a[k + n] * b[k + n];
  }
  for (std::size_t k = whole; k < a.size(); ++k) sums[0] += a[k] * b[k];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// a - factor b
void subtract(std::vector<double>& a, double factor, const std::vector<double>& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] -= factor * b[k];
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  subtract(a, 1, b);
  return a;
}

}  // namespace

std::vector<double> AndersonMixing::next(const std::vector<double>& x, std::vector<double> image) {
  // A direction shorter than this part of its difference is rounding error.
  constexpr double least_part = 1e-8;
  std::vector<double> residual = difference(image, x);
  if (last_) {
    Direction fresh{difference(residual, last_->residual), difference(image, last_->image)};
    const double whole = std::sqrt(dot(fresh.residual, fresh.residual));
    for (int pass = 0; pass < 2; ++pass) {
      for (const Direction& known : directions_) {
        const double part = dot(known.residual, fresh.residual);
        subtract(fresh.residual, part, known.residual);
        subtract(fresh.image, part, known.image);
      }
    }
    const double length = std::sqrt(dot(fresh.residual, fresh.residual));
    if (length > least_part * whole && std::isfinite(1 / length)) {
      for (double& number : fresh.residual) number /= length;
      for (double& number : fresh.image) number /= length;
      if (directions_.size() == depth_) directions_.pop_front();
      directions_.push_back(std::move(fresh));
    }
  }
  last_ = Direction{residual, image};
  for (const Direction& known : directions_) {
    const double part = dot(known.residual, residual);
    subtract(residual, part, known.residual);
    subtract(image, part, known.image);
  }
  return image;
}

void AndersonMixing::clear() {
  directions_.clear();
  last_.reset();
}

}  // namespace pliant
