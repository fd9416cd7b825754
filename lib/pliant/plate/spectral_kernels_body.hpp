// The kernels, for vectors of PLIANT_LANES doubles; included once by each file that compiles them.
// No #pragma once, no other header: see spectral_kernels.hpp.

namespace pliant {
namespace {

constexpr int lanes = PLIANT_LANES;

// The compiler's own vectors: arithmetic by element. Those in memory need not be aligned.
typedef double Lanes __attribute__((vector_size(8 * PLIANT_LANES)));
typedef double LanesAt __attribute__((vector_size(8 * PLIANT_LANES), aligned(8), may_alias));

#define PLIANT_INLINE __attribute__((always_inline)) inline

PLIANT_INLINE Lanes load(const double* from) { return *reinterpret_cast<const LanesAt*>(from); }
PLIANT_INLINE void store(double* to, Lanes x) { *reinterpret_cast<LanesAt*>(to) = x; }
// Eight numbers, in as many vectors as that takes: sums over rows go by eights whatever the width.
constexpr int parts = 8 / lanes;
struct Eight {
  Lanes part[parts];
};

PLIANT_INLINE Eight load8(const double* from) {
  Eight x;
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) x.part[k] = load(from + k * lanes);
  return x;
}
PLIANT_INLINE void store8(double* to, const Eight& x) {
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) store(to + k * lanes, x.part[k]);
}
PLIANT_INLINE Eight all8(double number) {
  Eight x;
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) x.part[k] = number - Lanes{};
  return x;
}
#define PLIANT_EIGHT_OPERATOR(op)                                   \
  PLIANT_INLINE Eight operator op(const Eight& a, const Eight& b) { \
    Eight x;                                                        \
    _Pragma("GCC unroll 4") for (int k = 0; k < parts; ++k) {       \
      x.part[k] = a.part[k] op b.part[k];                           \
    }                                                               \
    return x;                                                       \
  }
PLIANT_EIGHT_OPERATOR(+)
PLIANT_EIGHT_OPERATOR(-)
PLIANT_EIGHT_OPERATOR(*)
#undef PLIANT_EIGHT_OPERATOR
PLIANT_INLINE Eight operator*(const Eight& a, double b) { return a * all8(b); }

PLIANT_INLINE double sum_of(const Eight& x) {
  double n[8];
  store8(n, x);
  return ((n[0] + n[4]) + (n[2] + n[6])) + ((n[1] + n[5]) + (n[3] + n[7]));
}

// One complex number a lane, in memory all real parts and then all imaginary ones.
struct Complex {
  Lanes re, im;
};
constexpr int complex_size = 2 * lanes;

PLIANT_INLINE Complex load_complex(const double* from) { return {load(from), load(from + lanes)}; }
PLIANT_INLINE void store_complex(double* to, const Complex& x) {
  store(to, x.re);
  store(to + lanes, x.im);
}
PLIANT_INLINE Complex operator+(const Complex& a, const Complex& b) {
  return {a.re + b.re, a.im + b.im};
}
PLIANT_INLINE Complex operator-(const Complex& a, const Complex& b) {
  return {a.re - b.re, a.im - b.im};
}
PLIANT_INLINE Complex times_minus_i(const Complex& a) { return {a.im, -a.re}; }
// a (cosine - i sine): forward transforms turn clockwise.
PLIANT_INLINE Complex turned(const Complex& a, double cosine, double sine) {
  return {a.re * cosine + a.im * sine, a.im * cosine - a.re * sine};
}

