// Vectors of PLIANT_LANES doubles and the sine transform of as many columns: the first part of the
// kernels, included once by each file that compiles them.
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

}  // namespace
}  // namespace pliant
