#include "pliant/plate/swing.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pliant/plate/vibration.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr double frame_length = 1.0 / 24;

// An independent slow path: eq. (8) or (8a) with a single unknown, from rest, under a load of
// lambda, for which the final value is 1. The unknown at each frame.
std::vector<double> played(double lambda, const Dynamics& dynamics, const TimeSteps& steps,
                           int frames) {
  const auto& [rho, eta] = dynamics;
  const bool is_newmark = steps.integrator == Integrator::Newmark;
  const double h = is_newmark ? steps.length / 2 : steps.length;
  const double shift = rho / (h * h) + eta / h;
  double w = 0, v = 0;
  std::vector<double> shown = {w};
  for (int frame = 0; frame < frames; ++frame) {
    for (int step = 0; step < steps.count; ++step) {
      const double next = (lambda + shift * w + rho / h * v) / (lambda + shift);
      v = is_newmark ? 2 * (next - w) / h - v : (next - w) / h;
      w = is_newmark ? 2 * next - w : next;
    }
    shown.push_back(w);
  }
  return shown;
}

// The first frame from which on all values are within 5 % of 1.
int settled_frames(const std::vector<double>& shown) {
  int settled = static_cast<int>(shown.size());
  while (settled > 0 && std::abs(shown[static_cast<std::size_t>(settled) - 1] - 1) <= 0.05) {
    --settled;
  }
  return settled;
}

}  // namespace

TEST_CASE("a vibration in frames is what the steps make of it", "[plate][swing]") {
  // Crossings of the rest position are half a period apart, and successive maxima give the damping.
  for (const double lambda : {400.0, 2000.0}) {
    for (const double eta : {0.0, 3.0}) {
      for (const TimeSteps& steps :
           {TimeSteps{1, frame_length}, TimeSteps{5, frame_length / 5}, TimeSteps{5, 0.01},
            TimeSteps{100, frame_length / 100}, TimeSteps{1, frame_length, Integrator::Newmark},
            TimeSteps{7, frame_length / 7, Integrator::Newmark}}) {
        const Dynamics dynamics{2, eta};
        CAPTURE(lambda, eta, steps.count, steps.length, steps.integrator);
        const Swing swing = stepped_swing(lambda, dynamics, steps, frame_length);
        const bool keeps_energy = eta == 0 && steps.integrator == Integrator::Newmark;
        CHECK((swing.damping_ratio > 1e-9) != keeps_energy);
        REQUIRE(swing.damping_ratio < 1);
        // w - 1 = exp(-decay t) (p cos(omega t) + q sin(omega t)) in frames: any three in a row
        // satisfy a recurrence with these coefficients.
        const double omega = 2 * std::numbers::pi * swing.frequency;
        const double decay =
            omega * swing.damping_ratio / std::sqrt(1 - swing.damping_ratio * swing.damping_ratio);
        const double middle = 2 * std::exp(-decay * frame_length) * std::cos(omega * frame_length);
        const double last = std::exp(-2 * decay * frame_length);
        const auto shown = played(lambda, dynamics, steps, 12);
        for (std::size_t k = 2; k < shown.size(); ++k) {
          CHECK_THAT(shown[k] - 1,
                     WithinAbs(middle * (shown[k - 1] - 1) - last * (shown[k - 2] - 1), 1e-11));
        }
      }
    }
  }
}

TEST_CASE("short steps leave a vibration as nature has it", "[plate][swing]") {
  const Dynamics dynamics{3, 20};
  const Swing natural = natural_swing(500, dynamics);
  CHECK_THAT(natural.damping_ratio, WithinRel(20 / (2 * std::sqrt(1500.0)), 1e-14));
  const Swing stepped = stepped_swing(500, dynamics, {40'000, frame_length / 40'000}, frame_length);
  CHECK_THAT(stepped.damping_ratio, WithinRel(natural.damping_ratio, 1e-4));
  const double damped =
      natural.frequency * std::sqrt(1 - natural.damping_ratio * natural.damping_ratio);
  CHECK_THAT(stepped.frequency, WithinRel(damped, 1e-4));
  // Each step of backward Euler removes energy: to first order it adds half of omega dt to the
  // damping.
  const Swing coarse = stepped_swing(500, {3, 0}, {100, frame_length / 100}, frame_length);
  CHECK_THAT(coarse.damping_ratio, WithinRel(std::sqrt(500.0 / 3) * frame_length / 100 / 2, 0.01));
}

TEST_CASE("what does not swing has no frequency", "[plate][swing]") {
  const TimeSteps steps{5, frame_length / 5};
  for (const double eta : {100.0, 1e6}) {
    const Swing creeping = stepped_swing(500, {3, eta}, steps, frame_length);
    CHECK(creeping.frequency == 0);
    CHECK(creeping.damping_ratio > 1);
  }
  CHECK(natural_swing(500, {0, 4}).frequency == 0);
  for (const double eta : {0.0, 4.0}) {  // without inertia
    const Swing massless = stepped_swing(500, {0, eta}, steps, frame_length);
    CHECK(massless.frequency == 0);
    CHECK(massless.damping_ratio == std::numeric_limits<double>::infinity());
  }
}