// The transform of R points; `roots` has cos and sin of 2 pi j/R for j = 1 ... (R-1)/2 if R is odd.
template <int R>
PLIANT_INLINE void butterfly(Complex (&x)[R], const double* roots) {
  if constexpr (R == 2) {
    const Complex sum = x[0] + x[1];
    x[1] = x[0] - x[1];
    x[0] = sum;
  } else if constexpr (R == 4) {
    const Complex a = x[0] + x[2], b = x[0] - x[2];
    const Complex c = x[1] + x[3], d = times_minus_i(x[1] - x[3]);
    x[0] = a + c;
    x[1] = b + d;
    x[2] = a - c;
    x[3] = b - d;
  } else {
    constexpr int half = (R - 1) / 2;
    Complex sum[half], difference[half];
    Complex first = x[0];
#pragma GCC unroll 8
    for (int j = 0; j < half; ++j) {
      sum[j] = x[j + 1] + x[R - 1 - j];
      difference[j] = x[j + 1] - x[R - 1 - j];
      first = first + sum[j];
    }
#pragma GCC unroll 8
    for (int k = 1; k <= half; ++k) {
      Complex even = x[0];
      Complex odd = {};
#pragma GCC unroll 8
      for (int j = 1; j <= half; ++j) {
        const int turn = j * k % R;
        const int root = turn <= half ? turn : R - turn;
        const double cosine = roots[2 * (root - 1)];
        const double sine = turn <= half ? roots[2 * (root - 1) + 1] : -roots[2 * (root - 1) + 1];
        even.re += sum[j - 1].re * cosine;
        even.im += sum[j - 1].im * cosine;
        // -i times the difference
        odd.re += difference[j - 1].im * sine;
        odd.im -= difference[j - 1].re * sine;
      }
      x[k] = even + odd;
      x[R - k] = even - odd;
    }
    x[0] = first;
  }
}

// One stage, decimation in frequency, self-sorting (Stockham): n = R m points, `stride` of each.
template <int R>
const double* stage(int m, int stride, const double* tables, const double* from, double* to) {
  const double* const roots = tables;
  if (R % 2 == 1) tables += R - 1;
  const long apart = static_cast<long>(stride) * m * complex_size;
  for (int p = 0; p < m; ++p) {
    const double* a = from + static_cast<long>(stride) * p * complex_size;
    double* b = to + static_cast<long>(stride) * R * p * complex_size;
    for (int q = 0; q < stride; ++q) {
      Complex x[R];
#pragma GCC unroll 16
      for (int j = 0; j < R; ++j) x[j] = load_complex(a + j * apart);
      butterfly<R>(x, roots);
      store_complex(b, x[0]);
#pragma GCC unroll 16
      for (int j = 1; j < R; ++j) {
        // For p = 0 nothing turns.
        const Complex y =
            p == 0 ? x[j] : turned(x[j], tables[2 * (j - 1)], tables[2 * (j - 1) + 1]);
        store_complex(b + static_cast<long>(j) * stride * complex_size, y);
      }
      a += complex_size;
      b += complex_size;
    }
    if (p > 0) tables += 2 * (R - 1);
  }
  return tables;
}

// Transforms `points`, with room for as many at `spare`; gives which of the two has the result.
double* fourier(const FourierView& view, double* points, double* spare) {
  const double* tables = view.tables;
  int n = view.length;
  int stride = 1;
  for (int k = 0; k < view.stage_count; ++k) {
    const int radix = view.radices[k];
    const int m = n / radix;
    switch (radix) {
      case 2:
        tables = stage<2>(m, stride, tables, points, spare);
        break;
      case 3:
        tables = stage<3>(m, stride, tables, points, spare);
        break;
      case 4:
        tables = stage<4>(m, stride, tables, points, spare);
        break;
      case 5:
        tables = stage<5>(m, stride, tables, points, spare);
        break;
      case 7:
        tables = stage<7>(m, stride, tables, points, spare);
        break;
      case 11:
        tables = stage<11>(m, stride, tables, points, spare);
        break;
      default:
        tables = stage<13>(m, stride, tables, points, spare);
        break;
    }
    double* const result = spare;
    spare = points;
    points = result;
    n = m;
    stride *= radix;
  }
  return points;
}

// The transform of the view's length by a convolution of another one (Bluestein).
double* chirped(const SineView& view, double* points, double* spare) {
  const int length = view.length;
  const int whole = view.fourier.length;
  for (int j = 0; j < length; ++j) {
    double* const p = points + static_cast<long>(j) * complex_size;
    store_complex(p, turned(load_complex(p), view.chirp[2 * j], view.chirp[2 * j + 1]));
  }
  for (int j = length; j < whole; ++j) {
    store_complex(points + static_cast<long>(j) * complex_size, Complex{});
  }
  double* const product = fourier(view.fourier, points, spare);
  double* const other = product == points ? spare : points;
  for (int k = 0; k < whole; ++k) {
    double* const p = product + static_cast<long>(k) * complex_size;
    const Complex x = turned(load_complex(p), view.kernel[2 * k], -view.kernel[2 * k + 1]);
    store_complex(p, {x.im, x.re});  // real and imaginary part exchanged: the way back
  }
  double* const result = fourier(view.fourier, product, other);
  for (int k = 0; k <= length / 2; ++k) {
    double* const p = result + static_cast<long>(k) * complex_size;
    const Complex x = load_complex(p);
    store_complex(p, turned({x.im, x.re}, view.chirp[2 * k], view.chirp[2 * k + 1]));
  }
  return result;
}

