#include "pliant/feedback/scaled_channel.hpp"

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::WithinAbs;

TEST_CASE("a number is rounded to 4 digits, of its own or of a smaller range",
          "[feedback][suggest]") {
  CHECK(rounded(0) == 0);
  CHECK(rounded(1234.5678) == 1235);
  CHECK(rounded(-1234.5678) == -1235);
  CHECK(rounded(0.00123456) == 0.001235);
  CHECK(rounded(9.99999e200) == 1e201);
  CHECK(rounded(1234.5678, 1e6) == 1235);
  CHECK(rounded(1234.5678, 0.4) == 1234.5678);
  CHECK(rounded(1234.56789, 40) == 1234.57);
}

TEST_CASE("a curve keeps its timing, and is the same times a number", "[feedback][suggest]") {
  CurveKeys<1> keys;
  keys.keys.resize(5);
  for (int k = 0; k < 5; ++k) {
    keys.keys[k].frame = 1 + 7.25 * k;
    keys.keys[k].value = {k % 2 == 0 ? 100.0 + k : -30.5 * k};
  }
  keys.keys[0].out = {.kind = Tangent<1>::Kind::Slope, .slope = {12.5}};
  keys.keys[1].in = {.kind = Tangent<1>::Kind::Handle, .handle_frames = -2, .handle_value = {7}};
  keys.keys[1].next = {.kind = Interpolation::Kind::Easing,
                       .ease = Ease::Elastic,
                       .side = EaseSide::Out,
                       .amplitude = 300,
                       .period = 3};
  keys.keys[3].left = Value<1>{55};
  keys.before = {.kind = Extrapolation<1>::Kind::Slope, .slope = {2}};
  keys.loop = Loop<1>{.from = 1, .to = 22.75, .before = 0, .after = 2, .offset = {4}};
  const Channel<1> channel(Curve<1>::make(keys).value());
  for (const double factor : {0.5, 2.0, 1234.0, 1e-5}) {
    const Channel<1> other = scaled(channel, factor).value();
    for (double frame = -10; frame < 80; frame += 0.37) {
      CAPTURE(factor, frame);
      CHECK_THAT(other.at(frame)[0], WithinAbs(factor * channel.at(frame)[0], 0.3 * factor));
    }
    REQUIRE(other.curve().keys().keys.size() == 5);
    for (int k = 0; k < 5; ++k) CHECK(other.curve().keys().keys[k].frame == keys.keys[k].frame);
  }
  CHECK(farthest_value(channel) == 104);
  CHECK(farthest_value(scaled(channel, 2).value()) == 208);
  CHECK(scaled(Channel<1>(-3.0), 1.23456).value().at(0)[0] == -3.704);
  CHECK_FALSE(scaled(channel, 1e149));
}
