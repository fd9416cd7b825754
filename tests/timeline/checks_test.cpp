#include "pliant/timeline/checks.hpp"

#include <limits>

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

CurveKeys<1> sound() { return {.keys = {key(0, 1), key(5, 2), key(9, 3)}}; }

struct Fault {
  std::size_t key;
  std::string message;
};

Fault fault_of(const CurveKeys<1>& keys) {
  const auto curve = Curve<1>::make(keys);
  REQUIRE(!curve);
  CHECK(curve.error().message.find('\n') == std::string::npos);
  return {curve.error().index, curve.error().message};
}

#define CHECK_FAULT(index, text, ...)   \
  do {                                  \
    CurveKeys<1> keys = sound();        \
    __VA_ARGS__;                        \
    const Fault fault = fault_of(keys); \
    CHECK(fault.key == (index));        \
    CHECK(fault.message == (text));     \
  } while (false)

TEST_CASE("every rule names the key, the number and itself", "[timeline][checks]") {
  CHECK_FAULT(0, "the curve has no keys; it must have at least one", keys.keys.clear());
  CHECK_FAULT(1, "frame is nan; it must be a finite number", keys.keys[1].frame = none);
  CHECK_FAULT(2, "frame is inf; it must be a finite number", keys.keys[2].frame = infinite);
  CHECK_FAULT(2, "frame is 1e+200; its size must not exceed 1e+150", keys.keys[2].frame = 1e200);
  CHECK_FAULT(2, "frame 5 is not after frame 5 of the previous key; frames must strictly increase",
              keys.keys[2].frame = 5);
  CHECK_FAULT(1, "value is -inf; it must be a finite number", keys.keys[1].value = {-infinite});
  CHECK_FAULT(1, "left value is nan; it must be a finite number",
              keys.keys[1].left = Value<1>{none});
  CHECK_FAULT(1, "slope of the in tangent is nan; it must be a finite number",
              keys.keys[1].in = of_slope(none));
  CHECK_FAULT(1, "slope of the out tangent is nan; it must be a finite number",
              keys.keys[1].out = of_slope(none));
  CHECK_FAULT(1, "length of the out tangent is inf; it must be a finite number",
              keys.keys[1].out.length = infinite);
  CHECK_FAULT(1, "time of the in handle is nan; it must be a finite number",
              keys.keys[1].in = of_handle(none, 0));
  CHECK_FAULT(1, "value of the in handle is nan; it must be a finite number",
              keys.keys[1].in = of_handle(0, none));
}

TEST_CASE("the rules of interpolations", "[timeline][checks]") {
  CHECK_FAULT(0, "control of cubicBezier has x = 1.5; x1 and x2 must be from 0 to 1",
              keys.keys[0].next.kind = SegmentKind::CubicBezier;
              keys.keys[0].next.control = {0.5, 0, 1.5, 0});
  CHECK_FAULT(0, "control of cubicBezier is nan; it must be a finite number",
              keys.keys[0].next.kind = SegmentKind::CubicBezier;
              keys.keys[0].next.control = {0.5, none, 1, 0});
  const Interpolation elastic = of_ease(Ease::Elastic, EaseSide::In);
  CHECK_FAULT(0, "amplitude is nan; it must be a finite number", keys.keys[0].next = elastic;
              keys.keys[0].next.amplitude = none);
  CHECK_FAULT(0, "period is inf; it must be a finite number", keys.keys[0].next = elastic;
              keys.keys[0].next.period = infinite);
  CHECK_FAULT(0, "period is 1e-30; the segment must not have more than 1e15 periods",
              keys.keys[0].next = elastic;
              keys.keys[0].next.period = 1e-30);
  CHECK_FAULT(0, "back is nan; it must be a finite number",
              keys.keys[0].next = of_ease(Ease::Back, EaseSide::In);
              keys.keys[0].next.back = none);
}

TEST_CASE("the rules outside the keys and of loops", "[timeline][checks]") {
  CHECK_FAULT(0, "slope before the keys is nan; it must be a finite number",
              keys.before = (Extrapolation<1>{.kind = OutsideKind::Slope, .slope = {none}}));
  CHECK_FAULT(2, "count of copies after the keys is 2.5; it must be a whole number of at least 1",
              keys.after = (Extrapolation<1>{.kind = OutsideKind::Mirror, .count = 2.5}));
  CHECK_FAULT(0, "count of copies before the keys is 0; it must be a whole number of at least 1",
              keys.before = (Extrapolation<1>{.kind = OutsideKind::Repeat, .count = 0}));
  CHECK_FAULT(0, "from of the loop is nan; it must be a finite number",
              keys.loop = (Loop<1>{.from = none, .to = 9}));
  CHECK_FAULT(0, "offset of the loop is inf; it must be a finite number",
              keys.loop = (Loop<1>{.to = 9, .offset = {infinite}}));
  CHECK_FAULT(0, "loop starts from frame 1; it must be the frame of a key",
              keys.loop = (Loop<1>{.from = 1, .to = 9}));
  CHECK_FAULT(0, "loop ends at frame 5; it must end after frame 5, where it starts",
              keys.loop = (Loop<1>{.from = 5, .to = 5}));
  CHECK_FAULT(0, "loop has -1 copies on one side; the number must not be negative",
              keys.loop = (Loop<1>{.to = 9, .before = -1}));
  CHECK_FAULT(0, "the loop writes out 2147483648 keys; at most 1e+06 are allowed",
              keys.loop = (Loop<1>{.to = 4, .after = 2147483647}));
  CHECK_FAULT(0, "a copy of this key by the loop reaches 2e+150; no number may exceed 1e+150",
              keys.loop = (Loop<1>{.to = 4, .after = 2, .offset = {1e150}}));
}

TEST_CASE("copies that rounding puts on one frame are an error", "[timeline][checks]") {
  CurveKeys<1> keys = {.keys = {key(0, 0), key(1e-9, 1), key(1e9, 2)}};
  keys.loop = Loop<1>{.from = 0, .to = 1e9, .after = 1};
  const Fault fault = fault_of(keys);
  CHECK(fault.key == 1);
  CHECK(fault.message ==
        "a copy of this key by the loop falls on frame 1e+09 together with the previous key; "
        "frames must strictly increase, also after rounding");
}

TEST_CASE("numbers that nobody reads need not be sound", "[timeline][checks]") {
  CurveKeys<1> keys = sound();
  keys.keys[1].in.slope = {none};
  keys.keys[1].in.handle_frames = none;
  keys.keys[1].next.amplitude = none;
  keys.after.slope = {none};
  keys.after.count = none;
  CHECK(Curve<1>::make(keys).has_value());
}

TEST_CASE("no keys at all make an error in every dimension", "[timeline][checks]") {
  CHECK(!Curve<3>::make({}));
  CHECK(!timeline::broken_rule(CurveKeys<3>{.keys = {{}}}));
}

}  // namespace
}  // namespace pliant::testing