// docs/model.md, eq. (29): the sums and differences of mirrored points are the real input
// of one complex transform, whose real part has the even modes and whose imaginary part the odd
// ones.
void sine_transform(const SineView& view, double* points, double* work) {
  const int length = view.length;
  double* const spare = work + 2L * lanes * view.fourier.length;
  store_complex(work, Complex{});
  for (int j = 1; 2 * j <= length; ++j) {
    const Lanes x = load(points + static_cast<long>(j - 1) * lanes);
    const Lanes mirrored = load(points + static_cast<long>(length - j - 1) * lanes);
    const Lanes sum = x + mirrored;
    const Lanes difference = x - mirrored;
    const Lanes re = sum * view.fold[2 * j];
    const Lanes im = sum * view.fold[2 * j + 1];
    store_complex(work + static_cast<long>(length - j) * complex_size, {-re, -im - difference});
    store_complex(work + static_cast<long>(j) * complex_size, {re, difference - im});
  }
  const double* const sums =
      view.chirp ? chirped(view, work, spare) : fourier(view.fourier, work, spare);
  for (int k = 0; 2 * k + 1 < length; ++k) {
    const Complex x = load_complex(sums + static_cast<long>(k) * complex_size);
    store(points + static_cast<long>(2 * k) * lanes, -0.5 * x.im);
    if (k > 0) store(points + static_cast<long>(2 * k - 1) * lanes, 0.5 * x.re);
  }
  if (length % 2 == 1) {  // the last mode is even, and has no odd one after it
    const Complex x = load_complex(sums + static_cast<long>(length / 2) * complex_size);
    store(points + static_cast<long>(length - 2) * lanes, 0.5 * x.re);
  }
}

// Rows become columns: in each round, neighbours at a power of two exchange halves.
template <int Apart>
PLIANT_INLINE void exchange(Lanes& a, Lanes& b) {
  const Lanes x = a, y = b;
#if PLIANT_LANES == 2
  a = __builtin_shufflevector(x, y, 0, 2);
  b = __builtin_shufflevector(x, y, 1, 3);
#elif PLIANT_LANES == 4
  if constexpr (Apart == 1) {
    a = __builtin_shufflevector(x, y, 0, 4, 2, 6);
    b = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  } else {
    a = __builtin_shufflevector(x, y, 0, 1, 4, 5);
    b = __builtin_shufflevector(x, y, 2, 3, 6, 7);
  }
#else
  if constexpr (Apart == 1) {
    a = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
    b = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  } else if constexpr (Apart == 2) {
    a = __builtin_shufflevector(x, y, 0, 1, 8, 9, 4, 5, 12, 13);
    b = __builtin_shufflevector(x, y, 2, 3, 10, 11, 6, 7, 14, 15);
  } else {
    a = __builtin_shufflevector(x, y, 0, 1, 2, 3, 8, 9, 10, 11);
    b = __builtin_shufflevector(x, y, 4, 5, 6, 7, 12, 13, 14, 15);
  }
#endif
}
template <int Apart>
PLIANT_INLINE void exchange_all(Lanes (&x)[lanes]) {
#pragma GCC unroll 8
  for (int k = 0; k < lanes; ++k) {
    if ((k & Apart) == 0) exchange<Apart>(x[k], x[k + Apart]);
  }
}
PLIANT_INLINE void transpose(Lanes (&x)[lanes]) {
  exchange_all<1>(x);
  if constexpr (lanes >= 4) exchange_all<2>(x);
  if constexpr (lanes == 8) exchange_all<4>(x);
}

// The first `count` <= lanes numbers, the others 0.
PLIANT_INLINE Lanes load_some(const double* from, int count) {
  if (count == lanes) return load(from);
  Lanes x = {};
  for (int lane = 0; lane < count; ++lane) x[lane] = from[lane];
  return x;
}
PLIANT_INLINE void store_some(double* to, Lanes x, int count) {
  if (count == lanes) return store(to, x);
  for (int lane = 0; lane < count; ++lane) to[lane] = x[lane];
}

