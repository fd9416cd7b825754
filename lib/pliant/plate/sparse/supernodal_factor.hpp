#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/number_block.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// A factor with its columns in supernodes: neighbouring columns that have the same rows below them
/// share these rows and are solved together, in vectors. The same bits for every width of vectors.
/// Internal to plate. Source: Davis, Rajamanickam, Sid-Lakhdar, "A survey of direct methods for
/// sparse linear systems" (2016).
class SupernodalFactor {
 public:
  explicit SupernodalFactor(const PlateKernels& kernels) : kernels_(&kernels) {}

  /// Finds the supernodes of a factor, and tells the bytes that `take` will need.
  std::size_t plan(const FactorColumns& columns);

  /// Copies the numbers of the factor that was planned last.
  void take(const FactorColumns& columns);

  /// Frees the numbers.
  void release() { numbers_.reset(); }

  /// What `take` copied, for other factors to solve with, in other threads too.
  struct Numbers;
  std::shared_ptr<const Numbers> numbers() const { return numbers_; }
  void use(std::shared_ptr<const Numbers> numbers);

  /// Solves for three right-hand sides (#rows x 3). Requires: `take` or `use` was called.
  Field solve(const Field& right_hand_sides);

 private:
  const PlateKernels* kernels_;
  std::shared_ptr<Numbers> planned_;
  std::shared_ptr<const Numbers> numbers_;
  NumberBlock x_;  // that a solve works on
};

}  // namespace pliant
