#include "pliant/timeline/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "support/catch.hpp"
#include "support/stopping.hpp"
#include "timeline/authoring.hpp"
#include "timeline/reference_evaluator.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("default lengths reproduce any cubic", "[timeline][curve]") {
  Whim whim(1);
  for (int round = 0; round < 500; ++round) {
    const double a = whim.between(-2, 2);
    const double b = whim.between(-2, 2);
    const double c = whim.between(-0.1, 0.1);
    const auto f = [&](double t) { return 1 + t * (a + t * (b + t * c)); };
    const auto slope = [&](double t) { return a + t * (2 * b + t * 3 * c); };
    std::vector<Key<1>> keys;
    for (double t = -5; t < 6; t += whim.between(0.1, 4)) {
      keys.push_back(key(t, f(t), of_slope(slope(t))));
    }
    const Curve<1> curve = make(keys);
    for (int i = 0; i < 20; ++i) {
      const double t = whim.between(-5, keys.back().frame);
      CAPTURE(a, b, c, t);
      // Values are up to 100; a dozen roundings.
      REQUIRE_THAT(at(curve, t), WithinAbs(f(t), 3e-13));
      REQUIRE_THAT(curve.velocity(t)[0], WithinAbs(slope(t), 1e-11));
    }
  }
}

TEST_CASE("general lengths agree with a bisection in long double", "[timeline][curve]") {
  Whim whim(2);
  for (int round = 0; round < rounds(2000); ++round) {
    std::vector<Key<1>> keys;
    double frame = whim.between(-30, 30);
    double span_before = 1;
    for (int k = 0; k < 4; ++k) {
      const double span = whim.size(-2, 2);
      Key<1> next = key(frame, whim.between(-10, 10));
      next.in = of_slope(whim.between(-3, 3), whim.between(0, 1) * span_before);
      next.out = of_slope(whim.between(-3, 3), whim.between(0, 1) * span);
      if (whim.once_in(4)) next.out.length = std::nullopt;
      if (whim.once_in(4)) next.out.length = 0;
      keys.push_back(next);
      frame += span;
      span_before = span;
    }
    const Curve<1> curve = make(keys);
    const auto reference = reference_segments(keys);
    double size = 0;
    for (const auto& segment : reference) {
      for (const long double v : segment.v)
        size = std::max(size, std::fabs(static_cast<double>(v)));
    }
    for (int i = 0; i < 10; ++i) {
      const double t = whim.between(keys.front().frame, keys.back().frame);
      // The exact value at a frame within 4 ulp, plus a few roundings of the value itself.
      const long double near[] = {reference_value(reference, t - 4.0L * ulp(t)),
                                  reference_value(reference, t),
                                  reference_value(reference, t + 4.0L * ulp(t))};
      const auto low = static_cast<double>(*std::min_element(near, near + 3));
      const auto high = static_cast<double>(*std::max_element(near, near + 3));
      CAPTURE(round, t, low, high, at(curve, t), size);
      REQUIRE(at(curve, t) >= low - 8 * epsilon * size);
      REQUIRE(at(curve, t) <= high + 8 * epsilon * size);
    }
  }
}

TEST_CASE("the curve is a finite function of time, whatever the tangents", "[timeline][curve]") {
  Whim whim(3);
  for (int round = 0; round < rounds(100000); ++round) {
    const CurveKeys<1> keys = whim.keys(4);
    const auto curve = Curve<1>::make(keys);
    REQUIRE(curve);
    const double first = keys.keys.front().frame;
    const double last = keys.keys.back().frame;
    bool is_sound = true;
    for (int i = 0; i < 3; ++i) {
      const double t = whim.between(first - 10, last + 10);
      is_sound = is_sound && std::isfinite(at(*curve, t)) && !std::isnan(curve->velocity(t)[0]) &&
                 !std::isnan(curve->left_velocity(t)[0]);
    }
    for (const Key<1>& each : keys.keys) {
      is_sound = is_sound && at(*curve, each.frame) == each.value[0];
    }
    if (is_sound) continue;  // one assertion per curve would need most of the time
    CAPTURE(round);
    REQUIRE(is_sound);
  }
}