PLIANT_INLINE int least(int a, int b) { return a < b ? a : b; }

// Columns that lie side by side in memory are brought in and out by groups of several tiles, since
// a row of one tile alone is one line of the cache out of a page.

// The tiles of a group, each points x lanes, after the room for the transform itself.
PLIANT_INLINE double* tiles_in(const SineView& view, double* work) {
  return work + sine_work(view) * lanes;
}

// Where the nodes along lie one after another, `count` columns from `from` on, into tiles.
void fetch_columns(const double* from, long stride, int points, int count, double* tiles) {
  const long tile = static_cast<long>(points) * lanes;
  for (int j = 0; j < points; ++j) {
    for (int done = 0, g = 0; done < count; done += lanes, ++g) {
      store(tiles + g * tile + static_cast<long>(j) * lanes,
            load_some(from + j * stride + done, least(lanes, count - done)));
    }
  }
}

void put_columns(const double* tiles, long stride, int points, int count, double* to) {
  const long tile = static_cast<long>(points) * lanes;
  for (int j = 0; j < points; ++j) {
    for (int done = 0, g = 0; done < count; done += lanes, ++g) {
      store_some(to + j * stride + done, load(tiles + g * tile + static_cast<long>(j) * lanes),
                 least(lanes, count - done));
    }
  }
}

// Where the points of a transform lie one after another, `count` <= lanes rows, into one tile.
void fetch_rows(const double* from, long stride, int points, int count, double* tile) {
  for (int j = 0; j < points; j += lanes) {
    const int wide = least(lanes, points - j);
    Lanes x[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      x[lane] = lane < count ? load_some(from + lane * stride + j, wide) : Lanes{};
    }
    transpose(x);
    for (int r = 0; r < wide; ++r) store(tile + static_cast<long>(j + r) * lanes, x[r]);
  }
}

void put_rows(const double* tile, long stride, int points, int count, double* to) {
  for (int j = 0; j < points; j += lanes) {
    const int wide = least(lanes, points - j);
    Lanes x[lanes];
    for (int r = 0; r < lanes; ++r) {
      x[r] = r < wide ? load(tile + static_cast<long>(j + r) * lanes) : Lanes{};
    }
    transpose(x);
    for (int lane = 0; lane < count; ++lane) store_some(to + lane * stride + j, x[lane], wide);
  }
}

// Modes of one parity, from a tile of all modes (odd ones at even places) to rows between.
void put_modes(const TransformView& view, const double* tile, int parity, int count, double* to) {
  const int modes = parity == 0 ? odd_modes(view.across.length) : even_modes(view.across.length);
  double* const begin = to + parity * view.even_column;
  for (int m = 0; m < modes; m += lanes) {
    Lanes x[lanes];
    for (int r = 0; r < lanes; ++r) {
      const int l = 2 * (m + r) + parity;
      x[r] =
          m + r < modes ? load(tile + static_cast<long>(l) * lanes) * view.across_in[l] : Lanes{};
    }
    transpose(x);
    for (int lane = 0; lane < count; ++lane) {
      store(begin + static_cast<long>(lane) * view.between_pitch + m, x[lane]);
    }
  }
}

void fetch_modes(const TransformView& view, const double* from, int parity, int count,
                 double* tile) {
  const int modes = parity == 0 ? odd_modes(view.across.length) : even_modes(view.across.length);
  const double* const begin = from + parity * view.even_column;
  for (int m = 0; m < modes; m += lanes) {
    Lanes x[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      x[lane] =
          lane < count ? load(begin + static_cast<long>(lane) * view.between_pitch + m) : Lanes{};
    }
    transpose(x);
    for (int r = 0; r < least(lanes, modes - m); ++r) {
      const int l = 2 * (m + r) + parity;
      store(tile + static_cast<long>(l) * lanes, x[r] * view.across_out[l]);
    }
  }
}

void in_across(const TransformView& view, const double* field, int first, int last, double* between,
               double* work) {
  const int points = view.across.length - 1;
  double* const tiles = tiles_in(view.across, work);
  for (int i = first; i < last; i += group_columns) {
    const int width = least(group_columns, last - i);
    if (view.along_stride == 1) {
      fetch_columns(field + i, view.across_stride, points, width, tiles);
    }
    for (int done = 0; done < width; done += lanes) {
      const int count = least(lanes, width - done);
      double* const tile = tiles + static_cast<long>(done) * points;
      if (view.along_stride != 1) {
        fetch_rows(field + (i + done) * view.along_stride, view.along_stride, points, count, tile);
      }
      sine_transform(view.across, tile, work);
      double* const to = between + static_cast<long>(i + done) * view.between_pitch;
      put_modes(view, tile, 0, count, to);
      put_modes(view, tile, 1, count, to);
    }
  }
}

