#include "pliant/timeline/easing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::Easing;
using timeline::Progress;

constexpr long double pi = std::numbers::pi_v<long double>;

/// The easings as documented, in long double.
struct Formula {
  Interpolation next;
  long double length;
  long double change;

  long double in(long double u) const {
    const bool is_both = next.side == EaseSide::InOut;
    if (u == 0) return 0;
    if (u == 1) return 1;
    switch (next.ease) {
      case Ease::Sine:
        return 1 - std::cos(u * pi / 2);
      case Ease::Quad:
        return u * u;
      case Ease::Cubic:
        return u * u * u;
      case Ease::Quart:
        return u * u * u * u;
      case Ease::Quint:
        return u * u * u * u * u;
      case Ease::Expo: {
        const long double least = std::exp2(-10.0L);
        return (std::exp2(10 * (u - 1)) - least) / (1 - least);
      }
      case Ease::Circ:
        return 1 - std::sqrt(1 - u * u);
      case Ease::Back: {
        const long double q = next.back.value_or(1.70158) * (is_both ? 1.525L : 1.0L);
        return u * u * ((q + 1) * u - q);
      }
      case Ease::Bounce:
        return 1 - bounce_out(1 - u);
      case Ease::Elastic: {
        const long double w = (u - 1) * length;
        long double p = next.period.value_or(0);
        if (p == 0) p = (is_both ? 0.45L : 0.3L) * length;
        const long double amplitude = next.amplitude ? *next.amplitude / std::fabs(change) : 1.0L;
        long double s = p / 4;
        long double f = 1;
        if (amplitude >= 1) {
          s = p / (2 * pi) * std::asin(1 / amplitude);
        } else {
          f = 1 - (1 - amplitude) * std::min(1.0L, std::fabs(w) / std::fabs(s));
        }
        return -f * std::max(amplitude, 1.0L) * std::exp2(10 * (u - 1)) *
               std::sin((w - s) * 2 * pi / p);
      }
    }
    return 0;
  }

  static long double bounce_out(long double u) {
    const long double n = 7.5625L;
    const long double d = 2.75L;
    if (u < 1 / d) return n * u * u;
    if (u < 2 / d) return n * (u - 1.5L / d) * (u - 1.5L / d) + 0.75L;
    if (u < 2.5L / d) return n * (u - 2.25L / d) * (u - 2.25L / d) + 0.9375L;
    return n * (u - 2.625L / d) * (u - 2.625L / d) + 0.984375L;
  }

  long double share(long double u) const {
    if (next.side == EaseSide::In) return in(u);
    if (next.side == EaseSide::Out) return 1 - in(1 - u);
    return u < 0.5L ? in(2 * u) / 2 : 1 - in(2 - 2 * u) / 2;
  }
};

double share_of(const Easing& easing, double u) {
  const Easing::Share share = easing.share({u, 1 - u});
  return share.is_from_start ? share.amount : 1 - share.amount;
}

TEST_CASE("easings follow their formulas on every side", "[timeline][easing]") {
  Whim whim(21);
  for (int ease = 0; ease < 10; ++ease) {
    for (int side = 0; side < 3; ++side) {
      for (int round = 0; round < 60; ++round) {
        Interpolation next = of_ease(static_cast<Ease>(ease), static_cast<EaseSide>(side));
        if (whim.once_in(2)) next.back = whim.once_in(4) ? 0 : whim.between(-1, 4);
        if (whim.once_in(2)) next.amplitude = whim.once_in(4) ? 0 : whim.between(0, 8);
        if (whim.once_in(2)) next.period = whim.once_in(4) ? 0 : whim.between(-6, 6);
        const double length = whim.size(-1, 2);
        const double change = whim.between(-4, 4);
        const Easing easing(next, length, change);
        const Formula formula{next, length, change};
        for (int i = 0; i <= 16; ++i) {
          const double u = i / 16.0;  // 1 - u is exact
          CAPTURE(ease, side, round, u, length, change);
          // Elastic: the angle grows with length/period, and so does its rounding error.
          const double angle =
              1 + length / std::fabs(next.period.value_or(0) != 0 ? *next.period : 0.3 * length);
          const double tolerance = 4e-15 * (next.ease == Ease::Elastic ? 10 * angle : 1.0) *
                                   (1 + std::fabs(next.back.value_or(2)) +
                                    next.amplitude.value_or(0) / std::fabs(change));
          const auto expected = static_cast<double>(formula.share(u));
          REQUIRE_THAT(share_of(easing, u), WithinAbs(expected, tolerance));
        }
      }
    }
  }
}

TEST_CASE("easings start at 0 and end at 1", "[timeline][easing]") {
  for (int ease = 0; ease < 10; ++ease) {
    for (int side = 0; side < 3; ++side) {
      const Easing easing(of_ease(static_cast<Ease>(ease), static_cast<EaseSide>(side)), 7, 2);
      CAPTURE(ease, side);
      CHECK(share_of(easing, 0) == 0);
      CHECK(share_of(easing, 1) == 1);
    }
  }
}

