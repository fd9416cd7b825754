#include <cmath>

#include "exchange/round_trips.hpp"

namespace pliant {
namespace {

using namespace testing;

/// The largest disagreement of a component of `joined` with its curve.
double worst_of(const JoinedCurve& joined, const std::array<const CurveKeys<1>*, 3>& components,
                double first, double last, const Slack& slack) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    const Curve<1> back = Curve<1>::make(component_of(joined.keys, c)).value();
    const Curve<1> own = make(*components[static_cast<std::size_t>(c)]);
    worst = std::max(worst, disagreement(own, back, first, last, slack));
  }
  return worst;
}

TEST_CASE("curves with alike keys are joined as they are", "[exchange][join]") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Whim whim(seed);
    const CurveKeys<1> x = whim.keys(5);
    CurveKeys<1> y = x, z = x;
    for (std::size_t k = 0; k < x.keys.size(); ++k) {
      y.keys[k].value[0] = 3 * x.keys[k].value[0] - 1;
      z.keys[k].value[0] = -x.keys[k].value[0];
      y.keys[k].in.slope[0] += 1;
      z.keys[k].out.handle_value[0] -= 1;
    }
    if (!Curve<1>::make(x) || !Curve<1>::make(y) || !Curve<1>::make(z)) continue;
    const auto joined = join_curves({&x, &y, &z}, {}, 1e-4);
    REQUIRE(joined.has_value());
    CAPTURE(seed);
    CHECK(joined->losses.empty());
    CHECK(component_of(joined->keys, 1).keys.size() == y.keys.size());
    const CurveKeys<1> back = component_of(joined->keys, 1);
    const double first = x.keys.front().frame - 20, last = x.keys.back().frame + 20;
    if (x.overshoot == Overshoot::Limit)
      CHECK(worst_of(*joined, {&x, &y, &z}, first, last, {1e-12, 1e-12}) == 0);
  }
}

TEST_CASE("curves with keys of their own are joined within the tolerance", "[exchange][join]") {
  int joined_count = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    Whim whim(seed);
    std::array<CurveKeys<1>, 3> own;
    for (CurveKeys<1>& keys : own) {
      keys = whim.keys(5);
      // One vector cannot have different copies.
      keys.before = {.kind = static_cast<OutsideKind>(whim.upto(3)), .slope = {0.2}};
      keys.after = {.kind = static_cast<OutsideKind>(whim.upto(3)), .slope = {-0.3}};
    }
    if (!Curve<1>::make(own[0]) || !Curve<1>::make(own[1]) || !Curve<1>::make(own[2])) continue;
    const auto joined = join_curves({&own[0], &own[1], &own[2]}, {}, 1e-4);
    CAPTURE(seed);
    REQUIRE(joined.has_value());
    ++joined_count;
    double first = 1e9, last = -1e9;
    for (const CurveKeys<1>& keys : own) {
      first = std::min(first, keys.keys.front().frame - 10);
      last = std::max(last, keys.keys.back().frame + 10);
    }
    for (int c = 0; c < 3; ++c) {
      const Curve<1> before = make(own[static_cast<std::size_t>(c)]);
      const Curve<1> after = Curve<1>::make(component_of(joined->keys, c)).value();
      const double range = range_of(before, first, last);
      CAPTURE(c);
      CHECK(disagreement(before, after, first, last, {1.01 / 1024, 1.01e-4 * range + 1e-12}) == 0);
    }
  }
  CHECK(joined_count > 50);
}

TEST_CASE("a component without a curve keeps its value", "[exchange][join]") {
  const CurveKeys<1> z{.keys = {key(1, 0), key(20, 5)}};
  const auto joined = join_curves({nullptr, nullptr, &z}, {3, -2, 9}, 1e-4);
  REQUIRE(joined.has_value());
  const Curve<3> curve = Curve<3>::make(joined->keys).value();
  for (const double frame : {-5.0, 1.0, 7.3, 20.0, 90.0}) {
    CHECK(curve.value(frame)[0] == 3);
    CHECK(curve.value(frame)[1] == -2);
    CHECK(curve.value(frame)[2] == make(z).value(frame)[0]);
  }
}

TEST_CASE("a level component gets no keys of its own", "[exchange][join]") {
  Key<1> first = key(1, 5), last = key(20, 5);
  first.out = {.kind = Tangent<1>::Kind::Handle, .handle_frames = 7.41, .handle_value = {0}};
  last.in = {.kind = Tangent<1>::Kind::Handle, .handle_frames = 7.41, .handle_value = {0}};
  const CurveKeys<1> x{.keys = {key(1, 0), key(10, 3), key(20, 5)}}, z{.keys = {first, last}};
  const auto joined = join_curves({&x, nullptr, &z}, {}, 1e-4);
  REQUIRE(joined.has_value());
  CHECK(joined->keys.keys.size() == 3);
  for (const double frame : {1.0, 7.3, 20.0})
    CHECK(Curve<3>::make(joined->keys).value().value(frame)[2] == 5);
}

TEST_CASE("copies that differ cannot be joined", "[exchange][join]") {
  CurveKeys<1> x{.keys = {key(1, 0), key(20, 5)}}, y = x, level{.keys = {key(1, 2), key(20, 2)}};
  x.after.kind = OutsideKind::Repeat;
  y.after.kind = OutsideKind::Mirror;
  const auto broken = join_curves({&x, &y, nullptr}, {}, 1e-4);
  REQUIRE_FALSE(broken.has_value());
  CHECK_THAT(broken.error().message, contains_text("different copies after the keys"));
  // A component that does not change has any.
  const auto joined = join_curves({&x, &level, nullptr}, {}, 1e-4);
  REQUIRE(joined.has_value());
  CHECK(joined->keys.after.kind == Extrapolation<3>::Kind::Repeat);
  const auto none = join_curves({nullptr, nullptr, nullptr}, {}, 1e-4);
  CHECK_FALSE(none.has_value());
}

}  // namespace
}  // namespace pliant
