// Vectors of PLIANT_LANES doubles, and the sine transform of PLIANT_LANES columns: the first part
// of the kernels, included once by each file that compiles them. No #pragma once, no other header:
// see kernels.hpp.

namespace pliant {
namespace {

constexpr int lanes = PLIANT_LANES;

// The compiler's vector extension: element-wise arithmetic. In memory they need not be aligned.
using Lanes __attribute__((vector_size(8 * PLIANT_LANES))) = double;
using LanesAt __attribute__((vector_size(8 * PLIANT_LANES), aligned(8), may_alias)) = double;

#define PLIANT_INLINED __attribute__((always_inline))  // after a lambda's parameters
#define PLIANT_INLINE PLIANT_INLINED inline

PLIANT_INLINE Lanes load(const double* from) { return *reinterpret_cast<const LanesAt*>(from); }
PLIANT_INLINE void store(double* to, Lanes x) { *reinterpret_cast<LanesAt*>(to) = x; }

// One complex number per lane; in memory all real parts, then all imaginary parts.
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
// a (cosine - i sine): forward transforms rotate clockwise.
PLIANT_INLINE Complex turned(const Complex& a, double cosine, double sine) {
  return {a.re * cosine + a.im * sine, a.im * cosine - a.re * sine};
}

// The transform of R points; if R is odd, `roots` has cos and sin of 2 pi j/R for j = 1 ...
// (R-1)/2.
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
  } else if constexpr (R == 8) {
    constexpr double root = 0.70710678118654752440;  // of 1/2
    Complex even[4], odd[4];
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      even[j] = x[j] + x[j + 4];
      odd[j] = x[j] - x[j + 4];
    }
    odd[1] = {(odd[1].re + odd[1].im) * root, (odd[1].im - odd[1].re) * root};
    odd[2] = times_minus_i(odd[2]);
    odd[3] = {(odd[3].im - odd[3].re) * root, (odd[3].re + odd[3].im) * -root};
    butterfly<4>(even, roots);
    butterfly<4>(odd, roots);
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      x[2 * j] = even[j];
      x[2 * j + 1] = odd[j];
    }
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

// Calls work.operator()<R>() for a stage's radix.
template <class Work>
PLIANT_INLINE void with_radix(int radix, const Work& work) {
  switch (radix) {
    case 2:
      return work.template operator()<2>();
    case 3:
      return work.template operator()<3>();
    case 4:
      return work.template operator()<4>();
    case 5:
      return work.template operator()<5>();
    case 7:
      return work.template operator()<7>();
    case 8:
      return work.template operator()<8>();
    case 11:
      return work.template operator()<11>();
    default:
      return work.template operator()<13>();
  }
}

// The remaining stages of a transform, on blocks of n = radix m points.
struct Stages {
  int count;
  const int* radices;
  const double* tables;
  int n;

  int radix() const { return radices[0]; }
  int m() const { return n / radices[0]; }
  Stages next() const {
    const int others = radix() - 1;
    const long size = (radix() % 2 == 1 ? others : 0) + 2L * others * (m() - 1);
    return {count - 1, radices + 1, tables + size, m()};
  }
};

PLIANT_INLINE Stages stages_of(const FourierView& view) {
  return {view.stage_count, view.radices, view.tables, view.length};
}

PLIANT_INLINE double* point(double* points, int k) {
  return points + static_cast<long>(k) * complex_size;
}

// One stage in place, decimation in frequency: after all stages the value of a wave number is at
// the index with its digits reversed. `take(k)` returns input point k.
template <int R, class Take>
void split(int m, const double* tables, double* points, Take take) {
  const double* const roots = tables;
  if (R % 2 == 1) tables += R - 1;
  for (int p = 0; p < m; ++p) {
    Complex x[R];
#pragma GCC unroll 16
    for (int j = 0; j < R; ++j) x[j] = take(p + j * m);
    butterfly<R>(x, roots);
    store_complex(point(points, p), x[0]);
#pragma GCC unroll 16
    for (int j = 1; j < R; ++j) {
      // For p = 0 there is no rotation.
      const Complex y = p == 0 ? x[j] : turned(x[j], tables[2 * (j - 1)], tables[2 * (j - 1) + 1]);
      store_complex(point(points, p + j * m), y);
    }
    if (p > 0) tables += 2 * (R - 1);
  }
}
template <class Take>
PLIANT_INLINE void split(const Stages& stages, double* points, const Take& take) {
  with_radix(stages.radix(), [&]<int R>() { split<R>(stages.m(), stages.tables, points, take); });
}

