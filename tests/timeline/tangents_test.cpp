#include "pliant/timeline/tangents.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using timeline::Slopes;
using timeline::tangent_slopes;

Slopes slopes_of(const CurveKeys<1>& keys) {
  return tangent_slopes(keys.keys, keys.before, keys.after, 0);
}

CurveKeys<1> keys_with_repeats(Whim& whim, int count, TangentKind kind) {
  CurveKeys<1> keys;
  double frame = whim.between(-10, 10);
  for (int k = 0; k < count; ++k) {
    const bool repeats = k > 0 && whim.once_in(5);
    keys.keys.push_back(
        key(frame, repeats ? keys.keys.back().value[0] : whim.between(-5, 5), of_kind(kind)));
    frame += whim.size(-1, 1);
  }
  return keys;
}

TEST_CASE("auto and plateau never leave the interval of their neighbours", "[timeline][tangents]") {
  Whim whim(41);
  for (int round = 0; round < rounds(8000); ++round) {
    const auto kind = whim.once_in(2) ? TangentKind::Auto : TangentKind::Plateau;
    const CurveKeys<1> keys = keys_with_repeats(whim, 2 + whim.upto(4), kind);
    const Curve<1> curve = make(keys);
    for (std::size_t k = 0; k + 1 < keys.keys.size(); ++k) {
      const auto [low, high] = std::minmax(keys.keys[k].value[0], keys.keys[k + 1].value[0]);
      for (int i = 0; i <= 10; ++i) {
        const double t =
            keys.keys[k].frame + (keys.keys[k + 1].frame - keys.keys[k].frame) * i / 10.0;
        if (at(curve, t) >= low && at(curve, t) <= high) continue;
        CAPTURE(round, k, t, low, high);
        REQUIRE(at(curve, t) >= low - 4e-15);
        REQUIRE(at(curve, t) <= high + 4e-15);
      }
    }
  }
}

TEST_CASE("tangents follow their formulas", "[timeline][tangents]") {
  Whim whim(42);
  for (int round = 0; round < rounds(2000); ++round) {
    const CurveKeys<1> keys = keys_with_repeats(whim, 3, TangentKind::Auto);
    const auto& [p, k, n] = std::tie(keys.keys[0], keys.keys[1], keys.keys[2]);
    const double s_p = (k.value[0] - p.value[0]) / (k.frame - p.frame);
    const double s_n = (n.value[0] - k.value[0]) / (n.frame - k.frame);
    const double spline = (n.value[0] - p.value[0]) / (n.frame - p.frame);
    const double f = (k.frame - p.frame) / (n.frame - p.frame);
    const double g = 0.5 + (f - 0.5) * (1.5 - 2 * (f - 0.5) * (f - 0.5));
    const double cap = 3 * std::min(std::fabs(s_p), std::fabs(s_n));
    const bool is_flat = s_p * s_n <= 0;
    const double ease = is_flat ? 0 : std::clamp((1 - g) * s_p + g * s_n, -cap, cap);
    const double plateau = is_flat ? 0 : std::clamp(spline, -cap, cap);
    const auto check = [&](TangentKind kind, double in, double out, double first, double last) {
      const Slopes slopes = slopes_of(with_kinds(keys, kind));
      CAPTURE(round, static_cast<int>(kind));
      const double tolerance = 1e-13 * (1 + std::fabs(s_p) + std::fabs(s_n));
      REQUIRE_THAT(slopes.in[1], WithinAbs(in, tolerance));
      REQUIRE_THAT(slopes.out[1], WithinAbs(out, tolerance));
      REQUIRE_THAT(slopes.out[0], WithinAbs(first, tolerance));
      REQUIRE_THAT(slopes.in[2], WithinAbs(last, tolerance));
    };
    check(TangentKind::Auto, ease, ease, 0, 0);
    check(TangentKind::Plateau, plateau, plateau, 0, 0);
    check(TangentKind::Spline, spline, spline, s_p, s_n);
    check(TangentKind::Linear, s_p, s_n, s_p, s_n);
    check(TangentKind::Flat, 0, 0, 0, 0);
    const auto [low, high] = std::minmax({p.value[0], k.value[0], n.value[0]});
    const bool level_p = std::fabs(k.value[0] - p.value[0]) <= 1e-3 * (high - low);
    const bool level_n = std::fabs(n.value[0] - k.value[0]) <= 1e-3 * (high - low);
    check(TangentKind::Clamped, level_p ? 0 : spline, level_n ? 0 : spline, level_p ? 0 : s_p,
          level_n ? 0 : s_n);
  }
}