TEST_CASE("settling is counted as it is played", "[plate][swing]") {
  for (const double lambda : {30.0, 400.0, 2000.0}) {
    for (const Dynamics& dynamics : {Dynamics{2, 1}, Dynamics{2, 40}, Dynamics{2, 2000},
                                     Dynamics{0, 300}, Dynamics{0, 0}, Dynamics{2, 0}}) {
      for (const TimeSteps& steps :
           {TimeSteps{1, frame_length}, TimeSteps{5, frame_length / 5}, TimeSteps{5, 0.01},
            TimeSteps{1, 1}, TimeSteps{5, frame_length / 5, Integrator::Newmark}}) {
        // Newmark's steps stand for no motion without inertia, and keep one without damping.
        const bool is_newmark = steps.integrator == Integrator::Newmark;
        if (is_newmark && (dynamics.density == 0 || dynamics.damping == 0)) continue;
        CAPTURE(is_newmark, lambda, dynamics.density, dynamics.damping, steps.count, steps.length);
        const auto shown = played(lambda, dynamics, steps, 20'000);
        const int frames = settled_frames(shown);
        REQUIRE(frames < 10'000);
        const std::vector<ExcitedMode> modes = {{lambda, 1}};
        const Settling settling = settling_of(modes, dynamics, steps, frame_length);
        CHECK(settling.is_counted);
        CHECK(settling.frames == frames);
        CHECK(settling.time <= frames * frame_length);
        CHECK(settling.time >= (frames - 1) * frame_length);
      }
    }
  }
}

TEST_CASE("Newmark's steps ring on where a motion is faster than they are", "[plate][swing]") {
  for (const int count : {1, 2, 5}) {
    const TimeSteps steps{count, frame_length / count, Integrator::Newmark};
    for (const double lambda : {400.0, 1e5}) {
      for (const double eta : {200.0, 5e3, 1e6}) {
        const Dynamics dynamics{0.1, eta};
        CAPTURE(count, lambda, eta);
        const Swing swing = stepped_swing(lambda, dynamics, steps, frame_length);
        CHECK(std::isfinite(swing.frequency));
        CHECK(swing.damping_ratio > 0);
        const std::vector<ExcitedMode> modes = {{lambda, 1}};
        const Settling settling = settling_of(modes, dynamics, steps, frame_length);
        if (!settling.is_counted) continue;
        CHECK(settling.frames == settled_frames(played(lambda, dynamics, steps, 100'000)));
      }
    }
  }
}

TEST_CASE("what keeps its energy never settles", "[plate][swing]") {
  const std::vector<ExcitedMode> modes = {{400, 1}};
  const Settling settling =
      settling_of(modes, {2, 0}, {5, frame_length / 5, Integrator::Newmark}, frame_length);
  CHECK_FALSE(settling.is_counted);
  CHECK(std::isinf(settling.time));
}

TEST_CASE("several vibrations settle together", "[plate][swing]") {
  const Dynamics dynamics{2, 5};
  const TimeSteps steps{5, frame_length / 5};
  const auto slow = played(100, dynamics, steps, 5000);
  const auto fast = played(3000, dynamics, steps, 5000);
  for (const double share : {0.03, 0.5, 1.3}) {  // the last one: opposite signs
    std::vector<double> shown;
    for (std::size_t k = 0; k < slow.size(); ++k) {
      shown.push_back(share * slow[k] + (1 - share) * fast[k]);
    }
    const std::vector<ExcitedMode> modes = {{100, share}, {3000, 1 - share}};
    CHECK(settling_of(modes, dynamics, steps, frame_length).frames == settled_frames(shown));
  }
}

TEST_CASE("what takes years to settle is told by its envelope", "[plate][swing]") {
  const std::vector<ExcitedMode> modes = {{1e-6, 1}};
  const Settling settling = settling_of(modes, {0, 4}, {1, frame_length}, frame_length);
  CHECK_FALSE(settling.is_counted);
  CHECK_THAT(settling.time, WithinRel(4e6 * std::log(20), 1e-3));
  CHECK(settling.frames >= settling.time * 24);
}

TEST_CASE("what is seen of the exact solution is the natural swing", "[plate][swing]") {
  const TimeSteps steps{1, frame_length, Integrator::Exact};
  for (const double lambda : {30.0, 400.0, 90'000.0}) {
    for (const double eta : {0.0, 1.0, 80.0, 4000.0}) {
      const Dynamics dynamics{2, eta};
      CAPTURE(lambda, eta);
      const Swing natural = natural_swing(lambda, dynamics);
      const Swing seen = stepped_swing(lambda, dynamics, steps, frame_length);
      const double ratio = natural.damping_ratio;
      CHECK(seen.damping_ratio == Approx(ratio));
      CHECK(seen.frequency ==
            Approx(ratio < 1 ? natural.frequency * std::sqrt(1 - ratio * ratio) : 0));
      if (eta == 0) continue;
      // q = 1 - e^(-a t) (cos(w t) + a/w sin(w t)), or the same with two real roots.
      const double a = eta / 4, square = lambda / 2 - a * a, root = std::sqrt(std::abs(square));
      const auto deviation = [&](double t) {
        if (square > 0)
          return std::exp(-a * t) * (std::cos(root * t) + a / root * std::sin(root * t));
        return ((root + a) * std::exp((root - a) * t) + (root - a) * std::exp(-(root + a) * t)) /
               (2 * root);
      };
      const std::vector<ExcitedMode> modes = {{lambda, 1}};
      const Settling settling = settling_of(modes, dynamics, steps, frame_length);
      if (!settling.is_counted) continue;
      CHECK(std::abs(deviation(settling.frames * frame_length)) <= 0.05 + 1e-9);
      CHECK(std::abs(deviation((settling.frames - 1) * frame_length)) > 0.05 - 1e-9);
    }
  }
}