TEST_CASE("time never runs backwards inside a Bezier segment", "[timeline][curve]") {
  // A curve whose values are its own times, x(u) = y(u): slopes 1 and corrected lengths. Then the
  // value at t is t for any lengths.
  Whim whim(4);
  for (int round = 0; round < rounds(15000); ++round) {
    CurveKeys<1> keys;
    const double span = whim.size(-3, 3);
    keys.keys = {key(0, 0), key(span, span)};
    keys.keys[0].out = of_slope(1, whim.size(-3, 2) * span);
    keys.keys[1].in = of_slope(1, whim.size(-3, 2) * span);
    keys.overshoot = static_cast<Overshoot>(whim.upto(2));
    const Curve<1> curve = make(keys);
    for (int i = 0; i < 4; ++i) {
      const double t = whim.between(0, span);
      if (std::fabs(at(curve, t) - t) <= 4e-15 * span) continue;
      CAPTURE(round, span, t);
      REQUIRE(at(curve, t) == t);
    }
  }
}

TEST_CASE("keys may be moved and scaled in time and value", "[timeline][curve]") {
  Whim whim(5);
  for (int round = 0; round < rounds(3000); ++round) {
    CurveKeys<1> keys = whim.keys(5);
    // Powers of two and integer shifts of dyadic frames are exact: equal bits, no tolerance.
    for (Key<1>& each : keys.keys) each.frame = std::round(each.frame * 1024) / 1024;
    bool is_increasing = true;
    for (std::size_t k = 1; k < keys.keys.size(); ++k) {
      is_increasing = is_increasing && keys.keys[k].frame > keys.keys[k - 1].frame;
    }
    if (!is_increasing) continue;
    CurveKeys<1> moved = keys;
    for (Key<1>& each : moved.keys) each.frame += 512;
    CurveKeys<1> moved_on = keys;
    for (Key<1>& each : moved_on.keys) each.frame += 1024;
    CurveKeys<1> raised = keys;
    const auto scale = [](Tangent<1>& tangent) {
      tangent.slope[0] *= -4;
      tangent.handle_value[0] *= -4;
    };
    for (Key<1>& each : raised.keys) {
      each.value[0] *= -4;
      if (each.left) (*each.left)[0] *= -4;
      if (each.next.amplitude) *each.next.amplitude *= 4;
      scale(each.in);
      scale(each.out);
    }
    raised.before.slope[0] *= -4;
    raised.after.slope[0] *= -4;
    CurveKeys<1> stretched = keys;
    const auto stretch = [](Tangent<1>& tangent) {
      tangent.slope[0] /= 8;
      if (tangent.length) *tangent.length *= 8;
      tangent.handle_frames *= 8;
    };
    for (Key<1>& each : stretched.keys) {
      each.frame *= 8;
      if (each.next.period) *each.next.period *= 8;
      stretch(each.in);
      stretch(each.out);
    }
    stretched.before.slope[0] /= 8;
    stretched.after.slope[0] /= 8;
    const Curve<1> curve = make(keys);
    const Curve<1> moved_curve = make(moved);
    const Curve<1> moved_on_curve = make(moved_on);
    const Curve<1> raised_curve = make(raised);
    const Curve<1> stretched_curve = make(stretched);
    for (int i = 0; i < 10; ++i) {
      const double t = whim.upto(80 * 1024) / 1024.0 - 40;
      CAPTURE(round, t);
      // Near frame 0, and only there, a segment is solved with more digits.
      REQUIRE(at(moved_curve, t + 512) == at(moved_on_curve, t + 1024));
      REQUIRE(at(raised_curve, t) == -4 * at(curve, t));
      REQUIRE(at(stretched_curve, 8 * t) == at(curve, t));
      REQUIRE(stretched_curve.velocity(8 * t)[0] == curve.velocity(t)[0] / 8);
    }
  }
}

