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

}  // namespace
}  // namespace pliant::testing
