#include "pliant/timeline/track.hpp"

#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("steps hold, and stepNext jumps ahead", "[timeline][track]") {
  const Curve<1> step = make({key(0, 1, of_segment(SegmentKind::Step)), key(4, 2)});
  CHECK(at(step, 0) == 1);
  CHECK(at(step, 3.999) == 1);
  CHECK(step.left_value(4)[0] == 1);
  CHECK(at(step, 4) == 2);
  const Curve<1> next = make({key(0, 1, of_segment(SegmentKind::StepNext)), key(4, 2)});
  CHECK(at(next, 0) == 1);
  CHECK(at(next, 1e-300) == 2);
  CHECK(next.left_value(4)[0] == 2);
  CHECK(next.velocity(0)[0] == 0);
  CHECK(step.left_velocity(4)[0] == 0);
}

TEST_CASE("straight segments are straight to the last bit", "[timeline][track]") {
  const Curve<1> line = make({key(0, 0, of_segment(SegmentKind::Linear)), key(49, 98)});
  for (double t = 0; t <= 49; t += 0.5) CHECK_THAT(at(line, t), WithinAbs(2 * t, 1e-14));
  CHECK(at(line, 24.5) == 49);
  CHECK(line.velocity(7)[0] == 2);
  const Curve<1> level = make({key(0, 0.1), key(0.7, 0.1), key(3.3, 0.1)});
  for (double t = -1; t <= 4; t += 0.01) CHECK(at(level, t) == 0.1);
}

}  // namespace
}  // namespace pliant::testing
