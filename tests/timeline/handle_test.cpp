#include "pliant/timeline/handle.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "pliant/timeline/curve.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

using Kind = Tangent<1>::Kind;

// The Bézier cubic through the handles of one segment, at the parameter u.
std::pair<double, double> point(const KeyHandle<1>& out, const KeyHandle<1>& in, double u) {
  const double w[] = {(1 - u) * (1 - u) * (1 - u), 3 * u * (1 - u) * (1 - u), 3 * u * u * (1 - u),
                      u * u * u};
  return {
      w[0] * out.key_frame + w[1] * out.frame + w[2] * in.frame + w[3] * in.key_frame,
      w[0] * out.key_value[0] + w[1] * out.value[0] + w[2] * in.value[0] + w[3] * in.key_value[0]};
}

}  // namespace

TEST_CASE("the handles are the control points of the curve", "[timeline][handle]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 300; ++round) {
    CurveKeys<1> keys;
    for (int k = 0; k < 5; ++k) {
      Key<1> key{.frame = 10.0 * k + 3 * number(random), .value = {5 * number(random)}};
      for (Tangent<1>* tangent : {&key.in, &key.out}) {
        tangent->kind = static_cast<Kind>(random() % 9);  // all but Handle
        tangent->slope = {number(random)};
        if (random() % 2) tangent->length = 12 * std::abs(number(random));  // some are too long
      }
      if (random() % 4 == 0) key.left = Value<1>{number(random)};
      keys.keys.push_back(key);
    }
    const auto curve = Curve<1>::make(keys).value();
    const auto& handles = curve.handles();
    REQUIRE(handles.size() == 8);  // two for each of the four segments
    for (std::size_t k = 0; k < handles.size(); k += 2) {
      CHECK(handles[k].frame >= handles[k].key_frame);
      CHECK(handles[k + 1].frame <= handles[k + 1].key_frame);
      for (double u = 0.05; u < 1; u += 0.1) {
        const auto [frame, value] = point(handles[k], handles[k + 1], u);
        const double slope = std::abs(curve.velocity(frame)[0]);
        CHECK(std::abs(curve.value(frame)[0] - value) <= 1e-12 * (1 + slope * 50));
      }
    }
  }
}

TEST_CASE("an upright handle has its tip on its own side of the key", "[timeline][handle]") {
  CurveKeys<1> keys{.keys = {{.frame = 0}, {.frame = 10, .value = {6}}}};
  keys.keys[0].out = {.kind = Kind::Handle, .handle_value = {2}};
  keys.keys[1].in = {.kind = Kind::Handle, .handle_value = {3}};
  const Curve<1> curve = Curve<1>::make(keys).value();
  REQUIRE(curve.handles().size() == 2);
  CHECK(curve.handles()[0].frame == 0);
  CHECK(curve.handles()[0].value[0] == 2);
  CHECK(curve.handles()[1].frame == 10);
  CHECK(curve.handles()[1].value[0] == 9);
}

TEST_CASE("only Bezier segments have handles", "[timeline][handle]") {
  CurveKeys<1> keys;
  keys.keys = {{.frame = 0, .value = {0}}, {.frame = 5, .value = {1}}, {.frame = 9, .value = {2}}};
  keys.keys[0].next.kind = Interpolation::Kind::Linear;
  const auto curve = Curve<1>::make(keys).value();
  REQUIRE(curve.handles().size() == 2);
  CHECK(curve.handles()[0].key_frame == 5);
  CHECK(curve.handles()[1].key_frame == 9);
}
