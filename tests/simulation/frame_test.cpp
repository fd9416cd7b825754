#include "pliant/simulation/frame.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a frame's surfaces are found by name and given in both spaces", "[simulation][frame]") {
  const Field points = Field::Random(7, 3);
  const Transform transform = make_transform({1, 2, 3}, {90, 0, 0}, {2, 2, 2}, RotateOrder::Xyz);
  const Frame frame(4,
                    {SurfaceFrame("a", points, {}, 0.5), SurfaceFrame("b", points, transform, 0)});
  CHECK(frame.number() == 4);
  CHECK(frame.surfaces().size() == 2);
  CHECK(frame.surface("a").positions() == points);
  CHECK(frame.surface("a").peak_displacement() == 0.5);
  CHECK(frame.surface("b").object_positions() == points);
  CHECK(frame.surface("b").positions() == to_world(transform, points));
  CHECK(&frame.surface("b") == &frame.surfaces()[1]);
  CHECK(frame.find_surface("b") == &frame.surfaces()[1]);
  CHECK(frame.find_surface("c") == nullptr);
}