// The same stage transposed, decimation in time: all stages, the last one first, restore plain
// order from the order of reversed digits. `give(k, x)` receives output point k.
template <int R, class Give>
void merge(int m, const double* tables, double* points, Give give) {
  const double* const roots = tables;
  if (R % 2 == 1) tables += R - 1;
  for (int p = 0; p < m; ++p) {
    Complex x[R];
    x[0] = load_complex(point(points, p));
#pragma GCC unroll 16
    for (int j = 1; j < R; ++j) {
      const Complex y = load_complex(point(points, p + j * m));
      x[j] = p == 0 ? y : turned(y, tables[2 * (j - 1)], tables[2 * (j - 1) + 1]);
    }
    butterfly<R>(x, roots);
#pragma GCC unroll 16
    for (int j = 0; j < R; ++j) give(p + j * m, x[j]);
    if (p > 0) tables += 2 * (R - 1);
  }
}
template <class Give>
PLIANT_INLINE void merge(const Stages& stages, double* points, const Give& give) {
  with_radix(stages.radix(), [&]<int R>() { merge<R>(stages.m(), stages.tables, points, give); });
}

// The same for `blocks` blocks one after another, and the inverse.
void split_in_place(const Stages& stages, int blocks, double* points) {
  with_radix(stages.radix(), [&]<int R>() {
    const int m = stages.m();
    for (int block = 0; block < blocks; ++block) {
      double* const begin = point(points, block * R * m);
      split<R>(m, stages.tables, begin,
               [=](int k) PLIANT_INLINED { return load_complex(point(begin, k)); });
    }
  });
}
void merge_in_place(const Stages& stages, int blocks, double* points) {
  with_radix(stages.radix(), [&]<int R>() {
    const int m = stages.m();
    for (int block = 0; block < blocks; ++block) {
      double* const begin = point(points, block * R * m);
      merge<R>(m, stages.tables, begin,
               [=](int k, const Complex& x) PLIANT_INLINED { store_complex(point(begin, k), x); });
    }
  });
}

// Whether the blocks are small enough to pass one stage together and still be in cache for the
// next; otherwise each passes all stages by itself.
PLIANT_INLINE bool are_near(const Stages& stages, int blocks) {
  constexpr int near_points = 2048 / complex_size;  // 16 kB
  return blocks == 1 || blocks * stages.n <= near_points;
}

// The remaining stages of a transform, for `blocks` blocks.
void transform(const Stages& stages, int blocks, double* points) {
  if (stages.count == 0) return;
  if (are_near(stages, blocks)) {
    split_in_place(stages, blocks, points);
    return transform(stages.next(), blocks * stages.radix(), points);
  }
  for (int block = 0; block < blocks; ++block) {
    transform(stages, 1, point(points, block * stages.n));
  }
}

// The last forward stage, the product with the kernel's transform, and the first inverse stage.
template <int R>
void multiply(int blocks, const double* roots, const double* kernel, double* points) {
  for (int block = 0; block < blocks; ++block) {
    Complex x[R];
#pragma GCC unroll 16
    for (int j = 0; j < R; ++j) x[j] = load_complex(point(points, j));
    butterfly<R>(x, roots);
#pragma GCC unroll 16
    for (int j = 0; j < R; ++j) {
      const Complex y = turned(x[j], kernel[2 * j], -kernel[2 * j + 1]);
      x[j] = {y.im, y.re};  // real and imaginary part exchanged: inverse transform
    }
    butterfly<R>(x, roots);
#pragma GCC unroll 16
    for (int j = 0; j < R; ++j) store_complex(point(points, j), x[j]);
    kernel += 2 * R;
    points = point(points, R);
  }
}

// These forward stages, the product, and the inverse stages; the result has its real and imaginary
// parts exchanged.
void convolve(const Stages& stages, int blocks, const double* kernel, double* points) {
  if (stages.count == 1) {
    return with_radix(stages.radix(),
                      [&]<int R>() { multiply<R>(blocks, stages.tables, kernel, points); });
  }
  if (are_near(stages, blocks)) {
    split_in_place(stages, blocks, points);
    convolve(stages.next(), blocks * stages.radix(), kernel, points);
    return merge_in_place(stages, blocks, points);
  }
  for (int block = 0; block < blocks; ++block) {
    convolve(stages, 1, kernel + 2L * block * stages.n, point(points, block * stages.n));
  }
}

// The circular convolution of the points from `take` with a kernel; `give` receives the result with
// real and imaginary parts exchanged.
template <class Take, class Give>
PLIANT_INLINE void convolve(const SineView& view, double* work, const Take& take,
                            const Give& give) {
  const Stages stages = stages_of(view.fourier);
  split(stages, work, take);
  convolve(stages.next(), stages.radix(), view.kernel, work);
  merge(stages, work, give);
}

// Point k of a tile, counted from 1.
PLIANT_INLINE double* row(double* points, int k) {
  return points + static_cast<long>(k - 1) * lanes;
}

