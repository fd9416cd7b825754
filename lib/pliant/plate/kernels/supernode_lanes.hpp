// A factor in supernodes, and the solve with it: the part of the kernels after
// step_plastic_lanes.hpp. No #pragma once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// A column of a panel, of real numbers, is an `Eight`.
static_assert(panel_rows == 8);

PLIANT_INLINE void subtract(Eight& from, const Eight& column, double factor) {
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) from.part[k] = from.part[k] - column.part[k] * (factor - Lanes{});
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

// A column of a panel of complex numbers.
struct ComplexColumn {
  Eight re, im;
};
PLIANT_INLINE void subtract(ComplexColumn& from, const ComplexColumn& x, ComplexNumber factor) {
  subtract(from.re, x.re, factor.re);
  subtract(from.re, x.im, -factor.im);
  subtract(from.im, x.re, factor.im);
  subtract(from.im, x.im, factor.re);
}

// i times the numbers of a complex row, which has its real parts first.
PLIANT_INLINE Eight turned(const Eight& x) {
  Eight y;
#if PLIANT_LANES == 8
  const Lanes signs = {-1, -1, -1, -1, 1, 1, 1, 1};
  y.part[0] = __builtin_shufflevector(x.part[0], x.part[0], 4, 5, 6, 7, 0, 1, 2, 3) * signs;
#else
  constexpr int half = parts / 2;
#pragma GCC unroll 2
  for (int k = 0; k < half; ++k) {
    y.part[k] = -x.part[k + half];
    y.part[k + half] = x.part[k];
  }
#endif
  return y;
}
PLIANT_INLINE void subtract(Eight& from, const Eight& x, ComplexNumber factor) {
  subtract(from, x, factor.re);
  subtract(from, turned(x), factor.im);
}

// What a factor is made of: real numbers, or complex ones, of two doubles each.
struct RealNumbers {
  using Column = Eight;
  using Line = Row;
  static constexpr int width = 1;

  PLIANT_INLINE static Column load_column(const double* from) { return load8(from); }
  PLIANT_INLINE static void store_column(double* to, const Column& x) { store8(to, x); }
  PLIANT_INLINE static Line load_line(const double* x, long row) { return load_row(x, row); }
  PLIANT_INLINE static void store_line(double* x, long row, const Line& line) {
    store_row(x, row, line);
  }
  PLIANT_INLINE static double entry(const double* from, long k) { return from[k]; }
  PLIANT_INLINE static Line over(const Line& line, const double* pivots, long k) {
    return line / row_of(pivots[k]);
  }
};
struct ComplexNumbers {
  using Column = ComplexColumn;
  using Line = Eight;
  static constexpr int width = 2;

  PLIANT_INLINE static Column load_column(const double* from) {
    return {load8(from), load8(from + panel_rows)};
  }
  PLIANT_INLINE static void store_column(double* to, const Column& x) {
    store8(to, x.re);
    store8(to + panel_rows, x.im);
  }
  PLIANT_INLINE static Line load_line(const double* x, long row) {
    return load8(x + row * (width * row_numbers));
  }
  PLIANT_INLINE static void store_line(double* x, long row, const Line& line) {
    store8(x + row * (width * row_numbers), line);
  }
  PLIANT_INLINE static ComplexNumber entry(const double* from, long k) {
    return {from[2 * k], from[2 * k + 1]};
  }
  // The pivots are 1/D.
  PLIANT_INLINE static Line over(const Line& line, const double* pivots, long k) {
    const auto [re, im] = entry(pivots, k);
    Line product = {};
    subtract(product, line, {-re, -im});
    return product;
  }
};

// Doubles of a column of a panel.
template <class N>
constexpr long column_length = long{panel_rows} * N::width;

// Columns `first` to `first + Columns - 1` of `Panels` panels.
template <class N, int Columns, int Panels>
PLIANT_INLINE void reduce_columns(double* panels, long stride, const double* lower, int first,
                                  int depth) {
  typename N::Column sums[Panels][Columns];
  const double* of_column[Columns];
#pragma GCC unroll 4
  for (int j = 0; j < Columns; ++j)
    of_column[j] = lower + N::width * (static_cast<long>(first + j) * (first + j - 1) / 2);
#pragma GCC unroll 4
  for (int p = 0; p < Panels; ++p) {
#pragma GCC unroll 4
    for (int j = 0; j < Columns; ++j)
      sums[p][j] = N::load_column(panels + p * stride + (first + j) * column_length<N>);
  }
  const int common = first < depth ? first : depth;
  for (int k = 0; k < common; ++k) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) {
      const auto column = N::load_column(panels + p * stride + k * column_length<N>);
#pragma GCC unroll 4
      for (int j = 0; j < Columns; ++j) subtract(sums[p][j], column, N::entry(of_column[j], k));
    }
  }
  if (first < depth) {
#pragma GCC unroll 4
    for (int j = 1; j < Columns; ++j) {
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
#pragma GCC unroll 4
        for (int p = 0; p < Panels; ++p)
          subtract(sums[p][j], sums[p][k], N::entry(of_column[j], first + k));
      }
    }
  }