void out_across(const TransformView& view, const double* between, int first, int last,
                double* field, double* work) {
  const int points = view.across.length - 1;
  double* const tiles = tiles_in(view.across, work);
  for (int i = first; i < last; i += group_columns) {
    const int width = least(group_columns, last - i);
    for (int done = 0; done < width; done += lanes) {
      const int count = least(lanes, width - done);
      double* const tile = tiles + static_cast<long>(done) * points;
      const double* const from = between + static_cast<long>(i + done) * view.between_pitch;
      fetch_modes(view, from, 0, count, tile);
      fetch_modes(view, from, 1, count, tile);
      sine_transform(view.across, tile, work);
      if (view.along_stride != 1) {
        put_rows(tile, view.along_stride, points, count, field + (i + done) * view.along_stride);
      }
    }
    if (view.along_stride == 1) put_columns(tiles, view.across_stride, points, width, field + i);
  }
}

// The coefficients of mode k along (from 0) at a column between.
PLIANT_INLINE double* coefficients_at(const TransformView& view,
                                      const CoefficientsView& coefficients, int k, int column) {
  const int parity = column >= view.even_column;
  return coefficients.of[2 * (k % 2) + parity] + static_cast<long>(k / 2) * view.pitch[parity] +
         (column - parity * view.even_column);
}

void in_along(const TransformView& view, const double* between, int first, int last,
              const CoefficientsView& coefficients, double* work) {
  const int points = view.along.length - 1;
  double* const tiles = tiles_in(view.along, work);
  for (int column = first; column < last; column += group_columns) {
    const int width = least(group_columns, last - column);
    fetch_columns(between + column, view.between_pitch, points, width, tiles);
    for (int done = 0; done < width; done += lanes) {
      sine_transform(view.along, tiles + static_cast<long>(done) * points, work);
    }
    for (int k = 0; k < points; ++k) {
      for (int done = 0; done < width; done += lanes) {
        store(coefficients_at(view, coefficients, k, column + done),
              load(tiles + static_cast<long>(done) * points + static_cast<long>(k) * lanes) *
                  view.along_in[k]);
      }
    }
  }
}

void out_along(const TransformView& view, const CoefficientsView& coefficients, int first, int last,
               double* between, double* work) {
  const int points = view.along.length - 1;
  double* const tiles = tiles_in(view.along, work);
  for (int column = first; column < last; column += group_columns) {
    const int width = least(group_columns, last - column);
    for (int k = 0; k < points; ++k) {
      for (int done = 0; done < width; done += lanes) {
        store(tiles + static_cast<long>(done) * points + static_cast<long>(k) * lanes,
              load(coefficients_at(view, coefficients, k, column + done)) * view.along_out[k]);
      }
    }
    for (int done = 0; done < width; done += lanes) {
      sine_transform(view.along, tiles + static_cast<long>(done) * points, work);
    }
    put_columns(tiles, view.between_pitch, points, width, between + column);
  }
}

// Rows at once: they share what belongs to the columns. As many as there are registers for.
constexpr int rows_at_once = lanes == 8 ? 4 : lanes == 4 ? 2 : 1;

// The sums over `Rows` rows of `pending` from row k on, and what they leave to the columns.
template <int Rows>
PLIANT_INLINE void gather(const ParityView& parity, const ComponentView& component, int k,
                          const Eight (&sums)[Rows]) {
  double taken[Rows], weight[Rows];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    component.row_sums[k + r] = sum_of(sums[r]);
    taken[r] = component.row_sums[k + r] * parity.row_pivot[k + r];
    weight[r] = parity.row_weight[k + r];
  }
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    Eight column = load8(component.column_sums + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      column = column + (load8(component.pending + at) - load8(parity.reciprocal + at) * taken[r]) *
                            weight[r];
    }
    store8(component.column_sums + l, column);
  }
}

