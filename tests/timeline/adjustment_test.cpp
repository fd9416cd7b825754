#include "pliant/timeline/adjustment.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/timeline/position.hpp"
#include "pliant/timeline/sampler.hpp"
#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using Catch::Matchers::WithinAbs;

Adjustment random_adjustment(Whim& whim) {
  return {static_cast<Adjustment::Kind>(whim.upto(3)), whim.between(-3, 3)};
}

TEST_CASE("an adjusted curve has the curve's values, adjusted by one rounding",
          "[timeline][adjustment]") {
  Whim whim(91);
  for (int round = 0; round < 400; ++round) {
    const Curve<1> plain = make(whim.keys(8));
    const Adjustment one = random_adjustment(whim);
    const Curve<1> curve = plain.adjusted({one});
    Sampler<1> sampler(curve);
    REQUIRE(curve.adjustments() != nullptr);
    CHECK(*curve.adjustments() == Adjustments<1>{one});
    CHECK(plain.adjustments() == nullptr);
    CHECK(curve.unadjusted() == plain);
    CHECK(plain.unadjusted() == plain);
    const double from = plain.keys().keys.front().frame - 10;
    const double to = plain.keys().keys.back().frame + 10;
    const auto range = curve.range(from, to);
    for (int k = 0; k < 30; ++k) {
      const double t =
          whim.once_in(4)
              ? plain.keys().keys[whim.upto(static_cast<int>(plain.keys().keys.size() - 1))].frame
              : whim.between(from, to);
      const double value = plain.value(t)[0], slope = plain.velocity(t)[0];
      const double wanted = one.kind == Adjustment::Kind::Set     ? one.number
                            : one.kind == Adjustment::Kind::Times ? one.number * value
                            : one.kind == Adjustment::Kind::Plus  ? value + one.number
                                                                  : value;
      CAPTURE(round, t, static_cast<int>(one.kind), one.number);
      REQUIRE(curve.value(t)[0] == wanted);
      REQUIRE(curve.left_value(t)[0] == one.of_value(plain.left_value(t)[0]));
      REQUIRE(curve.velocity(t)[0] == one.of_difference(slope));
      REQUIRE(curve.left_velocity(t)[0] == one.of_difference(plain.left_velocity(t)[0]));
      REQUIRE(sampler.value(t) == curve.value(t));
      REQUIRE(sampler.left_value(t) == curve.left_value(t));
      REQUIRE(sampler.velocity(t) == curve.velocity(t));
      REQUIRE(sampler.left_velocity(t) == curve.left_velocity(t));
      REQUIRE(range.low[0] <= wanted);
      REQUIRE(range.high[0] >= wanted);
    }
  }
}

TEST_CASE("the keys and handles of an adjusted curve lie on it", "[timeline][adjustment]") {
  Whim whim(92);
  for (int round = 0; round < 200; ++round) {
    const Curve<1> plain = make(whim.keys(8));
    const Adjustment one = random_adjustment(whim);
    const Curve<1> curve = plain.adjusted({one});
    REQUIRE(curve.keys().keys.size() == plain.keys().keys.size());
    for (std::size_t k = 0; k < plain.keys().keys.size(); ++k) {
      REQUIRE(curve.keys().keys[k].frame == plain.keys().keys[k].frame);
      REQUIRE(curve.keys().keys[k].value[0] == one.of_value(plain.keys().keys[k].value[0]));
    }
    REQUIRE(curve.handles().size() == plain.handles().size());
    for (std::size_t k = 0; k < plain.handles().size(); ++k) {
      REQUIRE(curve.handles()[k].frame == plain.handles()[k].frame);
      REQUIRE(curve.handles()[k].value[0] == one.of_value(plain.handles()[k].value[0]));
    }
  }
}

TEST_CASE("a curve made of adjusted keys has the adjusted values but for rounding",
          "[timeline][adjustment]") {
  Whim whim(93);
  for (int round = 0; round < 300; ++round) {
    const Curve<1> plain = make(whim.keys(6));
    const Adjustment one = random_adjustment(whim);
    const Curve<1> curve = plain.adjusted({one});
    const Curve<1> again = make(curve.keys());
    const double from = plain.keys().keys.front().frame;
    const double to = plain.keys().keys.back().frame;
    const auto range = curve.range(from, to);
    const double size = std::max(std::abs(range.low[0]), std::abs(range.high[0]));
    for (int k = 0; k < 20; ++k) {
      const double t = whim.between(from, to);
      CAPTURE(round, t, static_cast<int>(one.kind), one.number);
      REQUIRE_THAT(again.value(t)[0], WithinAbs(curve.value(t)[0], 1e-9 * (size + 10)));
    }
  }
}

TEST_CASE("the components of a channel are adjusted apart", "[timeline][adjustment]") {
  CurveKeys<3> keys;
  keys.keys = {{.frame = 0, .value = {1, 2, 3}}, {.frame = 8, .value = {4, -5, 6}}};
  const Curve<3> plain = Curve<3>::make(keys).value();
  const Adjustments<3> adjustments = {Adjustment{Adjustment::Kind::Times, 2},
                                      Adjustment{Adjustment::Kind::Set, 7}, Adjustment{}};
  Channel<3> channel = plain;
  PositionChannel position = plain;
  channel.adjust(adjustments);
  for (int c = 0; c < 3; ++c) {  // one after the other
    Adjustments<3> one;
    one[c] = adjustments[c];
    position.adjust(one);
  }
  CHECK(*channel.adjustments() == adjustments);
  CHECK(*position.adjustments() == adjustments);
  for (const double t : {-1.0, 0.0, 3.3, 8.0, 9.0}) {
    const Value<3> value = plain.value(t);
    const Value<3> wanted = {2 * value[0], 7, value[2]};
    CHECK(channel.at(t) == wanted);
    CHECK(position.at(t) == wanted);
  }
}

TEST_CASE("a constant that is adjusted is a constant", "[timeline][adjustment]") {
  Channel<1> channel = 3.0;
  channel.adjust({Adjustment{Adjustment::Kind::Plus, 0.5}});
  channel.adjust({Adjustment{Adjustment::Kind::Times, 2}});
  CHECK(!channel.is_animated());
  CHECK(channel.adjustments() == nullptr);
  CHECK(channel.at(0)[0] == 7);
}

TEST_CASE("a position on a path is adjusted where it is", "[timeline][adjustment]") {
  const Path path = Path::make({{{0, 0, 0}, {4, 0, 0}, {4, 2, 1}}}, false).value();
  PositionChannel position = PathMotion{path, make({key(0, 0), key(10, 1)})};
  const PositionChannel plain = position;
  position.adjust({Adjustment{}, Adjustment{Adjustment::Kind::Plus, 5},
                   Adjustment{Adjustment::Kind::Times, -1}});
  for (const double t : {0.0, 2.5, 7.0, 10.0}) {
    const Value<3> at = plain.at(t);
    CHECK(position.at(t) == Value<3>{at[0], at[1] + 5, at[2] * -1});
  }
}

}  // namespace
}  // namespace pliant::testing
