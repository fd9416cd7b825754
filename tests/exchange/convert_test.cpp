#include "pliant/exchange/convert.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "exchange/round_trips.hpp"
#include "pliant/exchange/fit.hpp"

namespace pliant::exchange {
namespace {

using namespace testing;

constexpr WantedFrames wanted{-10, 50};

ConvertedCurve converted(const CurveKeys<1>& keys, const Abilities& abilities,
                         double tolerance = 1e-3) {
  return convert(segments_of(make(keys)), abilities, tolerance, wanted).value();
}

TEST_CASE("a format with all abilities keeps everything", "[exchange][hold]") {
  const Abilities all{.has_step_next = true,
                      .has_left_values = true,
                      .has_counted_copies = true,
                      .has_easing = [](const Segment&) { return true; }};
  CurveKeys<1> keys{.keys = {key(0, 1, of_ease(Ease::Elastic, EaseSide::Out)),
                             with_left(key(6, 4, of_segment(SegmentKind::StepNext)), 2),
                             key(12, -1)}};
  keys.after.kind = OutsideKind::Repeat;
  const ConvertedCurve result = converted(keys, all);
  CHECK(result.losses.empty());
  CHECK(result.segments.frames == std::vector<double>{0, 6, 12});
}

TEST_CASE("what a format cannot hold is told once, with the first key and the deviation",
          "[exchange][hold]") {
  const CurveKeys<1> keys{.keys = {key(0, 1, of_ease(Ease::Elastic, EaseSide::Out)),
                                   key(12, 9, of_ease(Ease::Elastic, EaseSide::In)),
                                   key(24, 0, of_ease(Ease::Sine, EaseSide::In)), key(36, 3)}};
  const ConvertedCurve result = converted(keys, {});
  // An elastic jumps at its quiet end.
  REQUIRE(result.losses.size() == 3);
  CHECK_THAT(result.losses[0].message,
             contains_text("2 elastic easings, the first of key 0, became ") &&
                 contains_text(" keys, within 0.000"));
  CHECK_THAT(result.losses[1].message, contains_text("the sine easing of key 24 became "));
  CHECK_THAT(result.losses[2].message, contains_text("2 jumps, the first of key "));
  CHECK_FALSE(result.losses[0].is_exact);
}

TEST_CASE("a level segment is one line, whatever its handles", "[exchange][hold]") {
  Key<1> first = key(1, 5), second = key(21, 5);
  first.out = {.kind = Tangent<1>::Kind::Handle, .handle_frames = 7.8, .handle_value = {0}};
  second.in = {.kind = Tangent<1>::Kind::Handle, .handle_frames = 7.8, .handle_value = {0}};
  for (const double tolerance : {0.0, 1e-3}) {
    const ConvertedCurve result = converted({.keys = {first, second}}, {}, tolerance);
    CHECK(result.losses.empty());
    REQUIRE(result.segments.segments.size() == 1);
    CHECK(make(keys_of(result.segments)).value(9.3)[0] == 5);
  }
}

TEST_CASE("an easing that a jump cuts keeps its shape", "[exchange][hold]") {
  const auto ease = GENERATE(Ease::Sine, Ease::Expo, Ease::Bounce, Ease::Back, Ease::Elastic);
  const auto side = GENERATE(EaseSide::In, EaseSide::Out);
  const Abilities blender{
      .has_steps = true, .has_easing = [](const Segment&) { return true; }, .gap = 1.0 / 1024};
  const CurveKeys<1> keys{
      .keys = {key(1, 0, of_ease(ease, side)), with_left(key(3, 0), 100), key(9, 4)}};
  const ConvertedCurve result = converted(keys, blender, 1e-2);
  const Curve<1> before = make(keys), after = make(keys_of(result.segments));
  CHECK(disagreement(before, after, 1, 3 - 2.0 / 1024, {0, 1e-2}) == 0);
}

TEST_CASE("what becomes too many keys is refused before it is made", "[exchange][hold]") {
  CurveKeys<1> keys;
  for (int k = 0; k < 2000; ++k) {
    Interpolation elastic = of_ease(Ease::Elastic, EaseSide::Out);
    elastic.period = 1e-4;
    keys.keys.push_back(key(k, k % 7, elastic));
  }
  const auto result = convert(segments_of(make(keys)), {}, 1e-6, wanted);
  REQUIRE_FALSE(result.has_value());
  CHECK_THAT(result.error().message, contains_text("would become more than 500000 keys"));
}

TEST_CASE("easings that are cubics become them exactly", "[exchange][hold]") {
  const auto ease = GENERATE(Ease::Quad, Ease::Cubic, Ease::Back, Ease::Bounce);
  const auto side = GENERATE(EaseSide::In, EaseSide::Out, EaseSide::InOut);
  const CurveKeys<1> keys{.keys = {key(2, 1, of_ease(ease, side)), key(14, 9)}};
  const ConvertedCurve result = converted(keys, {.has_long_arms = false});
  for (const Loss& loss : result.losses) CHECK(loss.is_exact);
  const Curve<1> before = make(keys);
  const Curve<1> after = make(keys_of(result.segments));
  CHECK(disagreement(before, after, 2, 14, {1e-13, 1e-13}) == 0);
  if (side != EaseSide::InOut && ease != Ease::Bounce) CHECK(result.segments.segments.size() == 1);
}

TEST_CASE("a jump takes the gap of the format and no more", "[exchange][hold]") {
  const CurveKeys<1> keys{.keys = {key(0, 0, of_segment(SegmentKind::Linear)),
                                   with_left(key(10, 7, of_segment(SegmentKind::Linear)), 5),
                                   key(20, 7)}};
  const ConvertedCurve result = converted(keys, {.gap = 0.25});
  CHECK(result.segments.frames == std::vector<double>{0, 9.75, 10, 20});
  CHECK_THAT(result.segments.values[1], WithinAbs(4.875, 1e-12));
  CHECK(result.segments.segments[1].kind == Segment::Kind::Constant);
  REQUIRE(result.losses.size() == 1);
  CHECK(result.losses[0].message == "the jump of key 10 became a step of 0.25 frames");
  // Without steps it is a ramp.
  const ConvertedCurve ramp = converted(keys, {.has_steps = false, .gap = 0.25});
  CHECK(ramp.segments.segments[1].kind == Segment::Kind::Line);
  CHECK(ramp.segments.segments[1].to == 7);
}

TEST_CASE("copies become keys, as far as frames are wanted", "[exchange][hold]") {
  CurveKeys<1> keys{.keys = {key(0, 0), key(10, 2)}};
  keys.after.kind = OutsideKind::RepeatOffset;
  const ConvertedCurve endless = converted(keys, {.has_copies = false});
  CHECK(endless.segments.frames == std::vector<double>{0, 10, 20, 30, 40, 50});
  CHECK(endless.segments.values.back() == 10);
  REQUIRE(endless.losses.size() == 1);
  CHECK(endless.losses[0].message == "the copies after the keys became 4 keys, up to frame 50");
  CHECK_FALSE(endless.losses[0].is_exact);
  keys.after.count = 2;
  const ConvertedCurve counted = converted(keys, {});
  CHECK(counted.segments.frames == std::vector<double>{0, 10, 20, 30});
  REQUIRE(counted.losses.size() == 1);
  CHECK(counted.losses[0].is_exact);
}

TEST_CASE("a line beyond the keys becomes a key at the wanted frame", "[exchange][hold]") {
  CurveKeys<1> keys{.keys = {key(0, 1), key(10, 2)}};
  keys.after = {.kind = OutsideKind::Slope, .slope = {0.5}};
  const ConvertedCurve result = converted(keys, {.has_lines = false});
  CHECK(result.segments.frames == std::vector<double>{0, 10, 50});
  CHECK(result.segments.values.back() == 22);
}

TEST_CASE("numbers that no program computes with are refused", "[exchange][hold]") {
  const auto problem = [](const CurveKeys<1>& keys) {
    const auto result = convert(segments_of(make(keys)), {}, 1e-3, wanted);
    return result ? "" : result.error().message;
  };
  CHECK_THAT(problem({.keys = {key(0, 0), key(1e8, 1)}}),
             contains_text("key 100000000 is too far away"));
  CHECK_THAT(problem({.keys = {key(0, 0), key(5, 1e40)}}), contains_text("value 1e+40 of key 5"));
  CHECK_THAT(problem({.keys = {key(0, 0), key(1e-9, 1)}}), contains_text("too close"));
}

TEST_CASE("a segment that changes too fast for keys becomes few, and tells what is lost",
          "[exchange][hold]") {
  const double length = GENERATE(0.5, 48.0, 1000.0, 1e6);
  CAPTURE(length);
  CurveKeys<1> keys{.keys = {key(0, 0, of_ease(Ease::Elastic, EaseSide::Out)), key(length, 1)}};
  keys.keys[0].next.period = 1e-7;
  keys.keys[0].next.amplitude = 50;
  const ConvertedCurve result = converted(keys, {});
  const std::size_t most = length < 64 ? 1024 : length < 2000 ? 16'000 : 50'000;
  REQUIRE(!result.losses.empty());
  CHECK_THAT(
      result.losses[0].message,
      contains_text(fmt::format(
          "the elastic easing of key 0 changed too fast and became {} keys, within ", most)));
  CHECK_FALSE(result.losses[0].is_exact);
  CHECK(result.segments.segments.size() <= most + 2);  // jumps at its ends
  CHECK(make(keys_of(result.segments)).keys().keys.size() == result.segments.frames.size());
}

TEST_CASE("a segment that stands upright becomes a steep one, not a spike", "[exchange][hold]") {
  const double to = GENERATE(5.0, -5e6, 1e-9);
  CurveKeys<1> keys{.keys = {key(5, 0), key(15, to)}};
  keys.keys[0].out = {.kind = Tangent<1>::Kind::Handle, .handle_frames = 10};
  keys.keys[1].in = {.kind = Tangent<1>::Kind::Handle, .handle_frames = -10};
  const ConvertedCurve result = converted(keys, {.has_long_arms = false}, 1e-4 * std::fabs(to));
  const Curve<1> curve = make(keys_of(result.segments));
  const double margin = 1e-3 * std::fabs(to);
  for (int k = 0; k <= 100'000; ++k) {
    const double value = curve.value(5 + 1e-4 * k)[0];
    if (value < std::min(0.0, to) - margin || value > std::max(0.0, to) + margin) {
      CAPTURE(k, value);
      FAIL_CHECK();
      break;
    }
  }
  REQUIRE(result.losses.size() == 1);
}

TEST_CASE("cubics that deviate most are halved first", "[exchange][fit]") {
  // A quarter circle is steep at one end only.
  const auto root = [](double frame) { return Value<1>{std::sqrt(1 - frame * frame)}; };
  const auto slope = [](double frame) {
    return Value<1>{-frame / std::sqrt(std::max(0.0, 1 - frame * frame))};
  };
  const SmoothFunction<1> function{root, slope, slope};
  const Fit<1> all = Fitter<1>(function, 1e-4, 1e-12).fit(0, 1);
  REQUIRE(all.is_complete);
  double last = all.deviation;
  CHECK(last <= 1e-4);
  for (std::size_t most = all.cubics.size() - 1; most > 0; --most) {
    const Fit<1> few = Fitter<1>(function, 1e-4, 1e-12, most).fit(0, 1);
    CHECK_FALSE(few.is_complete);
    REQUIRE(few.cubics.size() == most);
    CHECK(few.cubics.front().start == 0);
    CHECK(few.cubics.back().end == 1);
    for (std::size_t k = 1; k < most; ++k) CHECK(few.cubics[k].start == few.cubics[k - 1].end);
    CHECK(few.deviation >= last);
    last = few.deviation;
  }
}

}  // namespace
}  // namespace pliant::exchange
