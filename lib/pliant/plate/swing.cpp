#include "pliant/plate/swing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {
namespace {

using StdComplex = std::complex<double>;

// The roots s of rho s^2 + eta s + lambda = 0, the slower one first; without inertia the second is
// minus infinity. Eq. (38). The larger one of two real roots is computed from their product to
// avoid cancellation.
struct Roots {
  StdComplex slow;
  StdComplex fast;
};

constexpr double infinite = std::numeric_limits<double>::infinity();

Roots roots_of(double lambda, const Dynamics& dynamics) {
  const auto& [rho, eta] = dynamics;
  if (rho == 0) return {eta > 0 ? -lambda / eta : -infinite, -infinite};
  const double half = eta / (2 * rho);
  const double square = half * half - lambda / rho;
  if (square < 0) return {{-half, std::sqrt(-square)}, {-half, -std::sqrt(-square)}};
  const double fast = -(half + std::sqrt(square));
  return {lambda / (rho * fast), fast};
}

// The rate of a root as seen from frame to frame: eq. (39) [1/s].
StdComplex seen(const StdComplex& root, const TimeSteps& steps, double frame_length) {
  if (std::isinf(root.real())) return -infinite;
  if (steps.are_exact()) return root * (steps.length / frame_length);
  const StdComplex half = root * steps.solved_length();
  const double count = steps.count;
  if (!steps.are_reflected()) return -count * std::log(1.0 - half) / frame_length;
  if (half.imag() != 0) {
    return count * (std::log(1.0 + half) - std::log(1.0 - half)) / frame_length;
  }
  // A motion that is faster than the steps changes its sign in each of them.
  const double step = (1 + half.real()) / (1 - half.real());
  const bool alternates = step < 0 && steps.count % 2 == 1;
  return StdComplex(count * std::log(std::abs(step)), alternates ? std::numbers::pi : 0) /
         frame_length;
}

// Eq. (40).
Swing swing_of(const StdComplex& slow, const StdComplex& fast) {
  if (std::isinf(fast.real())) return {0, infinite};
  if (slow.imag() != -fast.imag()) {  // one alternates: what lasts longer is seen
    const StdComplex& seen = slow.real() >= fast.real() ? slow : fast;
    return {std::abs(seen.imag()) / (2 * std::numbers::pi), -seen.real() / std::abs(seen)};
  }
  const double omega = std::sqrt((slow * fast).real());
  return {std::abs(slow.imag()) / (2 * std::numbers::pi), 0 - (slow + fast).real() / (2 * omega)};
}

// e of eq. (41): the deviation of a mode from its final value, frame by frame, relative to the
// displacement under the load: (q, q one step earlier); reflected, (q, velocity times half a step);
// exact, (q, velocity times the frame).
class Deviation {
 public:
  Deviation(double lambda, const Dynamics& dynamics, const TimeSteps& steps) {
    if (steps.are_exact()) {
      frame_ = exactly(lambda, dynamics, steps.length);
      before_ = 0;
      return;
    }
    const double h = steps.solved_length();
    const double inertia = dynamics.density, drag = dynamics.damping * h;
    const double whole = inertia + drag + lambda * h * h;
    Matrix power = {(2 * inertia + drag) / whole, -inertia / whole, 1, 0};
    if (steps.are_reflected()) {
      const double kept = (inertia + drag) / whole, pushed = inertia / whole;
      power = {2 * kept - 1, 2 * pushed, 2 * kept - 2, 2 * pushed - 1};
      before_ = 0;
    }
    for (int left = steps.count; left > 0; left /= 2) {
      if (left % 2 == 1) frame_ = product(power, frame_);
      power = product(power, power);
    }
  }

  double now() const { return now_; }
  void advance() {
    const double next = frame_[0] * now_ + frame_[1] * before_;
    before_ = frame_[2] * now_ + frame_[3] * before_;
    now_ = next;
  }

 private:
  using Matrix = std::array<double, 4>;

  // e^(T A), from the roots x of x^2 + (eta T/rho) x + lambda T^2/rho = 0, half their sum and half
  // their difference.
  static Matrix exactly(double lambda, const Dynamics& dynamics, double interval) {
    const Roots roots = roots_of(lambda, dynamics);
    const StdComplex slow = roots.slow * interval, fast = roots.fast * interval;
    if (std::isinf(fast.real())) {
      const double kept = std::isinf(slow.real()) ? 0 : std::exp(slow.real());
      return {kept, 0, 0, 0};
    }
    const StdComplex apart = slow - fast;
    // (e^slow - e^fast)/(slow - fast)
    const StdComplex of_slow = std::exp(slow), of_fast = std::exp(fast);
    const double slope =
        std::abs(apart) < 1e-6 ? of_slow.real() : ((of_slow - of_fast) / apart).real();
    const double kept = (of_slow - slow * slope).real();
    return {kept, slope, -(slow * fast).real() * slope, kept + (slow + fast).real() * slope};
  }