PLIANT_INLINE Complex turned_by(const double* turns, int k, const Complex& x) {
  return turned(x, turns[2 * k], turns[2 * k + 1]);
}

// Eq. (29): the input of the Fourier transform at point j, and the output at wave number k.
PLIANT_INLINE Complex folded(const double* fold, int length, double* points, int j) {
  if (j == 0) return Complex{};
  const Lanes x = load(row(points, j));
  const Lanes mirrored = load(row(points, length - j));
  const Lanes sum = x + mirrored;
  return {sum * fold[2 * j], (x - mirrored) - sum * fold[2 * j + 1]};
}
PLIANT_INLINE void unfold(const Complex& x, int length, double* points, int k) {
  if (k > 0) store(row(points, 2 * k), 0.5 * x.re);
  if (2 * k + 1 < length) store(row(points, 2 * k + 1), -0.5 * x.im);
}

void by_stages(const SineView& view, double* points, double* work) {
  const int length = view.length;
  const double* const fold = view.fold;
  const int* const places = view.places;
  const Stages stages = stages_of(view.fourier);
  split(stages, work, [=](int j) PLIANT_INLINED { return folded(fold, length, points, j); });
  transform(stages.next(), stages.radix(), work);
  for (int k = 0; 2 * k < length; ++k) {
    unfold(load_complex(point(work, places[k])), length, points, k);
  }
}

// Eq. (29a): the real input of the Fourier transform.
PLIANT_INLINE Lanes paired(const double* fold, int length, double* points, int j) {
  const Lanes x = load(row(points, j));
  const Lanes mirrored = load(row(points, length - j));
  return (x + mirrored) * fold[2 * j + 1] + 0.5 * (x - mirrored);
}

// Two real inputs at once, the second one as the imaginary part of the first.
void sine_transform_pair(const SineView& view, double* points, double* others, double* work) {
  const int length = view.length;
  const double* const fold = view.fold;
  const Stages stages = stages_of(view.fourier);
  split(stages, work, [=](int j) PLIANT_INLINED {
    if (j == 0) return Complex{};
    return Complex{paired(fold, length, points, j), paired(fold, length, others, j)};
  });
  transform(stages.next(), stages.radix(), work);
  const Complex first = load_complex(point(work, 0));
  Lanes odd = 0.5 * first.re, other_odd = 0.5 * first.im;
  store(row(points, 1), odd);
  store(row(others, 1), other_odd);
  for (int k = 1; 2 * k < length; ++k) {
    const Complex x = load_complex(point(work, view.places[k]));
    const Complex mirrored = load_complex(point(work, view.places[length - k]));
    store(row(points, 2 * k), 0.5 * (mirrored.im - x.im));
    store(row(others, 2 * k), 0.5 * (x.re - mirrored.re));
    if (2 * k + 1 == length) break;
    odd = odd + 0.5 * (x.re + mirrored.re);
    other_odd = other_odd + 0.5 * (x.im + mirrored.im);
    store(row(points, 2 * k + 1), odd);
    store(row(others, 2 * k + 1), other_odd);
  }
}

// The Fourier transform by a convolution with a chirp (Bluestein).
void by_chirp(const SineView& view, double* points, double* work) {
  const int length = view.length;
  const double* const fold = view.fold;
  const double* const chirp = view.chirp;
  convolve(
      view, work,
      [=](int j) PLIANT_INLINED {
        return j < length ? turned_by(chirp, j, folded(fold, length, points, j)) : Complex{};
      },
      [=](int k, const Complex& x) PLIANT_INLINED {
        if (2 * k < length) unfold(turned_by(chirp, k, {x.im, x.re}), length, points, k);
      });
}

// Eq. (30) to (32).
void by_powers(const SineView& view, double* points, double* work) {
  const int length = view.length;
  const int half = (length - 1) / 2;
  const PairsView in = view.in;
  const PairsView out = view.out;
  convolve(
      view, work,
      [=](int a) PLIANT_INLINED {
        if (a >= half) return Complex{};
        const int n = in.evens[a];
        return turned_by(in.turns, a, {load(row(points, n)), load(row(points, length - n))});
      },
      [=](int b, const Complex& x) PLIANT_INLINED {
        if (b >= half) return;
        const int k = out.evens[b];
        const Complex y = turned_by(out.turns, b, x);
        store(row(points, k), y.re);
        store(row(points, length - k), y.im);
      });
}

void sine_transform(const SineView& view, double* points, double* work) {
  if (view.in.evens) return by_powers(view, points, work);
  if (view.chirp) return by_chirp(view, points, work);
  by_stages(view, points, work);
}

}  // namespace
}  // namespace pliant