TEST_CASE("velocity is the slope of the value", "[timeline][curve]") {
  Whim whim(6);
  for (int round = 0; round < rounds(10000); ++round) {
    const CurveKeys<1> keys = whim.keys(5);
    const Curve<1> curve = make(keys);
    const double t = whim.between(keys.keys.front().frame - 3, keys.keys.back().frame + 3);
    // Differences over decreasing steps must approach the velocity, unless this very frame is
    // special (a key, a vertical tangent, a corner of an easing).
    const double v = curve.velocity(t)[0];
    double best = std::numeric_limits<double>::infinity();
    for (double h = 1e-3; h > 1e-8; h /= 4) {
      const double difference = (at(curve, t + h) - at(curve, t - h)) / (2 * h);
      best = std::min(best, std::fabs(difference - v));
    }
    CAPTURE(round, t, v);
    if (std::fabs(v) > 1e4 || std::fabs(v - curve.left_velocity(t)[0]) > 0) continue;
    REQUIRE(best <= 2e-5 * (1 + std::fabs(v)));
  }
}

TEST_CASE("one-sided limits are the limits", "[timeline][curve]") {
  Whim whim(7);
  for (int round = 0; round < rounds(5000); ++round) {
    const CurveKeys<1> keys = whim.keys(4);
    const Curve<1> curve = make(keys);
    for (const Key<1>& each : keys.keys) {
      if (each.next.ease == Ease::Elastic) continue;  // starts with a step by definition
      const double v = curve.left_velocity(each.frame)[0];
      const double h = 1e-9;
      const double before = at(curve, each.frame - h);
      CAPTURE(round, each.frame, v, before, curve.left_value(each.frame)[0]);
      bool is_elastic = false;
      for (const Key<1>& other : keys.keys) is_elastic |= other.next.ease == Ease::Elastic;
      if (is_elastic || !(std::fabs(v) < 1e3)) continue;
      REQUIRE_THAT(curve.left_value(each.frame)[0], WithinAbs(before, 1e-4));
    }
  }
}

TEST_CASE("a single key is a constant, but for slopes outside", "[timeline][curve]") {
  for (int kind = 0; kind <= 6; ++kind) {
    CurveKeys<1> keys;
    keys.keys = {key(3, 7, of_slope(2))};
    keys.before.kind = keys.after.kind = static_cast<OutsideKind>(kind);
    keys.before.slope = keys.after.slope = {-1};
    const Curve<1> curve = make(keys);
    const double slope = keys.after.kind == OutsideKind::LinearOuter ? 2
                         : keys.after.kind == OutsideKind::Slope     ? -1
                                                                     : 0;
    CAPTURE(kind);
    CHECK(at(curve, 3) == 7);
    CHECK(at(curve, 5) == 7 + 2 * slope);
    CHECK(at(curve, 1) == 7 - 2 * slope);
    CHECK(at(curve, -1e9) == 7 - slope * (3 + 1e9));
    CHECK(curve.velocity(3)[0] == slope);
    CHECK(curve.left_velocity(3)[0] == slope);
    CHECK(curve.range(-1, 9).low[0] == 7 - std::fabs(slope) * (slope > 0 ? 4 : 6));
  }
}

TEST_CASE("keys a billionth of a frame apart keep their shape", "[timeline][curve]") {
  const double gap = 0x1p-30;
  for (const double frame : {0.0, 1.0, -3.0, 1000.0}) {
    const Curve<1> curve = make({key(frame, 0), key(frame + gap, 1), key(frame + 2 * gap, 0)});
    const Curve<1> plain = make({key(0, 0), key(1, 1), key(2, 0)});
    for (const double u : {0.25, 0.5, 0.75, 1.0, 1.5, 1.875}) {
      CAPTURE(frame, u);
      // ulp(1000) is an eighth of a thousandth of the gap: these frames are exact.
      CHECK_THAT(at(curve, frame + u * gap), WithinAbs(at(plain, u), 1e-15));
    }
  }
}