template <int Rows>
PLIANT_INLINE void start_rows(const ParityView& parity, const ComponentView& component,
                              double shift, double inertia, int k) {
  Eight sums[Rows] = {};
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight weight = load8(parity.column_weight + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      const Eight reciprocal = load8(parity.reciprocal + at);
      const Eight load = load8(component.load + at) * reciprocal;
      const Eight held =
          load8(component.displacement + at) * shift + load8(component.pending + at) * inertia;
      const Eight pending = load + held * reciprocal;
      store8(component.load + at, load);
      store8(component.pending + at, pending);
      sums[r] = sums[r] + weight * pending;
    }
  }
  gather<Rows>(parity, component, k, sums);
}

PLIANT_INLINE void clear(double* numbers, int count) {
  for (int l = 0; l < count; l += 8) store8(numbers + l, Eight{});
}

void start(const ParityView& parity, const ComponentView& component, double shift, double inertia) {
  clear(component.column_sums, parity.columns);
  int k = 0;
  for (; k + rows_at_once <= parity.rows; k += rows_at_once) {
    start_rows<rows_at_once>(parity, component, shift, inertia, k);
  }
  for (; k < parity.rows; ++k) start_rows<1>(parity, component, shift, inertia, k);
}

// Eq. (26): y = C^-1 q sums; xi = y/q. Leaves the sums 0.
void solve_edge(const ParityView& parity, const ComponentView& component) {
  const int n = parity.columns;
  double* const x = component.column_sums;
  for (int l = 0; l < n; l += 8) store8(x + l, load8(x + l) * load8(parity.column_scale + l));
  constexpr int rows = lanes == 2 ? 2 : 8;
  for (int i = 0; i < n; i += rows) {
    const double* const row = parity.inverse + static_cast<long>(i) * parity.inverse_pitch;
    Eight sums[rows] = {};
    for (int l = 0; l < n; l += 8) {
      const Eight right = load8(x + l);
#pragma GCC unroll 8
      for (int r = 0; r < rows; ++r) {
        sums[r] = sums[r] + load8(row + static_cast<long>(r) * parity.inverse_pitch + l) * right;
      }
    }
    for (int r = 0; r < rows; ++r) component.edge[i + r] = sum_of(sums[r]);
  }
  for (int l = 0; l < n; l += 8) {
    const Eight y = load8(component.edge + l);
    store8(component.edge + n + l, y * load8(parity.column_scale + l));
    store8(component.edge + l, y * load8(parity.column_unscale + l));
  }
  clear(x, n);
}

// Upsilon of the rows, from the edge and the sums that the rows had.
template <int Rows>
PLIANT_INLINE void solve_rows(const ParityView& parity, const ComponentView& component, int k,
                              double (&upsilon)[Rows]) {
  Eight sums[Rows] = {};
  const double* const weighted = component.edge + parity.columns;
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight edge = load8(weighted + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      sums[r] = sums[r] +
                edge * load8(parity.reciprocal + begin + static_cast<long>(r) * parity.pitch + l);
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    upsilon[r] = (component.row_sums[k + r] - sum_of(sums[r])) * parity.row_pivot[k + r];
  }
}

template <int Rows>
PLIANT_INLINE void step_rows(const ParityView& parity, const ComponentView& component,
                             StepFactors factors, int k) {
  double upsilon[Rows];
  solve_rows<Rows>(parity, component, k, upsilon);
  Eight sums[Rows] = {};
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight xi = load8(component.edge + l);
    const Eight weight = load8(parity.column_weight + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      const Eight reciprocal = load8(parity.reciprocal + at);
      const Eight next = load8(component.pending + at) - (xi + all8(upsilon[r])) * reciprocal;
      const Eight held = next * factors.grow - load8(component.displacement + at) * factors.keep;
      const Eight pending = load8(component.load + at) + held * reciprocal;
      store8(component.displacement + at, next);
      store8(component.pending + at, pending);
      sums[r] = sums[r] + weight * pending;
    }
  }
  gather<Rows>(parity, component, k, sums);
}

void step(const ParityView& parity, const ComponentView& component, StepFactors factors) {
  solve_edge(parity, component);
  int k = 0;
  for (; k + rows_at_once <= parity.rows; k += rows_at_once) {
    step_rows<rows_at_once>(parity, component, factors, k);
  }
  for (; k < parity.rows; ++k) step_rows<1>(parity, component, factors, k);
}