  static Matrix product(const Matrix& a, const Matrix& b) {
    return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
            a[2] * b[1] + a[3] * b[3]};
  }

  Matrix frame_ = {1, 0, 0, 1};
  double now_ = 1, before_ = 1;  // at rest, away from its final value; reflected, 1 and 0
};

// The share up to which modes do not matter: together they are a hundredth of `part`. Fast modes
// ring on for long in reflected steps.
double least_share(std::span<const ExcitedMode> modes, double part) {
  std::vector<double> shares;
  for (const ExcitedMode& mode : modes) shares.push_back(std::abs(mode.share));
  std::sort(shares.begin(), shares.end());
  double least = 0, sum = 0;
  for (const double share : shares) {
    sum += share;
    if (sum > 0.01 * part) break;
    least = share;
  }
  return least;
}

}  // namespace

Swing natural_swing(double lambda, const Dynamics& dynamics) {
  PLIANT_EXPECTS(lambda > 0);
  const auto& [rho, eta] = dynamics;
  if (rho == 0) return {0, infinite};
  return {std::sqrt(lambda / rho) / (2 * std::numbers::pi), eta / (2 * std::sqrt(lambda * rho))};
}

Dynamics damped_by_ratio(const Dynamics& dynamics, double ratio, double lambda) {
  PLIANT_EXPECTS(lambda >= 0 && ratio >= 0);
  const double rho = dynamics.density;
  return {rho, 2 * ratio * (std::sqrt(lambda) * std::sqrt(rho))};
}

Swing stepped_swing(double lambda, const Dynamics& dynamics, const TimeSteps& steps,
                    double frame_length) {
  PLIANT_EXPECTS(lambda > 0 && frame_length > 0);
  const Roots roots = roots_of(lambda, dynamics);
  return swing_of(seen(roots.slow, steps, frame_length), seen(roots.fast, steps, frame_length));
}

Settling settling_of(std::span<const ExcitedMode> modes, const Dynamics& dynamics,
                     const TimeSteps& steps, double frame_length, double part) {
  PLIANT_EXPECTS(!modes.empty() && part > 0 && part < 1 && frame_length > 0);
  double shares = 0, slowest = infinite;  // [1/s]
  const double least = least_share(modes, part);
  for (const ExcitedMode& mode : modes) {
    shares += std::abs(mode.share);
    const auto [slow, fast] = roots_of(mode.lambda, dynamics);
    // The faster root decays more slowly if it is much faster than reflected steps.
    const double rate =
        -std::max(seen(slow, steps, frame_length).real(), seen(fast, steps, frame_length).real()) *
        frame_length;
    if (std::abs(mode.share) > least) slowest = std::min(slowest, rate);
  }
  // What is not damped, and steps that keep energy.
  if (!(slowest > 1e-12)) return {infinite, 1'000'000'000, false};
  // Envelopes: after twice the time that the slowest one needs, all have decayed, even near a
  // double root, where a mode lasts a little longer than its rate suggests.
  const double envelope = std::log(std::max(1.0, shares) / part) / slowest;
  constexpr double most_frames = 100'000;
  if (2 * envelope + 10 > most_frames) {
    return {envelope * frame_length, static_cast<int>(std::min(std::ceil(envelope), 1e9)), false};
  }
  std::vector<Deviation> deviations;
  for (const ExcitedMode& mode : modes) deviations.emplace_back(mode.lambda, dynamics, steps);
  const auto deviation_now = [&] {
    double sum = 0;
    for (std::size_t k = 0; k < modes.size(); ++k) sum += modes[k].share * deviations[k].now();
    return sum;
  };
  Settling settling;
  double before = deviation_now();
  for (int frame = 1; frame <= 2 * envelope + 10; ++frame) {
    for (Deviation& deviation : deviations) deviation.advance();
    const double now = deviation_now();
    if (std::abs(before) > part && std::abs(now) <= part) {
      const double way = (std::abs(before) - part) / std::abs(before - now);
      settling = {(frame - 1 + way) * frame_length, frame, true};
    }
    before = now;
  }
  return settling;
}

}  // namespace pliant