TEST_CASE("vector components are the curves of each number", "[timeline][curve]") {
  Whim whim(8);
  for (int round = 0; round < rounds(2000); ++round) {
    CurveKeys<1> parts[3] = {whim.keys(5), {}, {}};
    CurveKeys<3> keys;
    for (int c = 0; c < 3; ++c) {
      if (c > 0) parts[c] = parts[0];
      for (Key<1>& each : parts[c].keys) {
        each.value[0] *= c + 1;
        each.in.slope[0] -= c;
        each.out.handle_value[0] += c;
      }
    }
    const auto tangent = [&](auto pick) {
      Tangent<3> result;
      const Tangent<1>& first = pick(0);
      result.kind = static_cast<Tangent<3>::Kind>(first.kind);
      result.length = first.length;
      result.handle_frames = first.handle_frames;
      for (int c = 0; c < 3; ++c) {
        result.slope[c] = pick(c).slope[0];
        result.handle_value[c] = pick(c).handle_value[0];
      }
      return result;
    };
    for (std::size_t k = 0; k < parts[0].keys.size(); ++k) {
      const Key<1>& first = parts[0].keys[k];
      Key<3> next{.frame = first.frame, .next = first.next};
      next.in = tangent([&](int c) -> const Tangent<1>& { return parts[c].keys[k].in; });
      next.out = tangent([&](int c) -> const Tangent<1>& { return parts[c].keys[k].out; });
      for (int c = 0; c < 3; ++c) next.value[c] = parts[c].keys[k].value[0];
      if (first.left) next.left = Value<3>{(*first.left)[0], (*first.left)[0], (*first.left)[0]};
      keys.keys.push_back(next);
    }
    const auto outside = [](const Extrapolation<1>& from) {
      return Extrapolation<3>{static_cast<Extrapolation<3>::Kind>(from.kind),
                              {from.slope[0], from.slope[0], from.slope[0]},
                              from.count};
    };
    keys.before = outside(parts[0].before);
    keys.after = outside(parts[0].after);
    keys.overshoot = parts[0].overshoot;
    const Curve<3> curve = Curve<3>::make(keys).value();
    for (int c = 0; c < 3; ++c) {
      const Curve<1> single = make(parts[c]);
      for (int i = 0; i < 5; ++i) {
        const double t = whim.between(keys.keys[0].frame - 5, keys.keys.back().frame + 5);
        if (curve.value(t)[c] == at(single, t) && curve.velocity(t)[c] == single.velocity(t)[0]) {
          continue;
        }
        CAPTURE(round, c, t);
        REQUIRE(curve.value(t)[c] == at(single, t));
        REQUIRE(curve.velocity(t)[c] == single.velocity(t)[0]);
      }
      const double from = whim.between(-10, 10);
      REQUIRE(curve.range(from, from + 7).high[c] == single.range(from, from + 7).high[0]);
    }
  }
}

