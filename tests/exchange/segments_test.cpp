#include "pliant/exchange/segments.hpp"

#include <algorithm>
#include <cmath>

#include "exchange/round_trips.hpp"

namespace pliant::exchange {
namespace {

using namespace testing;

double value_of(const Segments& segments, double frame) {
  const auto key = std::lower_bound(segments.frames.begin(), segments.frames.end(), frame);
  if (key != segments.frames.end() && *key == frame)
    return segments.values[static_cast<std::size_t>(key - segments.frames.begin())];
  const auto k = static_cast<std::size_t>(key - segments.frames.begin());
  const Segment& segment = segments.segments[k - 1];
  return curve_of(segment).value(frame)[0];
}

TEST_CASE("segments are the curve between its keys", "[exchange][segments]") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Whim whim(seed);
    const auto curve = Curve<1>::make(whim.keys(6));
    if (!curve) continue;
    const Segments segments = segments_of(*curve);
    const double range = range_of(*curve, segments.frames.front(), segments.frames.back());
    for (std::size_t k = 0; k < segments.segments.size(); ++k) {
      const Segment& segment = segments.segments[k];
      CAPTURE(seed, k);
      CHECK(curve->value(segments.frames[k])[0] == segments.values[k]);
      CHECK(std::fabs(curve->left_value(segment.end)[0] - segment.to) <= 1e-15 * (1 + range));
      for (int n = 1; n < 20; ++n) {
        const double frame = segment.start + segment.length() * n / 20;
        const Slack slack{1e-13 * (1 + std::fabs(frame)), 1e-12 * (1 + range)};
        CHECK(distance_at(*curve, frame, curve_of(segment).value(frame)[0], slack) <= slack.value);
      }
    }
  }
}

TEST_CASE("copies that are written out are those that the curve shows", "[exchange][segments]") {
  const auto kind = GENERATE(OutsideKind::Repeat, OutsideKind::RepeatOffset, OutsideKind::Mirror);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Whim whim(seed);
    CurveKeys<1> keys = whim.keys(5);
    keys.before = {.kind = kind};
    keys.after = {.kind = kind};
    if (seed % 3 == 0) keys.after.count = 3;
    const auto curve = Curve<1>::make(keys);
    if (!curve || keys.keys.size() < 2) continue;
    const Segments own = segments_of(*curve);
    const double span = own.frames.back() - own.frames.front();
    const double first = own.frames.front() - 2.5 * span, last = own.frames.back() + 4.5 * span;
    const auto segments = with_copies(own, first, last);
    REQUIRE(segments.has_value());
    CHECK(segments->frames.size() == segments->segments.size() + 1);
    CHECK(segments->frames.front() <= first);
    const double end = std::min(last, segments->frames.back());
    const double range = range_of(*curve, first, end);
    for (int n = 0; n <= 300; ++n) {
      const double frame = std::min(first + (end - first) * n / 300, end);
      CAPTURE(static_cast<int>(kind), seed, frame);
      const Slack slack{1e-12 * (1 + std::fabs(first) + std::fabs(end)), 1e-11 * (1 + range)};
      CHECK(distance_at(*curve, frame, value_of(*segments, frame), slack) <= slack.value);
    }
    if (!keys.after.count) continue;
    CHECK_THAT(segments->after.anchor,
               WithinAbs(curve->value(last + 10 * span)[0], 1e-9 * (1 + range)));
  }
}

TEST_CASE("a joint of copies has the value of the nearer one", "[exchange][segments]") {
  CurveKeys<1> keys{.keys = {key(0, 1, of_segment(SegmentKind::Linear)), key(10, 5)}};
  keys.before.kind = keys.after.kind = OutsideKind::Repeat;
  const Curve<1> curve = make(keys);
  const auto segments = with_copies(segments_of(curve), -20.0, 30.0);
  REQUIRE(segments.has_value());
  for (std::size_t k = 0; k < segments->frames.size(); ++k)
    CHECK(segments->values[k] == curve.value(segments->frames[k])[0]);
}

TEST_CASE("parts of a segment are the segment", "[exchange][segments]") {
  Whim whim(5);
  for (int n = 0; n < 300; ++n) {
    Segment segment{.kind = Segment::Kind::Bezier,
                    .start = 2,
                    .end = 10,
                    .from = whim.between(-3, 3),
                    .to = whim.between(-3, 3),
                    .out = {whim.between(0, 8), whim.between(-5, 5)},
                    .in = {whim.between(0, 8), whim.between(-5, 5)}};
    const Curve<1> whole = curve_of(segment);
    const double frame = whim.between(2.5, 9.5);
    const Cut parts = cut(segment, frame);
    CHECK(parts.left.end == frame);
    CHECK(parts.left.to == parts.right.from);
    for (const Segment& part : {parts.left, parts.right}) {
      const Curve<1> curve = curve_of(part);
      for (int k = 0; k <= 20; ++k) {
        const double at = part.start + part.length() * k / 20;
        CAPTURE(n, frame, at);
        CHECK(distance_at(whole, at, curve.value(at)[0], {1e-10, 1e-11}) <= 1e-11);
      }
    }
  }
}

TEST_CASE("handles longer than their segment become shorter ones", "[exchange][segments]") {
  // Pairs of lengths on and in the ellipse with one beyond 1.
  for (const auto& [a, b] : {std::pair(1.2, 0.4), {4.0 / 3, 1.0 / 3}, {1.1, 0.15}, {0.3, 1.25}}) {
    const Segment segment{.kind = Segment::Kind::Bezier,
                          .start = 0,
                          .end = 12,
                          .from = 1,
                          .to = 4,
                          .out = {12 * a, 2},
                          .in = {12 * b, 3}};
    const Curve<1> whole = curve_of(segment);
    REQUIRE(whole.notes().empty());
    const Cut parts = cut_where_slowest(segment);
    for (const Segment& part : {parts.left, parts.right}) {
      CHECK(part.out.frames <= part.length());
      CHECK(part.in.frames <= part.length());
      const Curve<1> curve = curve_of(part);
      for (int k = 0; k <= 50; ++k) {
        const double at = part.start + part.length() * k / 50;
        CAPTURE(a, b, at);
        CHECK(distance_at(whole, at, curve.value(at)[0], {1e-10, 1e-11}) <= 1e-11);
      }
    }
  }
}

}  // namespace
}  // namespace pliant::exchange