#pragma GCC unroll 4
  for (int p = 0; p < Panels; ++p) {
#pragma GCC unroll 4
    for (int j = 0; j < Columns; ++j)
      N::store_column(panels + p * stride + (first + j) * column_length<N>, sums[p][j]);
  }
}

template <class N, int Panels>
PLIANT_INLINE void reduce_some_panels(double* panels, long stride, const double* lower, int first,
                                      int last, int depth) {
  int column = first;
  for (; column + 4 <= last; column += 4)
    reduce_columns<N, 4, Panels>(panels, stride, lower, column, depth);
  for (; column < last; ++column)
    reduce_columns<N, 1, Panels>(panels, stride, lower, column, depth);
}

template <class N>
void reduce_panels(const PanelsView& view, int first, int last, int depth) {
  constexpr int at_once = N::width == 1 && lanes == panel_rows ? 2 : 1;  // as registers allow
  int panel = 0;
  for (; panel + at_once <= view.count; panel += at_once) {
    reduce_some_panels<N, at_once>(view.panels + panel * view.stride, view.stride, view.lower,
                                   first, last, depth);
  }
  for (; panel < view.count; ++panel) {
    reduce_some_panels<N, 1>(view.panels + panel * view.stride, view.stride, view.lower, first,
                             last, depth);
  }
}

template <class N, int Rows, int Panels>
PLIANT_INLINE void subtract_some_products(const ProductsView& view, int row, int panel) {
  const double* const panels = view.panels + panel * view.panel_stride;
  const double* const of_l = view.of_l + static_cast<long>(row) * (N::width * view.columns);
  double* const to = view.rows + row * view.stride + panel * column_length<N>;
  typename N::Column sums[Rows][Panels];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p)
      sums[r][p] = N::load_column(to + r * view.stride + p * column_length<N>);
  }
  for (int k = 0; k < view.columns; ++k) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p) {
      const auto column = N::load_column(panels + p * view.panel_stride + k * column_length<N>);
#pragma GCC unroll 4
      for (int r = 0; r < Rows; ++r)
        subtract(sums[r][p], column, N::entry(of_l, static_cast<long>(r) * view.columns + k));
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < Panels; ++p)
      N::store_column(to + r * view.stride + p * column_length<N>, sums[r][p]);
  }
}

template <class N, int Rows>
PLIANT_INLINE void subtract_products_of(const ProductsView& view, int row) {
  constexpr int at_once = N::width == 1 && lanes == panel_rows ? 2 : 1;
  int panel = 0;
  for (; panel + at_once <= view.panel_count; panel += at_once)
    subtract_some_products<N, Rows, at_once>(view, row, panel);
  for (; panel < view.panel_count; ++panel) subtract_some_products<N, Rows, 1>(view, row, panel);
}

template <class N>
void subtract_products(const ProductsView& view) {
  if (view.count == 4) return subtract_products_of<N, 4>(view, 0);
  for (int row = 0; row < view.count; ++row) subtract_products_of<N, 1>(view, row);
}

// Asks for so many numbers of L that are `distance` from these. A solve asks for as many as it
// uses, forward behind them and backward before them, since what it comes to next is not the next
// line for a processor to guess: rows are used side by side, and supernodes from the last to the
// first.
constexpr long prefetch_distance = 1024;  // [doubles]; 384 and 4096 are slower
template <int Numbers>
PLIANT_INLINE void prefetch(const double* entries, long distance) {
  constexpr int of_line = 8;
#pragma GCC unroll 8
  for (int k = 0; k < Numbers; k += of_line) __builtin_prefetch(entries + distance + k);
}