TEST_CASE("huge but legal numbers stay finite between the keys", "[timeline][curve]") {
  Whim whim(9);
  for (int round = 0; round < rounds(10000); ++round) {
    CurveKeys<1> keys = whim.keys(4);
    for (Key<1>& each : keys.keys) {
      if (whim.once_in(2)) each.value[0] *= whim.size(-300, 148);
      if (whim.once_in(2)) each.in.slope[0] *= whim.size(-300, 148);
      if (whim.once_in(2)) each.out.handle_value[0] *= whim.size(-300, 148);
      if (whim.once_in(2)) each.out.handle_frames *= whim.size(-300, 148);
      if (whim.once_in(2)) each.frame *= whim.size(-300, 140);
      if (each.in.length && whim.once_in(2)) *each.in.length *= whim.size(-300, 148);
      if (each.next.amplitude && whim.once_in(2)) *each.next.amplitude *= whim.size(-300, 148);
      if (each.next.period && whim.once_in(2)) *each.next.period *= whim.size(-300, 148);
    }
    std::sort(keys.keys.begin(), keys.keys.end(),
              [](const Key<1>& a, const Key<1>& b) { return a.frame < b.frame; });
    const auto curve = Curve<1>::make(keys);
    if (!curve) {
      REQUIRE(!curve.error().message.empty());
      continue;
    }
    for (std::size_t k = 0; k + 1 < keys.keys.size(); ++k) {
      const double start = keys.keys[k].frame;
      const double end = keys.keys[k + 1].frame;
      for (const double u : {0.0, 1e-9, 0.3, 0.5, 0.999}) {
        const double t = start + u * (end - start);
        if (std::isfinite(at(*curve, t)) && !std::isnan(curve->velocity(t)[0])) continue;
        CAPTURE(round, k, t);
        REQUIRE(std::isfinite(at(*curve, t)));
        REQUIRE(!std::isnan(curve->velocity(t)[0]));
      }
    }
    const double far = whim.between(-1, 1) * whim.size(0, 308);
    CAPTURE(round, far);
    REQUIRE(!std::isnan(at(*curve, far)));
    REQUIRE(!std::isnan(curve->velocity(far)[0]));
  }
}

TEST_CASE("a curve may be asked from many threads at once", "[timeline][curve][threads]") {
  Whim whim(10);
  CurveKeys<1> keys = whim.keys(40);
  const Curve<1> curve = make(keys);
  std::vector<double> sums(4);
  {
    std::vector<std::jthread> threads;
    for (double& sum : sums) {
      threads.emplace_back([&curve, &sum] {
        for (int i = -2000; i < 4000; ++i) sum += at(curve, i * 0.25);
      });
    }
  }
  for (const double sum : sums) CHECK(sum == sums.front());
}

TEST_CASE("a curve of many keys can be stopped while it is made", "[timeline][curve][stopping]") {
  CurveKeys<3> keys;
  for (int k = 0; k < 10'000; ++k) {
    const double value = k % 7 * (k % 3);
    keys.keys.push_back({.frame = 1.0 * k, .value = {value, -value, 1}});
    keys.keys.back().in.kind = keys.keys.back().out.kind = Tangent<3>::Kind::Smooth;
  }
  testing::check_stops(
      [&](const StopRequest& should_stop) -> Result<void> {
        const auto made = Curve<3>::make(keys, should_stop);
        if (!made)
          return made.error().kind == Complaint::Kind::Interrupted ? interrupted()
                                                                   : invalid("no curve");
        return {};
      },
      40);
}

TEST_CASE("a frame that is no number has no value", "[timeline][curve]") {
  const Curve<1> curve = make({key(0, 1), key(5, 2)});
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(at(curve, none)));
  CHECK(std::isnan(curve.velocity(none)[0]));
  CHECK(at(curve, std::numeric_limits<double>::infinity()) == 2);
}

}  // namespace

TEST_CASE("copies of a curve share its parts, and what is made of one leaves the others",
          "[timeline][curve]") {
  CurveKeys<1> keys;
  keys.keys = {key(1, 2), key(5, 7)};
  Curve<1> one = make(keys);
  const Curve<1> copy = one;
  CHECK(&copy.keys() == &one.keys());
  const Curve<1> twice = one.adjusted({Adjustment{Adjustment::Kind::Times, 2}});
  CHECK(&copy.keys() == &one.keys());
  CHECK(at(twice, 5) == 14);
  one = twice;
  CHECK(&one.keys() == &twice.keys());
  CHECK(at(copy, 5) == 7);
}

}  // namespace pliant::testing