TEST_CASE("easing slopes are the slopes of the shares", "[timeline][easing]") {
  Whim whim(22);
  for (int round = 0; round < rounds(3000); ++round) {
    Interpolation next = whim.interpolation();
    const double length = whim.between(1, 20);
    const Easing easing(next, length, 1.5);
    const double u = whim.between(0.01, 0.99);
    const double h = 1e-6;
    const double before = (share_of(easing, u) - share_of(easing, u - h)) / h;
    const double after = (share_of(easing, u + h) - share_of(easing, u)) / h;
    const double slope = easing.slope({u, 1 - u});
    CAPTURE(round, static_cast<int>(next.ease), static_cast<int>(next.side), u, before, after);
    // A corner of the bounce, or of the elastic's ramp, has another slope on each side.
    const double tolerance = 1e-4 * (1 + std::fabs(slope)) * (1 + length);
    REQUIRE((std::fabs(before - slope) < tolerance || std::fabs(after - slope) < tolerance));
  }
}

TEST_CASE("extrema of easings bound their shares", "[timeline][easing]") {
  Whim whim(23);
  for (int round = 0; round < 600; ++round) {
    Interpolation next = whim.interpolation();
    if (next.period && whim.once_in(3)) *next.period *= -0.1;
    const Easing easing(next, whim.between(1, 20), 1.5);
    const double from = whim.once_in(2) ? 0 : whim.between(0, 1);
    const double to = whim.once_in(2) ? 1 : whim.between(from, 1);
    double low = std::min(share_of(easing, from), share_of(easing, to));
    double high = std::max(share_of(easing, from), share_of(easing, to));
    const Easing::Places places = easing.extrema(from, to);
    for (int i = 0; i < places.count; ++i) {
      if (!(places.passed[i] > from && places.passed[i] < to)) continue;
      low = std::min(low, share_of(easing, places.passed[i]));
      high = std::max(high, share_of(easing, places.passed[i]));
    }
    for (int i = 0; i <= 100; ++i) {
      const double u = std::clamp(from + (to - from) * i / 100, from, to);
      if (share_of(easing, u) >= low && share_of(easing, u) <= high) continue;
      CAPTURE(round, static_cast<int>(next.ease), static_cast<int>(next.side), from, to, u);
      REQUIRE(share_of(easing, u) >= low - 1e-12);
      REQUIRE(share_of(easing, u) <= high + 1e-12);
    }
  }
}

TEST_CASE("an elastic with a billion waves still answers", "[timeline][easing]") {
  Interpolation next = of_ease(Ease::Elastic, EaseSide::Out);
  next.period = 1e-8;
  CHECK(Easing::is_sound(next, 10));
  const Easing easing(next, 10, 1);
  CHECK(std::isfinite(share_of(easing, 0.3)));
  CHECK(easing.extrema(0, 1).count > 0);
  next.period = 1e-300;
  CHECK(!Easing::is_sound(next, 10));
}

TEST_CASE("an eased segment without change is constant", "[timeline][easing]") {
  for (int ease = 0; ease < 10; ++ease) {
    Interpolation next = of_ease(static_cast<Ease>(ease), EaseSide::InOut);
    next.amplitude = 5;
    const Curve<1> curve = make({key(0, 3, next), key(10, 3)});
    for (const double t : {0.0, 1.0, 4.9, 5.1, 9.99}) {
      CHECK(at(curve, t) == 3);
      CHECK(curve.velocity(t)[0] == 0);
    }
  }
}

TEST_CASE("elastic amplitude counts against each component's change", "[timeline][easing]") {
  Key<3> first{.frame = 0, .value = {0, 0, 0}};
  first.next = of_ease(Ease::Elastic, EaseSide::Out);
  first.next.amplitude = 2;
  const Key<3> second{.frame = 10, .value = {1, -2, 8}};
  const Curve<3> curve = Curve<3>::make({.keys = {first, second}}).value();
  for (int c = 0; c < 3; ++c) {
    const Curve<1> single = make({key(0, 0, first.next), key(10, second.value[c])});
    for (double t = 0; t < 10; t += 0.7) CHECK(curve.value(t)[c] == at(single, t));
    for (double t = 0; t < 10; t += 0.7) CHECK(curve.velocity(t)[c] == single.velocity(t)[0]);
  }
}

TEST_CASE("cubicBezier is the CSS timing function", "[timeline][easing]") {
  Whim whim(24);
  for (int round = 0; round < 300; ++round) {
    Interpolation next = of_segment(SegmentKind::CubicBezier);
    next.control = {whim.between(0, 1), whim.between(-1, 2), whim.between(0, 1),
                    whim.between(-1, 2)};
    if (whim.once_in(5)) next.control = {1.0 / 3, 0.7, 2.0 / 3, 0.2};
    const Curve<1> curve = make({key(2, 5, next), key(10, 1)});
    for (int i = 1; i < 20; ++i) {
      // From the parameter to a time, and back to the value.
      const double u = i / 20.0;
      const double w = 1 - u;
      const auto& [x1, y1, x2, y2] = next.control;
      const double x = 3 * w * w * u * x1 + 3 * w * u * u * x2 + u * u * u;
      const double y = 3 * w * w * u * y1 + 3 * w * u * u * y2 + u * u * u;
      const double steepness = std::fabs(curve.velocity(2 + 8 * x)[0]);
      CAPTURE(round, u, x, y);
      if (steepness > 1e3) continue;
      REQUIRE_THAT(at(curve, 2 + 8 * x), WithinAbs(5 - 4 * y, 1e-13 + 1e-14 * steepness));
    }
  }
}

}  // namespace
}  // namespace pliant::testing