TEST_CASE("clamped is flat across a span that hardly changes", "[timeline][tangents]") {
  const Slopes slopes = slopes_of(with_kinds(
      {.keys = {key(0, 0), key(1, 1), key(2, 1.0005), key(3, 0)}}, TangentKind::Clamped));
  CHECK(slopes.out[1] == 0);
  CHECK(slopes.in[2] == 0);
  CHECK_THAT(slopes.in[1], WithinAbs(1.0005 / 2, 1e-15));
  CHECK_THAT(slopes.out[2], WithinAbs(-0.5, 1e-15));
}

TEST_CASE("ends take the secant beside a line", "[timeline][tangents]") {
  for (const auto kind : {TangentKind::Auto, TangentKind::Plateau}) {
    for (const auto outside : {OutsideKind::Linear, OutsideKind::LinearOuter}) {
      CurveKeys<1> keys = with_kinds({.keys = {key(0, 0), key(2, 1), key(4, 8)}}, kind);
      keys.before.kind = outside;
      CHECK(slopes_of(keys).out[0] == 0.5);
      CHECK(slopes_of(keys).in[2] == 0);
      keys.after.kind = outside;
      CHECK(slopes_of(keys).in[2] == 3.5);
      CHECK(slopes_of(keys).out[2] == 3.5);
    }
  }
}

TEST_CASE("a left value parts the tangents of its key", "[timeline][tangents]") {
  const CurveKeys<1> keys = {.keys = {key(0, 0), with_left(key(1, 5), 2), key(2, 6), key(4, 6.5)}};
  const Slopes spline = slopes_of(with_kinds(keys, TangentKind::Spline));
  CHECK(spline.in[1] == 2);
  CHECK(spline.out[1] == 1);
  CHECK_THAT(spline.in[2], WithinAbs(0.5, 1e-15));  // (6.5 - 5) / 3
  const Slopes eased = slopes_of(with_kinds(keys, TangentKind::Auto));
  CHECK(eased.in[1] == 0);
  CHECK(eased.out[1] == 0);
  // After a step the left value is not used.
  CurveKeys<1> stepped = keys;
  stepped.keys[0].next.kind = SegmentKind::Step;
  CHECK(slopes_of(with_kinds(stepped, TangentKind::Spline)).in[1] == 3);
}

TEST_CASE("the seam of a periodic curve is smooth", "[timeline][tangents]") {
  Whim whim(43);
  for (int round = 0; round < 500; ++round) {
    for (const auto kind : {TangentKind::Auto, TangentKind::Spline, TangentKind::Plateau,
                            TangentKind::Smooth, TangentKind::Free}) {
      CurveKeys<1> keys = keys_with_repeats(whim, 2 + whim.upto(4), kind);
      keys.before.kind = OutsideKind::RepeatOffset;
      if (whim.once_in(2)) {
        keys.before.kind = OutsideKind::Hold;
        keys.after.kind = OutsideKind::Repeat;
        keys.keys.back().value = keys.keys.front().value;
      }
      const Slopes slopes = slopes_of(keys);
      CAPTURE(round, static_cast<int>(kind));
      REQUIRE_THAT(slopes.in.back(), WithinAbs(slopes.out.front(), 1e-12));
      REQUIRE(slopes.in.front() == slopes.in.back());
    }
  }
  CurveKeys<1> open = keys_with_repeats(whim, 4, TangentKind::Spline);
  open.after.kind = OutsideKind::Repeat;  // but the values differ
  CHECK(slopes_of(open).in.back() != slopes_of(open).out.front());
}

}  // namespace
}  // namespace pliant::testing
