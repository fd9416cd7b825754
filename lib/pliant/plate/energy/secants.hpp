#pragma once

#include <cstddef>
#include <deque>
#include <vector>

namespace pliant {

/// What a convex energy's gradient did on the last ways that were gone, by which the next way is
/// better than the one that the elastic matrix A gives: the method of Broyden, Fletcher, Goldfarb
/// and Shanno with limited memory. Source: Nocedal & Wright, Numerical Optimization (2006),
/// algorithm 7.4. Internal to plate.
class Secants {
 public:
  using Numbers = std::vector<double>;

  explicit Secants(std::size_t most) : most_(most) {}

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

  std::size_t most_;
  std::deque<Secant> secants_;
  std::vector<double> parts_;  // of each, in the last `to_solve`
};

/// Adds `part` times `of`, of the same size.
void add_scaled(std::vector<double>& to, double part, const std::vector<double>& of);

/// a . b, summed in a fixed order.
double dot_product(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace pliant
