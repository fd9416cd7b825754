#include <algorithm>
#include <cmath>

#include "pliant/timeline/tangents.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::Slopes;
using timeline::tangent_slopes;

struct Row {
  std::vector<double> frames;
  std::vector<double> values;

  double h(std::size_t k) const { return frames[k + 1] - frames[k]; }
  double s(std::size_t k) const { return (values[k + 1] - values[k]) / h(k); }
};

Row row_of(const CurveKeys<1>& keys) {
  Row row;
  for (const Key<1>& each : keys.keys) {
    row.frames.push_back(each.frame);
    row.values.push_back(each.value[0]);
  }
  return row;
}

/// The accelerations of a segment of default lengths at its two ends.
double acceleration_at_start(double h, double s, double m0, double m1) {
  return (6 * s - 4 * m0 - 2 * m1) / h;
}
double acceleration_at_end(double h, double s, double m0, double m1) {
  return (2 * m0 + 4 * m1 - 6 * s) / h;
}

CurveKeys<1> random_keys(Whim& whim, int count, TangentKind kind) {
  CurveKeys<1> keys;
  double frame = 0;
  for (int k = 0; k < count; ++k) {
    keys.keys.push_back(key(frame, whim.between(-5, 5), of_kind(kind)));
    frame += whim.between(0.3, 3);
  }
  return keys;
}

TEST_CASE("free tangents have continuous acceleration", "[timeline][smooth]") {
  Whim whim(51);
  for (int round = 0; round < rounds(1000); ++round) {
    CurveKeys<1> keys = random_keys(whim, 2 + whim.upto(10), TangentKind::Free);
    const bool is_periodic = whim.once_in(2);
    if (is_periodic) keys.after.kind = OutsideKind::RepeatOffset;
    // Sometimes a key of another kind: its neighbours use its slope.
    std::size_t other = 0;
    if (keys.keys.size() > 4 && whim.once_in(2)) {
      other = 2;
      keys.keys[other].in = keys.keys[other].out = of_slope(whim.between(-2, 2));
    }
    const Slopes m = tangent_slopes(keys.keys, keys.before, keys.after, 0);
    const Row row = row_of(keys);
    const std::size_t last = row.frames.size() - 1;
    for (std::size_t k = 1; k < last; ++k) {
      if (k == other) continue;
      CAPTURE(round, k, is_periodic);
      REQUIRE(m.in[k] == m.out[k]);
      REQUIRE_THAT(
          acceleration_at_end(row.h(k - 1), row.s(k - 1), m.out[k - 1], m.in[k]),
          WithinAbs(acceleration_at_start(row.h(k), row.s(k), m.out[k], m.in[k + 1]), 1e-9));
    }
    const double first = acceleration_at_start(row.h(0), row.s(0), m.out[0], m.in[1]);
    const double final =
        acceleration_at_end(row.h(last - 1), row.s(last - 1), m.out[last - 1], m.in[last]);
    if (is_periodic) {
      REQUIRE_THAT(first, WithinAbs(final, 1e-9));
    } else {
      REQUIRE_THAT(first, WithinAbs(0, 1e-9));
      REQUIRE_THAT(final, WithinAbs(0, 1e-9));
    }
  }
}

TEST_CASE("smooth tangents never overshoot, and accelerate steadily but at fixed keys",
          "[timeline][smooth]") {
  Whim whim(52);
  for (int round = 0; round < rounds(1000); ++round) {
    CurveKeys<1> keys = random_keys(whim, 3 + whim.upto(10), TangentKind::Smooth);
    if (whim.once_in(2)) {
      // A long climb: few extrema, so that most slopes come from the system.
      double value = 0;
      for (Key<1>& each : keys.keys) each.value[0] = value += whim.size(-1, 1);
    }
    const Slopes m = tangent_slopes(keys.keys, keys.before, keys.after, 0);
    const Row row = row_of(keys);
    for (std::size_t k = 1; k + 1 < row.frames.size(); ++k) {
      const double before = row.s(k - 1);
      const double after = row.s(k);
      const double cap = 3 * std::min(std::fabs(before), std::fabs(after));
      CAPTURE(round, k, before, after, m.in[k]);
      REQUIRE(m.in[k] == m.out[k]);
      if (before * after <= 0) {
        REQUIRE(m.in[k] == 0);
        continue;
      }
      REQUIRE(m.in[k] * before >= 0);
      REQUIRE(std::fabs(m.in[k]) <= cap);
      if (m.in[k] == 0 || std::fabs(m.in[k]) == cap) continue;
      REQUIRE_THAT(
          acceleration_at_end(row.h(k - 1), row.s(k - 1), m.out[k - 1], m.in[k]),
          WithinAbs(acceleration_at_start(row.h(k), row.s(k), m.out[k], m.in[k + 1]), 1e-9));
    }
    const Curve<1> curve = make(keys);
    for (std::size_t k = 0; k + 1 < row.frames.size(); ++k) {
      const auto [low, high] = std::minmax(row.values[k], row.values[k + 1]);
      const auto range = curve.range(row.frames[k], row.frames[k + 1]);
      CAPTURE(round, k);
      REQUIRE(range.low[0] >= low - 1e-13);
      REQUIRE(range.high[0] <= high + 1e-13);
    }
  }
}

TEST_CASE("two smooth keys make a straight line", "[timeline][smooth]") {
  const CurveKeys<1> keys = with_kinds({.keys = {key(0, 1), key(4, 9)}}, TangentKind::Smooth);
  const Curve<1> curve = make(keys);
  for (double t = 0; t <= 4; t += 0.5) CHECK_THAT(at(curve, t), WithinAbs(1 + 2 * t, 1e-14));
}

TEST_CASE("a run that meets a flat side is flat there", "[timeline][smooth]") {
  CurveKeys<1> keys =
      with_kinds({.keys = {key(0, 0), key(1, 1), key(3, 5), key(4, 9)}}, TangentKind::Free);
  keys.keys[1].in = of_kind(TangentKind::Flat);
  const Slopes flat = tangent_slopes(keys.keys, keys.before, keys.after, 0);
  CHECK(flat.out[1] == 0);
  keys.keys[1].in = of_slope(3);  // another slope separates the key's sides: a natural end
  const Slopes natural = tangent_slopes(keys.keys, keys.before, keys.after, 0);
  CHECK_THAT(2 * natural.out[1] + natural.in[2], WithinAbs(3 * 2, 1e-13));
}

TEST_CASE("a run ends naturally beside segments without tangents", "[timeline][smooth]") {
  CurveKeys<1> keys =
      with_kinds({.keys = {key(0, 0), key(1, 1), key(3, 5), key(4, 9)}}, TangentKind::Smooth);
  keys.keys[0].next.kind = SegmentKind::Step;
  const Slopes slopes = tangent_slopes(keys.keys, keys.before, keys.after, 0);
  CHECK_THAT(2 * slopes.out[1] + slopes.in[2], WithinAbs(3 * 2, 1e-13));
}

TEST_CASE("a left value ends one run and starts another", "[timeline][smooth]") {
  const CurveKeys<1> keys =
      with_kinds({.keys = {key(0, 0), key(1, 1), with_left(key(3, 5), 4), key(4, 9), key(6, 2)}},
                 TangentKind::Free);
  const Slopes m = tangent_slopes(keys.keys, keys.before, keys.after, 0);
  CHECK_THAT(m.out[1] + 2 * m.in[2], WithinAbs(3 * 1.5, 1e-13));
  CHECK_THAT(2 * m.out[2] + m.in[3], WithinAbs(3 * 4, 1e-13));
}

}  // namespace
}  // namespace pliant::testing
