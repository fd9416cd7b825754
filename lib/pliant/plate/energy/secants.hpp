#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// What a convex energy's gradient did on the last ways that were gone, by which the next way is
/// better than the one that the elastic matrix A gives: the method of Broyden, Fletcher, Goldfarb
/// and Shanno with limited memory. Source: Nocedal & Wright, Numerical Optimization (2006),
/// algorithm 7.4. Numbers are so many that vectors divide them. Internal to plate.
class Secants {
 public:
  using Numbers = std::vector<double>;

  Secants(const PlateKernels& kernels, std::size_t most) : kernels_(kernels), most_(most) {}

  void clear() { secants_.clear(); }

  /// A way that was gone, with A times it, and what it changed of the gradient.
  void learn(Numbers way, Numbers product, Numbers change);

  /// A way down for a gradient: first what A has to be solved for, then the way and A times it for
  /// that solution.
  Numbers to_solve(Numbers gradient);
  void finish(Numbers& way, Numbers& product) const;

 private:
  struct Secant {
    Numbers way, product, change;
    double curvature;  // way . change
  };

  double dot(const Numbers& a, const Numbers& b) const {
    return kernels_.dot_product(static_cast<long>(a.size()), a.data(), b.data());
  }
  void add(Numbers& to, double part, const Numbers& of) const {
    kernels_.add_scaled(static_cast<long>(to.size()), to.data(), part, of.data());
  }

  const PlateKernels& kernels_;
  std::size_t most_;
  std::deque<Secant> secants_;
  std::vector<double> parts_;  // of each, in the last `to_solve`
};

}  // namespace pliant