void last_step(const ParityView& parity, const ComponentView& component, double rate) {
  solve_edge(parity, component);
  for (int k = 0; k < parity.rows; ++k) {
    double upsilon[1];
    solve_rows<1>(parity, component, k, upsilon);
    for (int l = 0; l < parity.columns; l += 8) {
      const long at = static_cast<long>(k) * parity.pitch + l;
      const Eight next =
          load8(component.pending + at) -
          (load8(component.edge + l) + all8(upsilon[0])) * load8(parity.reciprocal + at);
      store8(component.pending + at, (next - load8(component.displacement + at)) * rate);
      store8(component.displacement + at, next);
    }
  }
}

// C -= P_i^T P_j for `Rows` of the eight columns of panel i and the Wide panels from j on.
template <int Rows, int Wide>
PLIANT_INLINE void subtract_tile(const double* panel_i, const double* panel_j, long panel_size,
                                 int depth, double* c, int pitch) {
  Eight sum[Rows][Wide];
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) sum[r][w] = load8(c + static_cast<long>(r) * pitch + 8 * w);
  }
  for (int k = 0; k < depth; ++k) {
    Eight right[Wide];
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) right[w] = load8(panel_j + w * panel_size + 8L * k);
#pragma GCC unroll 8
    for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
      for (int w = 0; w < Wide; ++w) sum[r][w] = sum[r][w] - right[w] * panel_i[8L * k + r];
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) store8(c + static_cast<long>(r) * pitch + 8 * w, sum[r][w]);
  }
}

// C -= P^T P in the upper triangle of C, whose order is a multiple of 8. P (depth x order) lies in
// panels of eight columns. Every element is summed from the first row of P to the last.
void subtract_gram(const double* panels, int depth, int order, double* c, int pitch) {
  constexpr int rows = lanes == 8 ? 8 : lanes == 4 ? 4 : 2;
  const long panel_size = 8L * depth;
  for (int i = 0; i < order; i += 8) {
    const double* const left = panels + i / 8 * panel_size;
    int j = i;
    for (; lanes == 8 && j + 16 <= order; j += 16) {
      subtract_tile<8, 2>(left, panels + j / 8 * panel_size, panel_size, depth,
                          c + static_cast<long>(i) * pitch + j, pitch);
    }
    for (; j < order; j += 8) {
      for (int r = 0; r < 8; r += rows) {
        subtract_tile<rows, 1>(left + r, panels + j / 8 * panel_size, panel_size, depth,
                               c + static_cast<long>(i + r) * pitch + j, pitch);
      }
    }
  }
}

// U^T U = C for the upper triangle of C, in place, in blocks of rows; 1/U_ii on the diagonal. Gives
// the first row whose pivot is not positive, or -1.
int factor_upper(double* c, int order, int pitch, double* panels) {
  constexpr int block = 64;
  for (int begin = 0; begin < order; begin += block) {
    const int end = begin + block < order ? begin + block : order;
    for (int i = begin; i < end; ++i) {
      double* const row = c + static_cast<long>(i) * pitch;
      if (!(row[i] > 0) || row[i] > 1e300) return i;
      const double reciprocal = 1 / __builtin_sqrt(row[i]);
      row[i] = reciprocal;
      for (int l = i + 1; l < order; ++l) row[l] *= reciprocal;
      for (int below = i + 1; below < end; ++below) {
        double* const other = c + static_cast<long>(below) * pitch;
        const double weight = row[below];
        for (int l = below; l < order; ++l) other[l] -= row[l] * weight;
      }
    }
    const int depth = end - begin;
    for (int j = end; j < order; j += 8) {
      for (int k = 0; k < depth; ++k) {
        store8(panels + (static_cast<long>(j - end) / 8 * depth + k) * 8,
               load8(c + static_cast<long>(begin + k) * pitch + j));
      }
    }
    subtract_gram(panels, depth, order - end, c + static_cast<long>(end) * pitch + end, pitch);
  }
  return -1;
}

// One tile of C -= P_i^T P_j, of eight columns each.
PLIANT_INLINE void subtract_square(const double* panel_i, const double* panel_j, int depth,
                                   double* c, int pitch) {
  constexpr int rows = lanes == 8 ? 8 : lanes == 4 ? 4 : 2;
  for (int r = 0; r < 8; r += rows) {
    subtract_tile<rows, 1>(panel_i + r, panel_j, 0, depth, c + static_cast<long>(r) * pitch, pitch);
  }
}

