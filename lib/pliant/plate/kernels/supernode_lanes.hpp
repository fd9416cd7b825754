// A factor in supernodes, and the solve with it: the part of the kernels after
// step_plastic_lanes.hpp. No #pragma once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// A column of a panel is an `Eight`.
static_assert(panel_rows == 8);

PLIANT_INLINE void subtract(Eight& from, const Eight& column, double factor) {
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) from.part[k] = from.part[k] - column.part[k] * (factor - Lanes{});
}

// Columns `first` to `first + Columns - 1` of `Panels` panels.
template <int Columns, int Panels>
PLIANT_INLINE void reduce_columns(double* panels, long stride, const double* lower, int first,
                                  int depth) {
  Eight sums[Panels][Columns];
  const double* of_column[Columns];
#pragma GCC unroll 4
  for (int j = 0; j < Columns; ++j)
    of_column[j] = lower + static_cast<long>(first + j) * (first + j - 1) / 2;
#pragma GCC unroll 4
  for (int p = 0; p < Panels; ++p) {
#pragma GCC unroll 4
    for (int j = 0; j < Columns; ++j)
      sums[p][j] = load8(panels + p * stride + static_cast<long>(first + j) * panel_rows);
  }
  const int common = first < depth ? first : depth;
  for (int k = 0; k < common; ++k) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) {
      const Eight column = load8(panels + p * stride + static_cast<long>(k) * panel_rows);
#pragma GCC unroll 4
      for (int j = 0; j < Columns; ++j) subtract(sums[p][j], column, of_column[j][k]);
    }
  }
  if (first < depth) {
#pragma GCC unroll 4
    for (int j = 1; j < Columns; ++j) {
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
#pragma GCC unroll 4
        for (int p = 0; p < Panels; ++p) subtract(sums[p][j], sums[p][k], of_column[j][first + k]);
      }
    }
  }
#pragma GCC unroll 4
  for (int p = 0; p < Panels; ++p) {
#pragma GCC unroll 4
    for (int j = 0; j < Columns; ++j)
      store8(panels + p * stride + static_cast<long>(first + j) * panel_rows, sums[p][j]);
  }
}

template <int Panels>
PLIANT_INLINE void reduce_some_panels(double* panels, long stride, const double* lower, int first,
                                      int last, int depth) {
  int column = first;
  for (; column + 4 <= last; column += 4)
    reduce_columns<4, Panels>(panels, stride, lower, column, depth);
  for (; column < last; ++column) reduce_columns<1, Panels>(panels, stride, lower, column, depth);
}

void reduce_panels(const PanelsView& view, int first, int last, int depth) {
  constexpr int at_once = lanes == panel_rows ? 2 : 1;  // as registers allow
  int panel = 0;
  for (; panel + at_once <= view.count; panel += at_once) {
    reduce_some_panels<at_once>(view.panels + panel * view.stride, view.stride, view.lower, first,
                                last, depth);
  }
  for (; panel < view.count; ++panel) {
    reduce_some_panels<1>(view.panels + panel * view.stride, view.stride, view.lower, first, last,
                          depth);
  }
}

template <int Rows, int Panels>
PLIANT_INLINE void subtract_some_products(const ProductsView& view, int row, int panel) {
  const double* const panels = view.panels + panel * view.panel_stride;
  const double* const of_l = view.of_l + static_cast<long>(row) * view.columns;
  double* const to = view.rows + row * view.stride + static_cast<long>(panel) * panel_rows;
  Eight sums[Rows][Panels];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) sums[r][p] = load8(to + r * view.stride + p * panel_rows);
  }
  for (int k = 0; k < view.columns; ++k) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) {
      const Eight column =
          load8(panels + p * view.panel_stride + static_cast<long>(k) * panel_rows);
#pragma GCC unroll 4
      for (int r = 0; r < Rows; ++r)
        subtract(sums[r][p], column, of_l[static_cast<long>(r) * view.columns + k]);
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) store8(to + r * view.stride + p * panel_rows, sums[r][p]);
  }
}

template <int Rows>
PLIANT_INLINE void subtract_products_of(const ProductsView& view, int row) {
  constexpr int at_once = lanes == panel_rows ? 2 : 1;
  int panel = 0;
  for (; panel + at_once <= view.panel_count; panel += at_once)
    subtract_some_products<Rows, at_once>(view, row, panel);
  for (; panel < view.panel_count; ++panel) subtract_some_products<Rows, 1>(view, row, panel);
}

void subtract_products(const ProductsView& view) {
  if (view.count == 4) return subtract_products_of<4>(view, 0);
  for (int row = 0; row < view.count; ++row) subtract_products_of<1>(view, row);
}

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
PLIANT_OPERATOR(Row, /, row_parts)

PLIANT_INLINE void subtract(Row& from, const Row& row, double factor) {
#pragma GCC unroll 2
  for (int k = 0; k < row_parts; ++k)
    from.part[k] = from.part[k] - row.part[k] * (factor - RowLanes{});
}

// Subtracts from `Rows` rows of L, which begin at `entries`, what `columns` rows of x above have
// for them.
template <int Rows>
PLIANT_INLINE void subtract_above(Row (&sums)[Rows], const double* const (&entries)[Rows],
                                  const double* x, int columns) {
  for (int column = 0; column < columns; ++column) {
    const Row above = load_row(x, column);
#pragma GCC unroll 8
    for (int r = 0; r < Rows; ++r) subtract(sums[r], above, entries[r][column]);
  }
}

