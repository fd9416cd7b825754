#include "pliant/plate/spectral/sine_plan.hpp"

#include <numbers>
#include <utility>

#include "pliant/core/elementary.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/plate/spectral/primes.hpp"

namespace pliant {
namespace {

// The radices of the stages for a length; empty if it has a prime above 13.
std::vector<int> radices_of(int length) {
  std::vector<int> radices;
  for (const int radix : {4, 2, 3, 5, 7, 11, 13}) {
    for (; length % radix == 0; length /= radix) radices.push_back(radix);
  }
  if (length > 1) return {};
  return radices;
}

// The radices for a convolution: eights first, and no 2 in the last stage if possible, since that
// stage runs forward and inverse at once.
std::vector<int> convolution_radices(int length) {
  std::vector<int> radices;
  for (; length % 8 == 0; length /= 8) radices.push_back(8);
  const bool has_four = length % 4 == 0;
  if (has_four) length /= 4;
  for (const int radix : {2, 3, 5, 7, 11, 13}) {
    for (; length % radix == 0; length /= radix) radices.push_back(radix);
  }
  if (has_four) radices.push_back(4);
  if (length > 1) return {};
  return radices;
}

// Estimated cost per point of the stages of a convolution, from measurements; 0 if the length has a
// prime above 5. A stage of 4 or 8 counts as two or three of 2.
long cost_of_point(int length) {
  long cost = 0;
  for (const auto& [prime, share] : {std::pair{2, 4}, {3, 9}, {5, 13}}) {
    for (; length % prime == 0; length /= prime) cost += share;
  }
  return length == 1 ? cost : 0;
}

// The cheapest length of a convolution from `least` on: a multiple of 8, with no prime above 5, and
// no longer than the next power of 2.
int convolution_length(int least) {
  int best = 8;
  while (best < least) best *= 2;
  for (int length = best - 8; length >= least; length -= 8) {
    const long cost = cost_of_point(length);
    if (cost > 0 && cost * length <= cost_of_point(best) * best) best = length;
  }
  return best;
}

std::vector<double> stage_tables(int length, const std::vector<int>& radices) {
  std::vector<double> tables;
  tables.reserve(2 * static_cast<std::size_t>(length));
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

// The kernel of a convolution, transformed in the same stages as in the kernels of the solver:
// decimation in frequency in place, exp(-i 2 pi jk/n).
std::vector<double> transformed(std::vector<double> x, const std::vector<int>& radices) {
  const std::size_t length = x.size() / 2;
  std::size_t n = length;
  for (const int radix : radices) {
    const std::size_t m = n / radix;
    std::vector<TurnPoint> roots;
    for (int j = 0; j < radix; ++j) roots.push_back(turn_point(j, radix));
    std::vector<double> points(2 * roots.size());
    for (std::size_t p = 0; p < m; ++p) {
      std::vector<TurnPoint> turns;
      for (int k = 0; k < radix; ++k) turns.push_back(turn_point(static_cast<long>(p) * k, n));
      for (std::size_t begin = p; begin < length; begin += n) {
        for (int k = 0; k < radix; ++k) {
          double re = 0, im = 0;
          for (int j = 0; j < radix; ++j) {
            const TurnPoint& root = roots[static_cast<std::size_t>(j * k % radix)];
            const double* const a = &x[2 * (begin + m * j)];
            re += a[0] * root.cosine + a[1] * root.sine;
            im += a[1] * root.cosine - a[0] * root.sine;
          }
          points[2 * k] = re * turns[k].cosine + im * turns[k].sine;
          points[2 * k + 1] = im * turns[k].cosine - re * turns[k].sine;
        }
        for (int k = 0; k < radix; ++k) {
          x[2 * (begin + m * k)] = points[2 * k];
          x[2 * (begin + m * k) + 1] = points[2 * k + 1];
        }
      }
    }
    n = m;
  }
  return x;
}

}  // namespace

TurnPoint turn_point(long numerator, long denominator) {
  // 8 numerator = eighth * denominator + rest: the angle is `eighth` eighths of a turn and rest/(8
  // denominator) of a turn, measured from the nearer end of the eighth's quarter.
  const long eighths = 8 * (numerator % denominator);
  const long eighth = eighths / denominator;
  const long rest = eighths % denominator;
  const bool is_down = eighth % 2 == 1;  // measured backwards from the end of the eighth
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

SinePlan::SinePlan(int length) : length_(length) {
  PLIANT_EXPECTS(length >= 2);
  if (auto radices = radices_of(length); !radices.empty()) {
    set_stages(length, std::move(radices));
    make_fold();
    make_places();
  } else if (is_prime(length)) {
    make_powers();
  } else {
    make_fold();
    make_chirp();
  }
}

void SinePlan::set_stages(int length, std::vector<int> radices) {
  fourier_length_ = length;
  tables_ = stage_tables(length, radices);
  radices_ = std::move(radices);
}

void SinePlan::make_fold() {
  fold_.reserve(2 * static_cast<std::size_t>(length_));
  for (int j = 0; j < length_; ++j) {
    // Exactly symmetric, to the last bit.
    const bool is_beyond = 2 * j > length_;
    const TurnPoint point = turn_point(is_beyond ? length_ - j : j, 2L * length_);
    fold_.push_back(is_beyond ? -point.cosine : point.cosine);
    fold_.push_back(point.sine);
  }
}

// The index of wave number k has the digits of k in reverse order.
void SinePlan::make_places() {
  places_.reserve(static_cast<std::size_t>(length_));
  for (int k = 0; k < length_; ++k) {
    int place = 0;
    int rest = k;
    int m = length_;
    for (const int radix : radices_) {
      m /= radix;
      place += rest % radix * m;
      rest /= radix;
    }
    places_.push_back(place);
  }
}

// Bluestein: jk = (j^2 + k^2 - (k-j)^2)/2, so that with c_j = exp(-i pi j^2/L)
//   sum over j of x_j exp(-i 2 pi jk/L) = c_k (sum over j of (c_j x_j) conj(c_{k-j})).
void SinePlan::make_chirp() {
  // Inputs 0 ... L-1, outputs 0 ... L/2: from this length on a circular convolution does not
  // overlap.
  const int whole = convolution_length(length_ + length_ / 2);
  set_stages(whole, convolution_radices(whole));
  const auto point_of = [&](long j) { return turn_point(j * j % (2L * length_), 2L * length_); };
  std::vector<double> kernel(2 * static_cast<std::size_t>(whole), 0.0);
  const auto set = [&](int place, const TurnPoint& point) {
    // Divided by the length, for the inverse transform.
    kernel[2 * static_cast<std::size_t>(place)] = point.cosine / whole;
    kernel[2 * static_cast<std::size_t>(place) + 1] = point.sine / whole;
  };
  chirp_.reserve(2 * static_cast<std::size_t>(length_));
  for (int j = 0; j < length_; ++j) {
    const TurnPoint point = point_of(j);
    chirp_.push_back(point.cosine);
    chirp_.push_back(point.sine);
    if (j <= length_ / 2) set(j, point);
    if (j > 0) set(whole - j, point);
  }
  kernel_ = transformed(std::move(kernel), radices_);
}

// Rader: docs/model.md, eq. (30) to (32), with the same letters.
void SinePlan::make_powers() {
  const int L = length_;
  const int h = (L - 1) / 2;
  // A single stage is too few: the first stage reads and writes the points, the last one
  // multiplies.
  std::vector<int> radices = convolution_radices(h);
  const bool is_turned = radices.size() >= 2;
  const int whole = is_turned ? h : convolution_length(2 * h - 1);
  set_stages(whole, is_turned ? std::move(radices) : convolution_radices(whole));

  const auto turn_of = [&](int c) { return is_turned ? turn_point(c, 2L * h) : TurnPoint(); };
  std::vector<double> kernel(2 * static_cast<std::size_t>(whole), 0.0);
  const auto set = [&](int place, long power, const TurnPoint& turn) {
    const long halved = power * ((L + 1) / 2) % L;
    const double sine = turn_point(halved, L).sine / whole;  // over the length, for the inverse
    kernel[2 * static_cast<std::size_t>(place)] = sine * turn.cosine;
    kernel[2 * static_cast<std::size_t>(place) + 1] = -sine * turn.sine;
  };
  const auto reserve = [&](auto& numbers, int count) { numbers.reserve(std::size_t(count)); };
  for (auto* const evens : {&in_evens_, &out_evens_}) reserve(*evens, h);
  for (auto* const turns : {&in_turns_, &out_turns_}) reserve(*turns, 2 * h);

  const long root = primitive_root(L);
  const long inverse = power_modulo(root, L - 2, L);
  long there = 1, back = 1;  // root^c and root^-c
  for (int c = 0; c < h; ++c) {
    const TurnPoint turn = turn_of(c);
    const int in_sign = back % 2 == 0 ? 1 : -1;
    in_evens_.push_back(static_cast<int>(back % 2 == 0 ? back : L - back));
    in_turns_.push_back(in_sign * turn.cosine);
    in_turns_.push_back(in_sign * turn.sine);
    // -(1 + i) exp(-i pi c/h): the convolution's result is i times the conjugate of eq. (32)'s.
    const int out_sign = there % 2 == 0 ? 1 : -1;
    out_evens_.push_back(static_cast<int>(there % 2 == 0 ? there : L - there));
    out_turns_.push_back(-out_sign * (turn.cosine + turn.sine));
    out_turns_.push_back(out_sign * (turn.cosine - turn.sine));
    set(c, there, turn);
    if (!is_turned && c > 0) set(whole - c, back, turn);
    there = there * root % L;
    back = back * inverse % L;
  }
  kernel_ = transformed(std::move(kernel), radices_);
}

SineView SinePlan::view() const {
  const auto start = [](const auto& numbers) { return numbers.empty() ? nullptr : numbers.data(); };
  return {length_,
          {fourier_length_, static_cast<int>(radices_.size()), radices_.data(), tables_.data()},
          start(fold_),
          start(places_),
          start(chirp_),
          {start(in_evens_), start(in_turns_)},
          {start(out_evens_), start(out_turns_)},
          start(kernel_)};
}

std::size_t SinePlan::size() const {
  std::size_t doubles = 0;
  for (const auto* const numbers : {&tables_, &fold_, &chirp_, &in_turns_, &out_turns_, &kernel_}) {
    doubles += numbers->capacity();
  }
  for (const auto* const numbers : {&radices_, &places_, &in_evens_, &out_evens_}) {
    doubles += (numbers->capacity() + 1) / 2;  // integers of half the size
  }
  return doubles;
}

std::size_t SinePlan::most_size(int length) {
  // Fold and chirp 2 L each; a convolution of up to 3 L points: stages and kernel twice that each.
  return 16 * static_cast<std::size_t>(length) + 256;
}

}  // namespace pliant