// The inverse of U^T U in place of U, all of it. First P with U^T P = I, lower triangular, in
// panels of eight columns, from each panel's own rows on; then P^T P.
void invert_upper(double* c, int order, int pitch, double* panels) {
  const long panel_size = 8L * order;
  double* const left = panels + order * static_cast<long>(order);  // eight columns of U
  for (int b = 0; b < order; b += 8) {
    for (int k = 0; k < b; ++k) store8(left + 8L * k, load8(c + static_cast<long>(k) * pitch + b));
    for (int j = 0; j <= b; j += 8) {
      double* const panel = panels + j / 8 * panel_size;
      double* const tile = panel + 8L * b;
      for (int r = 0; r < 8; ++r) {
        for (int l = 0; l < 8; ++l) tile[8 * r + l] = b + r == j + l ? 1 : 0;
      }
      subtract_square(left + 8L * j, panel + 8L * j, b - j, tile, 8);
      for (int r = 0; r < 8; ++r) {
        const double* const row = c + static_cast<long>(b + r) * pitch + b;
        const Eight solved = load8(tile + 8 * r) * row[r];
        store8(tile + 8 * r, solved);
        for (int below = r + 1; below < 8; ++below) {
          store8(tile + 8 * below, load8(tile + 8 * below) - solved * row[below]);
        }
      }
    }
  }
  for (int i = 0; i < order; i += 8) {
    for (int j = i; j < order; j += 8) {
      double tile[64] = {};
      subtract_square(panels + i / 8 * panel_size + 8L * j, panels + j / 8 * panel_size + 8L * j,
                      order - j, tile, 8);
      for (int r = 0; r < 8; ++r) {
        for (int l = 0; l < 8; ++l) {
          c[static_cast<long>(i + r) * pitch + j + l] = -tile[8 * r + l];
          c[static_cast<long>(j + l) * pitch + i + r] = -tile[8 * r + l];
        }
      }
    }
  }
}

// Eq. (25) and (27): the pivots 1/h_k, then C = diag(1/beta + sum over k of p_k^2/D_kl) - sum over
// k of z_k z_k^T with z_kl = q_l p_k/D_kl sqrt(1/h_k), and its inverse.
int invert_edge(const ParityView& parity, double beta, double delta, double* row_pivot, double* c,
                double* panels) {
  const int n = parity.columns;
  const int pitch = parity.inverse_pitch;
  for (int k = 0; k < parity.rows; ++k) {
    Eight sum = {};
    for (int l = 0; l < n; l += 8) {
      sum = sum + load8(parity.column_weight + l) *
                      load8(parity.reciprocal + static_cast<long>(k) * parity.pitch + l);
    }
    row_pivot[k] = 1 / (1 / delta + sum_of(sum));
  }
  for (int i = 0; i < n; ++i) clear(c + static_cast<long>(i) * pitch, n);
  for (int l = 0; l < n; l += 8) {
    const Eight scale = load8(parity.column_scale + l);
    Eight sum = all8(1 / beta);
    for (int k = 0; k < parity.rows; ++k) {
      const Eight reciprocal = load8(parity.reciprocal + static_cast<long>(k) * parity.pitch + l);
      sum = sum + reciprocal * parity.row_weight[k];
      const double weight = __builtin_sqrt(parity.row_weight[k] * row_pivot[k]);
      store8(panels + (static_cast<long>(l) / 8 * parity.rows + k) * 8,
             reciprocal * scale * weight);
    }
    double diagonal[8];
    store8(diagonal, sum);
    for (int k = 0; k < 8; ++k) c[static_cast<long>(l + k) * pitch + l + k] = diagonal[k];
  }
  subtract_gram(panels, parity.rows, n, c, pitch);
  const int failed = factor_upper(c, n, pitch, panels);
  if (failed < 0) invert_upper(c, n, pitch, panels);
  return failed;
}

}  // namespace

#define PLIANT_JOIN_(a, b) a##b
#define PLIANT_JOIN(a, b) PLIANT_JOIN_(a, b)

const SpectralKernels PLIANT_JOIN(PLIANT_KERNELS, _kernels) = {
    PLIANT_KERNELS_NAME, lanes, sine_transform, in_across, in_along,   out_along,
    out_across,          start, step,           last_step, invert_edge};

}  // namespace pliant
