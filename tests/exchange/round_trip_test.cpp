#include "exchange/round_trips.hpp"
#include "support/sanitized.hpp"

namespace pliant {
namespace {

using namespace testing;

constexpr double shown_tolerance = 1e-4;

double gap_of(CurveFormat format) { return format == CurveFormat::Maya ? 1.01 / 128 : 1.01 / 1024; }

TEST_CASE("curves of every kind go through each format", "[exchange][round_trip]") {
  const auto format = GENERATE(CurveFormat::Blender, CurveFormat::Gltf, CurveFormat::Maya);
  for (int seed = 1; seed <= rounds(300); ++seed) {
    CAPTURE(static_cast<int>(format), seed);
    Whim whim(static_cast<std::uint64_t>(seed));
    const CurveKeys<1> keys = whim.keys(6);
    const auto curve = Curve<1>::make(keys);
    if (!curve) continue;
    // Keys so close that a repeated curve has thousands of copies: of 30 seeds two, which take
    // thirty times as long as all others, by the same code.
    const bool is_dense = keys.keys.back().frame - keys.keys.front().frame < 0.1;
    if (is_sanitized && is_dense && keys.keys.size() > 1) continue;
    check_round_trip(*curve, format, -30, 60, shown_tolerance, gap_of(format));
  }
}

/// A row of keys with one kind of everything.
CurveKeys<1> row_of(TangentKind tangent, const Interpolation& next, OutsideKind before,
                    OutsideKind after) {
  CurveKeys<1> keys;
  const double values[] = {0, 8, 3, 3, -4};
  for (int k = 0; k < 5; ++k) {
    Key<1> each = key(1 + 6.0 * k, values[k], next);
    each.in = {.kind = tangent, .slope = {0.7}, .handle_frames = -2.5, .handle_value = {1.5}};
    each.out = {.kind = tangent, .slope = {-0.4}, .handle_frames = 3, .handle_value = {-1}};
    keys.keys.push_back(each);
  }
  keys.before = {.kind = before, .slope = {0.25}};
  keys.after = {.kind = after, .slope = {-0.5}};
  return keys;
}

std::vector<CurveKeys<1>> table_of_kinds() {
  std::vector<CurveKeys<1>> rows;
  for (int outside = 0; outside <= 6; ++outside) {
    const auto before = static_cast<OutsideKind>(outside);
    const auto after = static_cast<OutsideKind>((outside * 3 + 1) % 7);
    for (int kind = 0; kind <= 9; ++kind) {
      for (const SegmentKind segment :
           {SegmentKind::Bezier, SegmentKind::Linear, SegmentKind::Step, SegmentKind::StepNext}) {
        rows.push_back(row_of(static_cast<TangentKind>(kind), of_segment(segment), before, after));
      }
    }
    for (int ease = 0; ease <= 9; ++ease)
      for (int side = 0; side <= 2; ++side)
        rows.push_back(row_of(TangentKind::Auto,
                              of_ease(static_cast<Ease>(ease), static_cast<EaseSide>(side)), before,
                              after));
  }
  return rows;
}

TEST_CASE("a table of all kinds goes through each format", "[exchange][round_trip]") {
  const std::vector<CurveKeys<1>> rows = table_of_kinds();
  REQUIRE(rows.size() >= 377);
  const auto format = GENERATE(CurveFormat::Blender, CurveFormat::Gltf, CurveFormat::Maya);
  for (std::size_t row = 0; row < rows.size(); row += is_sanitized ? 11 : 1) {
    CAPTURE(static_cast<int>(format), row);
    check_round_trip(make(rows[row]), format, -20, 60, shown_tolerance, gap_of(format));
  }
}

TEST_CASE("a finer tolerance is kept too", "[exchange][round_trip]") {
  const auto format = GENERATE(CurveFormat::Gltf, CurveFormat::Maya);
  const auto ease = static_cast<Ease>(GENERATE(range(0, 10)));
  CurveKeys<1> keys = row_of(TangentKind::Auto, of_ease(ease, EaseSide::InOut), OutsideKind::Hold,
                             OutsideKind::Hold);
  check_round_trip(make(keys), format, 1, 25, 2e-6, gap_of(format));
}

TEST_CASE("what a format holds goes through without loss", "[exchange][round_trip]") {
  for (const CurveKeys<1>& keys : table_of_kinds()) {
    const Curve<1> curve = make(keys);
    const bool is_easing = keys.keys[0].next.kind == SegmentKind::Easing;
    const bool jumps = keys.keys[0].next.kind == SegmentKind::StepNext;
    const bool is_copied =
        keys.before.kind > OutsideKind::Slope || keys.after.kind > OutsideKind::Slope;
    CurveWriting writing;
    writing.first = -20;
    writing.last = 60;
    const auto losses = [&](CurveFormat format) {
      return write_curves({{"poke.magnitude", curve}}, format, writing)->losses;
    };
    if (!jumps && !is_copied) CHECK(is_exact(losses(CurveFormat::Blender)));
    if (!is_easing && !is_copied) CHECK(is_exact(losses(CurveFormat::Maya)));
  }
}

}  // namespace
}  // namespace pliant