// Own rows `first` to `first + Rows - 1`, of which `lower` has the first one's entries of L.
template <int Rows>
PLIANT_INLINE void solve_own(const double* lower, int first, double* own) {
  Row sums[Rows];
  const double* entries[Rows];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    sums[r] = load_row(own, first + r);
    entries[r] = lower + r * first + r * (r - 1) / 2;
  }
  subtract_above<Rows>(sums, entries, own, first);
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int k = 0; k < r; ++k) subtract(sums[r], sums[k], entries[r][first + k]);
    store_row(own, first + r, sums[r]);
  }
}

// Subtracts from `Rows` rows below what the own rows have for them.
template <int Rows>
PLIANT_INLINE void solve_below(const double* entries, int columns, const double* own,
                               const int* rows, double* x) {
  Row sums[Rows];
  const double* of_row[Rows];
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
    sums[r] = load_row(x, rows[r]);
    of_row[r] = entries + static_cast<long>(r) * columns;
  }
  subtract_above<Rows>(sums, of_row, own, columns);
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) store_row(x, rows[r], sums[r]);
}

// Subtracts from `Columns` own rows what the rows below have for them, in `Sums` sums each.
template <int Columns, int Sums>
PLIANT_INLINE void subtract_below(const double* entries, int columns, int count, const int* rows,
                                  const double* x, double* own) {
  Row sums[Sums][Columns] = {};
  int i = 0;
  for (; i + Sums <= count; i += Sums) {
#pragma GCC unroll 4
    for (int n = 0; n < Sums; ++n) {
      const Row below = load_row(x, rows[i + n]);
      const double* const of_row = entries + static_cast<long>(i + n) * columns;
#pragma GCC unroll 8
      for (int column = 0; column < Columns; ++column)
        subtract(sums[n][column], below, of_row[column]);
    }
  }
  for (; i < count; ++i) {
    const Row below = load_row(x, rows[i]);
    const double* const of_row = entries + static_cast<long>(i) * columns;
#pragma GCC unroll 8
    for (int column = 0; column < Columns; ++column)
      subtract(sums[0][column], below, of_row[column]);
  }
#pragma GCC unroll 8
  for (int column = 0; column < Columns; ++column) {
    Row sum = sums[0][column];
#pragma GCC unroll 4
    for (int n = 1; n < Sums; ++n) sum = sum + sums[n][column];
    store_row(own, column, load_row(own, column) + sum);
  }
}

// Own rows `first` to `first + Rows - 1`, from which all later ones are subtracted: finds them, and
// subtracts them from those before.
template <int Rows>
PLIANT_INLINE void solve_own_back(const double* lower, int first, double* own) {
  Row found[Rows];
  const double* entries[Rows];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    found[r] = load_row(own, first + r);
    entries[r] = lower + r * first + r * (r - 1) / 2;
  }
#pragma GCC unroll 4
  for (int r = Rows - 1; r >= 0; --r) {
#pragma GCC unroll 4
    for (int later = Rows - 1; later > r; --later)
      subtract(found[r], found[later], entries[later][first + r]);
    store_row(own, first + r, found[r]);
  }
  for (int row = 0; row < first; ++row) {
    Row sum = load_row(own, row);
#pragma GCC unroll 4
    for (int r = Rows - 1; r >= 0; --r) subtract(sum, found[r], entries[r][row]);
    store_row(own, row, sum);
  }
}

constexpr long lower_entries(int rows) { return static_cast<long>(rows) * (rows - 1) / 2; }

void solve_forward(const SupernodesView& factor, int supernode, double* x) {
  const Supernode& node = factor.supernodes[supernode];
  const int columns = node.columns;
  const double* const lower = factor.entries + node.entries_at;
  double* const own = x + static_cast<long>(node.first) * row_numbers;
  int row = 0;
  for (; row + 4 <= columns; row += 4) solve_own<4>(lower + lower_entries(row), row, own);
  for (; row < columns; ++row) solve_own<1>(lower + lower_entries(row), row, own);
  const double* const below = lower + lower_entries(columns);
  const int* const rows = factor.rows + node.rows_at;
  int i = 0;
  for (; i + 8 <= node.rows; i += 8)
    solve_below<8>(below + static_cast<long>(i) * columns, columns, own, rows + i, x);
  for (; i + 4 <= node.rows; i += 4)
    solve_below<4>(below + static_cast<long>(i) * columns, columns, own, rows + i, x);
  for (; i < node.rows; ++i)
    solve_below<1>(below + static_cast<long>(i) * columns, columns, own, rows + i, x);
}

void solve_backward(const SupernodesView& factor, int supernode, double* x) {
  const Supernode& node = factor.supernodes[supernode];
  const int columns = node.columns;
  const double* const lower = factor.entries + node.entries_at;
  const double* const below = lower + lower_entries(columns);
  double* const own = x + static_cast<long>(node.first) * row_numbers;
  const int* const rows = factor.rows + node.rows_at;
  for (int row = 0; row < columns; ++row)
    store_row(own, row, load_row(own, row) / row_of(factor.pivots[node.first + row]));
  const auto subtract_from = [&]<int Columns, int Sums>(int column) PLIANT_INLINED {
    subtract_below<Columns, Sums>(below + column, columns, node.rows, rows, x,
                                  own + column * row_numbers);
  };
  int column = 0;
  for (; column + 8 <= columns; column += 8) subtract_from.template operator()<8, 1>(column);
  if (column + 4 <= columns) {
    subtract_from.template operator()<4, 1>(column);
    column += 4;
  }
  if (column + 2 <= columns) {
    subtract_from.template operator()<2, 2>(column);
    column += 2;
  }
  if (column < columns) subtract_from.template operator()<1, 4>(column);
  int row = columns;
  for (; row >= 4; row -= 4) solve_own_back<4>(lower + lower_entries(row - 4), row - 4, own);
  for (; row > 0; --row) solve_own_back<1>(lower + lower_entries(row - 1), row - 1, own);
}

}  // namespace
}  // namespace pliant
