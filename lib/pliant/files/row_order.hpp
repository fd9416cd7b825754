#pragma once

#include <algorithm>
#include <span>

#include "pliant/core/field.hpp"

namespace pliant {

/// Rows of a field that are written to a file at a time: few enough for the inner caches, enough
/// for one write each.
inline constexpr Eigen::Index rows_at_a_time = 8192;

/// Converts x y z of each row from `first` on, as many rows as fill `numbers`.
template <class Number>
void to_row_order(const Field& field, Eigen::Index first, std::span<Number> numbers) {
  const Eigen::Index count = static_cast<Eigen::Index>(numbers.size()) / 3;
  const double* const x = field.col(0).data() + first;
  const double* const y = field.col(1).data() + first;
  const double* const z = field.col(2).data() + first;
  Number* to = numbers.data();
  for (Eigen::Index row = 0; row < count; ++row, to += 3) {
    to[0] = static_cast<Number>(x[row]);
    to[1] = static_cast<Number>(y[row]);
    to[2] = static_cast<Number>(z[row]);
  }
}

/// Calls f(first, count) for blocks of `rows_at_a_time` rows until one call fails.
template <class F>
auto for_row_blocks(const Field& field, const F& f) -> decltype(f(0, 0)) {
  for (Eigen::Index first = 0; first < field.rows(); first += rows_at_a_time) {
    if (auto done = f(first, std::min(rows_at_a_time, field.rows() - first)); !done) return done;
  }
  return {};
}

}  // namespace pliant
