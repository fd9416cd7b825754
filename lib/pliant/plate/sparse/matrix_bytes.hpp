#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

// The bytes of numbers and of matrices, to hash and to compare them. Internal to plate.

template <class Number>
std::string_view bytes_in(const Number* first, Eigen::Index count) {
  return {reinterpret_cast<const char*>(first), sizeof(Number) * static_cast<std::size_t>(count)};
}

/// Those of where its columns begin, of its rows and of its values. They refer to the matrix.
inline std::array<std::string_view, 3> matrix_bytes(const SparseMatrix& matrix) {
  return {bytes_in(matrix.outerIndexPtr(), matrix.cols() + 1),
          bytes_in(matrix.innerIndexPtr(), matrix.nonZeros()),
          bytes_in(matrix.valuePtr(), matrix.nonZeros())};
}

}  // namespace pliant