// Subtracts from `Rows` rows of L, which begin at `entries`, what `columns` rows of x above have
// for them.
template <class N, int Rows>
PLIANT_INLINE void subtract_above(typename N::Line (&sums)[Rows],
                                  const double* const (&entries)[Rows], const double* x,
                                  int columns) {
  for (int column = 0; column < columns; ++column) {
    const auto above = N::load_line(x, column);
    prefetch<N::width * Rows>(entries[0] + column * (N::width * Rows), prefetch_distance);
#pragma GCC unroll 8
    for (int r = 0; r < Rows; ++r) subtract(sums[r], above, N::entry(entries[r], column));
  }
}

// Own rows `first` to `first + Rows - 1`, of which `lower` has the first one's entries of L.
template <class N, int Rows>
struct OwnRows {
  typename N::Line lines[Rows];
  const double* entries[Rows];

  PLIANT_INLINE OwnRows(const double* lower, int first, const double* own) {
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      lines[r] = N::load_line(own, first + r);
      entries[r] = lower + N::width * (r * first + r * (r - 1) / 2);
    }
  }
};

template <class N, int Rows>
PLIANT_INLINE void solve_own(const double* lower, int first, double* own) {
  OwnRows<N, Rows> rows(lower, first, own);
  auto& [sums, entries] = rows;
  subtract_above<N, Rows>(sums, entries, own, first);
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int k = 0; k < r; ++k) subtract(sums[r], sums[k], N::entry(entries[r], first + k));
    N::store_line(own, first + r, sums[r]);
  }
}

// Subtracts from `Rows` rows below what the own rows have for them.
template <class N, int Rows>
PLIANT_INLINE void solve_below(const double* entries, int columns, const double* own,
                               const int* rows, double* x) {
  typename N::Line sums[Rows];
  const double* of_row[Rows];
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
    sums[r] = N::load_line(x, rows[r]);
    of_row[r] = entries + static_cast<long>(r) * (N::width * columns);
  }
  subtract_above<N, Rows>(sums, of_row, own, columns);
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) N::store_line(x, rows[r], sums[r]);
}

// Subtracts from the own rows, which are `Columns`, what the rows below have for them, in `Sums`
// sums each.
template <class N, int Columns, int Sums>
PLIANT_INLINE void subtract_below(const double* entries, int count, const int* rows,
                                  const double* x, double* own) {
  typename N::Line sums[Sums][Columns] = {};
  const auto subtract_row = [&](int n, int row) PLIANT_INLINED {
    const auto below = N::load_line(x, rows[row]);
    const double* const of_row = entries + static_cast<long>(row) * (N::width * Columns);
#pragma GCC unroll 8
    for (int column = 0; column < Columns; ++column)
      subtract(sums[n][column], below, N::entry(of_row, column));
  };
  int end = count;
  for (; end >= Sums; end -= Sums) {
    const double* const first = entries + (static_cast<long>(end) - Sums) * (N::width * Columns);
    prefetch<N::width * Sums * Columns>(first, -prefetch_distance);
#pragma GCC unroll 4
    for (int n = 0; n < Sums; ++n) subtract_row(n, end - 1 - n);
  }
  for (; end > 0; --end) subtract_row(0, end - 1);
#pragma GCC unroll 8
  for (int column = 0; column < Columns; ++column) {
    auto sum = sums[0][column];
#pragma GCC unroll 4
    for (int n = 1; n < Sums; ++n) sum = sum + sums[n][column];
    N::store_line(own, column, N::load_line(own, column) + sum);
  }
}

// The same if there are at most `Most` own rows, which registers hold; false: there are more.
template <class N, int Most = 8>
PLIANT_INLINE bool subtract_below_few(const double* entries, int columns, int count,
                                      const int* rows, const double* x, double* own) {
  constexpr int sums = Most <= 2 ? 4 : Most <= 4 ? 2 : 1;
  if (columns == Most) {
    subtract_below<N, Most, sums>(entries, count, rows, x, own);
    return true;
  }
  if constexpr (Most > 1)
    return subtract_below_few<N, Most - 1>(entries, columns, count, rows, x, own);
  return false;
}

