#pragma once

#include <cstddef>
#include <vector>

namespace pliant {

/// Eigenvalues of a small symmetric matrix, ascending, and an eigenvector of length 1 for each.
/// Internal to plate.
struct SmallModes {
  std::vector<double> values;
  std::vector<double> vectors;  ///< one after the other
};

/// Jacobi's rotations, with + - * / and roots only, so that the bits are the same everywhere.
/// `matrix`: row by row, size x size.
SmallModes small_modes(std::vector<double> matrix, std::size_t size);

}  // namespace pliant
