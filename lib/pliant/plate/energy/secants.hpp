#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// What a convex energy's gradient did on the last ways that were gone, by which the next way is
/// better than the one that the elastic matrix A gives: the method of Broyden, Fletcher, Goldfarb
/// and Shanno with limited memory. Numbers are so many that vectors divide them. Internal to plate.
/// Source: Nocedal & Wright, Numerical Optimization (2006), algorithm 7.4.
class Secants {
 public:
  using Numbers = std::vector<double>;

  Secants(const PlateKernels& kernels, std::size_t most) : kernels_(kernels), most_(most) {}

  void clear() { secants_.clear(); }

  /// A way that was gone, with A times it, and what it changed of the gradient. Leaves other
  /// numbers there, as many or none.
  void learn(Numbers& way, Numbers& product, Numbers& change);

  /// A way down for a gradient: first what A has to be solved for, in its place, then the way and A
  /// times it for that solution.
  void to_solve(Numbers& gradient);
  void finish(Numbers& way, Numbers& product) const;

 private:
  struct Secant {
    Numbers way, product, change;
    double curvature = 0;  // way . change
  };

  const PlateKernels& kernels_;
  std::size_t most_;
  std::deque<Secant> secants_;
  std::vector<double> parts_;  // of each, in the last `to_solve`
};

/// Products of numbers that vectors divide.
double dot(const PlateKernels& kernels, const std::vector<double>& a, const std::vector<double>& b);
/// to <- to + part of.
void add(const PlateKernels& kernels, std::vector<double>& to, double part,
         const std::vector<double>& of);

}  // namespace pliant