// Subtracts from the own rows what `Rows` rows below have for them, which registers hold.
template <class N, int Rows>
PLIANT_INLINE void subtract_rows_below(const double* entries, int columns, const int* rows,
                                       const double* x, double* own) {
  typename N::Line below[Rows];
  const double* of_row[Rows];
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
    below[r] = N::load_line(x, rows[r]);
    of_row[r] = entries + static_cast<long>(r) * (N::width * columns);
  }
  for (int column = 0; column < columns; ++column) {
    auto sum = N::load_line(own, column);
    prefetch<N::width * Rows>(entries + column * (N::width * Rows), -prefetch_distance);
#pragma GCC unroll 8
    for (int r = 0; r < Rows; ++r) subtract(sum, below[r], N::entry(of_row[r], column));
    N::store_line(own, column, sum);
  }
}

// Own rows from which all later ones are subtracted: finds them, and subtracts them from those
// before.
template <class N, int Rows>
PLIANT_INLINE void solve_own_back(const double* lower, int first, double* own) {
  OwnRows<N, Rows> rows(lower, first, own);
  auto& [found, entries] = rows;
#pragma GCC unroll 4
  for (int r = Rows - 1; r >= 0; --r) {
#pragma GCC unroll 4
    for (int later = Rows - 1; later > r; --later)
      subtract(found[r], found[later], N::entry(entries[later], first + r));
    N::store_line(own, first + r, found[r]);
  }
  for (int row = 0; row < first; ++row) {
    auto sum = N::load_line(own, row);
#pragma GCC unroll 4
    for (int r = Rows - 1; r >= 0; --r) subtract(sum, found[r], N::entry(entries[r], row));
    N::store_line(own, row, sum);
  }
}

// Doubles of a strict lower triangle.
template <class N>
constexpr long lower_entries(int rows) {
  return N::width * (static_cast<long>(rows) * (rows - 1) / 2);
}

template <class N>
void solve_forward(const SupernodesView& factor, int supernode, double* x) {
  const Supernode& node = factor.supernodes[supernode];
  const int columns = node.columns;
  const double* const lower = factor.entries + N::width * node.entries_at;
  double* const own = x + static_cast<long>(node.first) * (N::width * row_numbers);
  int row = 0;
  for (; row + 4 <= columns; row += 4) solve_own<N, 4>(lower + lower_entries<N>(row), row, own);
  for (; row < columns; ++row) solve_own<N, 1>(lower + lower_entries<N>(row), row, own);
  const double* const below = lower + lower_entries<N>(columns);
  const int* const rows = factor.rows + node.rows_at;
  int i = 0;
  for (; i + 8 <= node.rows; i += 8)
    solve_below<N, 8>(below + static_cast<long>(i) * (N::width * columns), columns, own, rows + i,
                      x);
  for (; i + 4 <= node.rows; i += 4)
    solve_below<N, 4>(below + static_cast<long>(i) * (N::width * columns), columns, own, rows + i,
                      x);
  for (; i < node.rows; ++i)
    solve_below<N, 1>(below + static_cast<long>(i) * (N::width * columns), columns, own, rows + i,
                      x);
}

template <class N>
void solve_backward(const SupernodesView& factor, int supernode, double* x) {
  const Supernode& node = factor.supernodes[supernode];
  const int columns = node.columns;
  const double* const lower = factor.entries + N::width * node.entries_at;
  const double* const below = lower + lower_entries<N>(columns);
  double* const own = x + static_cast<long>(node.first) * (N::width * row_numbers);
  const int* const rows = factor.rows + node.rows_at;
  for (int row = 0; row < columns; ++row)
    N::store_line(own, row, N::over(N::load_line(own, row), factor.pivots, node.first + row));
  const auto subtract_rows = [&]<int Rows>(int first) PLIANT_INLINED {
    subtract_rows_below<N, Rows>(below + static_cast<long>(first) * (N::width * columns), columns,
                                 rows + first, x, own);
  };
  if (!subtract_below_few<N>(below, columns, node.rows, rows, x, own)) {
    int end = node.rows;
    for (; end >= 8; end -= 8) subtract_rows.template operator()<8>(end - 8);
    for (; end >= 4; end -= 4) subtract_rows.template operator()<4>(end - 4);
    for (; end > 0; --end) subtract_rows.template operator()<1>(end - 1);
  }
  int row = columns;
  for (; row >= 4; row -= 4) solve_own_back<N, 4>(lower + lower_entries<N>(row - 4), row - 4, own);
  for (; row > 0; --row) solve_own_back<N, 1>(lower + lower_entries<N>(row - 1), row - 1, own);
}

template <class N>
constexpr FactorKernels factor_kernels = {reduce_panels<N>, subtract_products<N>, solve_forward<N>,
                                          solve_backward<N>};

}  // namespace
}  // namespace pliant
