#include "pliant/timeline/sampler.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a sampler answers like its curve, bit for bit, in any order", "[timeline][sampler]") {
  Whim whim(71);
  for (int round = 0; round < 500; ++round) {
    const CurveKeys<1> keys = whim.keys(12);
    const Curve<1> curve = make(keys);
    Sampler<1> sampler(curve);
    const double from = keys.keys.front().frame - 10;
    const double to = keys.keys.back().frame + 10;
    double t = from;
    for (int i = 0; i < 40; ++i) {
      t = whim.once_in(4) ? whim.between(from, to) : t + whim.between(-0.5, 2);
      if (whim.once_in(4)) {
        t = keys.keys[whim.upto(static_cast<int>(keys.keys.size()) - 1)].frame;
      }
      CAPTURE(round, t);
      REQUIRE(sampler.value(t) == curve.value(t));
      REQUIRE(sampler.left_value(t) == curve.left_value(t));
      REQUIRE(sampler.velocity(t) == curve.velocity(t));
      REQUIRE(sampler.left_velocity(t) == curve.left_velocity(t));
    }
  }
}

TEST_CASE("playback gives the curve's bits forwards, backwards and at every speed",
          "[timeline][sampler]") {
  Whim whim(72);
  for (int round = 0; round < 200; ++round) {
    const CurveKeys<1> keys = whim.keys(40);
    const Curve<1> curve = make(keys);
    const double from = keys.keys.front().frame - 3;
    const double to = keys.keys.back().frame + 3;
    const double step = whim.size(-1, 1);
    Sampler<1> sampler(curve);
    const auto check = [&](double t) {
      if (sampler.value(t) == curve.value(t)) return;
      CAPTURE(round, t);
      REQUIRE(sampler.value(t) == curve.value(t));
    };
    for (double t = from; t < to; t += step) check(t);
    for (double t = to; t > from; t -= step) check(t);
    for (const Key<1>& key : keys.keys) {
      check(key.frame);
      check(std::nextafter(key.frame, 1e300));
      check(std::nextafter(key.frame, -1e300));
    }
  }
  SUCCEED("no difference");
}

}  // namespace
}  // namespace pliant::testing
