#include "pliant/plate/sine_plan.hpp"

#include <algorithm>
#include <numbers>

#include "pliant/core/elementary.hpp"
#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// The radices of the stages for a length, or none where it has a prime above 13.
std::vector<int> radices_of(int length) {
  std::vector<int> radices;
  for (const int radix : {4, 2, 3, 5, 7, 11, 13}) {
    for (; length % radix == 0; length /= radix) radices.push_back(radix);
  }
  if (length > 1) return {};
  return radices;
}

// Whether a Fourier transform of this length goes by stages.
bool is_smooth(int length) { return length == 1 || !radices_of(length).empty(); }

// The least length from `least` on with no prime above 5.
int smooth_from(int least) {
  for (int length = least;; ++length) {
    int rest = length;
    for (const int prime : {2, 3, 5}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return length;
  }
}

std::vector<double> stage_tables(int length, const std::vector<int>& radices) {
  std::vector<double> tables;
  const auto add = [&](long numerator, long denominator) {
    const TurnPoint point = turn_point(numerator, denominator);
    tables.push_back(point.cosine);
    tables.push_back(point.sine);
  };
  long n = length;
  for (const int radix : radices) {
    const long m = n / radix;
    if (radix % 2 == 1) {
      for (int j = 1; j <= (radix - 1) / 2; ++j) add(j, radix);
    }
    for (long p = 1; p < m; ++p) {
      for (int j = 1; j < radix; ++j) add(p * j, n);
    }
    n = m;
  }
  return tables;
}

// A plain transform of one column, for the convolution's kernel: sum over j of x_j exp(-i 2 pi
// jk/n).
std::vector<double> transformed(const std::vector<double>& x, const std::vector<int>& radices) {
  // By the same stages as the kernels, on single numbers: decimation in frequency, self-sorting.
  const long length = static_cast<long>(x.size()) / 2;
  std::vector<double> from = x, to(x.size());
  long n = length, stride = 1;
  for (const int radix : radices) {
    const long m = n / radix;
    std::vector<TurnPoint> roots;
    for (int j = 0; j < radix; ++j) roots.push_back(turn_point(j, radix));
    for (long p = 0; p < m; ++p) {
      for (int k = 0; k < radix; ++k) {
        const TurnPoint twiddle = turn_point(p * k, n);
        for (long q = 0; q < stride; ++q) {
          double re = 0, im = 0;
          for (int j = 0; j < radix; ++j) {
            const TurnPoint& root = roots[static_cast<std::size_t>(j * k % radix)];
            const double* const a = &from[2 * (q + stride * (p + m * j))];
            re += a[0] * root.cosine + a[1] * root.sine;
            im += a[1] * root.cosine - a[0] * root.sine;
          }
          double* const b = &to[2 * (q + stride * (radix * p + k))];
          b[0] = re * twiddle.cosine + im * twiddle.sine;
          b[1] = im * twiddle.cosine - re * twiddle.sine;
        }
      }
    }
    from.swap(to);
    n = m;
    stride *= radix;
  }
  return from;
}

}  // namespace

TurnPoint turn_point(long numerator, long denominator) {
  // 8 numerator = eighth * denominator + rest: the angle is that many eighths of a turn and rest/(8
  // denominator) of one, which is taken from the nearer end of the eighth's quarter.
  const long eighths = 8 * (numerator % denominator);
  const long eighth = eighths / denominator;
  const long rest = eighths % denominator;
  const bool is_down = eighth % 2 == 1;  // taken from the eighth's end, backwards
  const double angle = static_cast<double>(is_down ? denominator - rest : rest) *
                       (std::numbers::pi / 4) / static_cast<double>(denominator);
  const double x = cos_of(angle);
  const double y = sin_of(angle);
  switch (eighth) {
    case 0:
      return {x, y};
    case 1:
      return {y, x};
    case 2:
      return {-y, x};
    case 3:
      return {-x, y};
    case 4:
      return {-x, -y};
    case 5:
      return {-y, -x};
    case 6:
      return {y, -x};
    default:
      return {x, -y};
  }
}

SinePlan::SinePlan(int length) : length_(length), fourier_length_(length) {
  PLIANT_EXPECTS(length >= 2);
  for (int j = 0; j <= length / 2; ++j) {
    const TurnPoint point = turn_point(j, 2L * length);
    fold_.push_back(point.cosine);
    fold_.push_back(point.sine);
  }
  if (!is_smooth(length)) {
    // Inputs 0 ... L-1, outputs 0 ... L/2: a circular convolution from here on does not overlap.
    fourier_length_ = smooth_from(length + length / 2);
  }
  radices_ = radices_of(fourier_length_);
  tables_ = stage_tables(fourier_length_, radices_);
  if (fourier_length_ != length) make_chirp();
}

// Bluestein: jk = (j^2 + k^2 - (k-j)^2)/2, so that with c_j = exp(-i pi j^2/L)
//   sum over j of x_j exp(-i 2 pi jk/L) = c_k (sum over j of (c_j x_j) conj(c_{k-j})).
void SinePlan::make_chirp() {
  const auto point_of = [&](long j) { return turn_point(j * j % (2L * length_), 2L * length_); };
  std::vector<double> kernel(2 * static_cast<std::size_t>(fourier_length_), 0.0);
  const auto set = [&](int place, const TurnPoint& point) {
    // Over the length, for the way back.
    kernel[2 * static_cast<std::size_t>(place)] = point.cosine / fourier_length_;
    kernel[2 * static_cast<std::size_t>(place) + 1] = point.sine / fourier_length_;
  };
  for (int j = 0; j < length_; ++j) {
    const TurnPoint point = point_of(j);
    chirp_.push_back(point.cosine);
    chirp_.push_back(point.sine);
    if (j <= length_ / 2) set(j, point);
    if (j > 0) set(fourier_length_ - j, point);
  }
  kernel_ = transformed(kernel, radices_);
}

SineView SinePlan::view() const {
  return {length_,
          fold_.data(),
          {fourier_length_, static_cast<int>(radices_.size()), radices_.data(), tables_.data()},
          chirp_.empty() ? nullptr : chirp_.data(),
          chirp_.empty() ? nullptr : kernel_.data()};
}

std::size_t SinePlan::table_size(int length) {
  // Fold L, the convolution's length up to 2 L or so: stages twice that, chirp and kernel.
  return 16 * static_cast<std::size_t>(length) + 256;
}

}  // namespace pliant
