// The solve with a factor in supernodes: the part of the kernels after spectral_steps_lanes.hpp. No
// #pragma once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// The numbers of a row, in one or more vectors: one operation for each number, whatever the width.
constexpr int row_lanes = lanes < row_numbers ? lanes : row_numbers;
constexpr int row_parts = row_numbers / row_lanes;
using RowLanes __attribute__((vector_size(8 * row_lanes))) = double;
using RowLanesAt __attribute__((vector_size(8 * row_lanes), aligned(8), may_alias)) = double;
struct Row {
  RowLanes part[row_parts];
};

PLIANT_INLINE Row load_row(const double* x, long row) {
  const auto* const from = reinterpret_cast<const RowLanesAt*>(x + row * row_numbers);
  Row result;
#pragma GCC unroll 2
  for (int k = 0; k < row_parts; ++k) result.part[k] = from[k];
  return result;
}
PLIANT_INLINE void store_row(double* x, long row, const Row& numbers) {
  auto* const to = reinterpret_cast<RowLanesAt*>(x + row * row_numbers);
#pragma GCC unroll 2
  for (int k = 0; k < row_parts; ++k) to[k] = numbers.part[k];
}
PLIANT_INLINE Row row_of(double number) {
  Row result;
#pragma GCC unroll 2
  for (int k = 0; k < row_parts; ++k) result.part[k] = number - RowLanes{};
  return result;
}
PLIANT_OPERATOR(Row, +, row_parts)
PLIANT_OPERATOR(Row, -, row_parts)
PLIANT_OPERATOR(Row, *, row_parts)
PLIANT_OPERATOR(Row, /, row_parts)

// Subtracts from `Rows` rows below what the columns above have for them.
template <int Rows>
PLIANT_INLINE void eliminate_above(const double* entries, int columns, const double* own,
                                   const int* rows, double* x) {
  Row below[Rows];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) below[r] = load_row(x, rows[r]);
  for (int column = 0; column < columns; ++column) {
    const Row above = load_row(own, column);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r)
      below[r] = below[r] - row_of(entries[r * columns + column]) * above;
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) store_row(x, rows[r], below[r]);
}

// Subtracts from `Columns` rows what the rows below have for them.
template <int Columns>
PLIANT_INLINE void eliminate_below(const double* entries, int columns, int count, const int* rows,
                                   const double* x, double* own) {
  Row sums[Columns] = {};
  for (int i = 0; i < count; ++i) {
    const Row below = load_row(x, rows[i]);
    const double* const of_row = entries + static_cast<long>(i) * columns;
#pragma GCC unroll 8
    for (int column = 0; column < Columns; ++column) {
      sums[column] = sums[column] + row_of(of_row[column]) * below;
    }
  }
#pragma GCC unroll 8
  for (int column = 0; column < Columns; ++column) {
    store_row(own, column, load_row(own, column) - sums[column]);
  }
}

void solve_supernodes(const SupernodesView& factor, double* x) {
  for (int k = 0; k < factor.count; ++k) {
    const Supernode& node = factor.supernodes[k];
    const int columns = node.columns;
    const double* entries = factor.entries + node.entries_at;
    double* const own = x + static_cast<long>(node.first) * row_numbers;
    for (int column = 0; column < columns; ++column) {
      const Row above = load_row(own, column);
      for (int row = column + 1; row < columns; ++row) {
        store_row(own, row, load_row(own, row) - row_of(*entries++) * above);
      }
    }
    const int* const rows = factor.rows + node.rows_at;
    int i = 0;
    for (; i + 4 <= node.rows; i += 4) {
      eliminate_above<4>(entries + static_cast<long>(i) * columns, columns, own, rows + i, x);
    }
    for (; i < node.rows; ++i) {
      eliminate_above<1>(entries + static_cast<long>(i) * columns, columns, own, rows + i, x);
    }
  }
  for (int row = 0; row < factor.size; ++row) {
    store_row(x, row, load_row(x, row) / row_of(factor.pivots[row]));
  }
  for (int k = factor.count - 1; k >= 0; --k) {
    const Supernode& node = factor.supernodes[k];
    const int columns = node.columns;
    const long triangle = static_cast<long>(columns) * (columns - 1) / 2;
    const double* const entries = factor.entries + node.entries_at + triangle;
    double* const own = x + static_cast<long>(node.first) * row_numbers;
    const int* const rows = factor.rows + node.rows_at;
    int column = 0;
    for (; column + 8 <= columns; column += 8) {
      eliminate_below<8>(entries + column, columns, node.rows, rows, x, own + column * row_numbers);
    }
    for (; column + 3 <= columns; column += 3) {
      eliminate_below<3>(entries + column, columns, node.rows, rows, x, own + column * row_numbers);
    }
    for (; column < columns; ++column) {
      eliminate_below<1>(entries + column, columns, node.rows, rows, x, own + column * row_numbers);
    }
    const double* own_entries = entries;
    for (int row = columns - 2; row >= 0; --row) {
      own_entries -= columns - 1 - row;
      Row sum = load_row(own, row);
      for (int below = row + 1; below < columns; ++below) {
        sum = sum - row_of(own_entries[below - row - 1]) * load_row(own, below);
      }
      store_row(own, row, sum);
    }
  }
}

}  // namespace
}  // namespace pliant
