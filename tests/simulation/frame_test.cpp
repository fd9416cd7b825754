#include "pliant/simulation/frame.hpp"

#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/last_words.hpp"

using namespace pliant;
using namespace pliant::testing;

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

TEST_CASE("a displacement that is no more than rounding is told as 0", "[simulation][frame]") {
  Field points = Field::Zero(4, 3);
  points(1, 0) = 2;
  points(2, 2) = 5;
  // Where the surface is does not count, its size in the world does.
  for (const double size : {1e-6, 1.0, 1e9}) {
    const Transform transform =
        make_transform({1e4, 0, -1e4}, {0, 30, 0}, {size, -size, size}, RotateOrder::Xyz);
    const auto told = [&](double share) {
      return SurfaceFrame("a", points, transform, share * size).told_displacement() / size;
    };
    CHECK(told(0) == 0);
    CHECK(told(1e-300) == 0);
    CHECK(told(1e-15) == 0);
    for (const double share : {1e-9, 1e-3, 1.0, 50.0}) CHECK_THAT(told(share), WithinRel(share));
  }
}

TEST_CASE("a surface that is not there is named, with those that are", "[simulation][frame]") {
  const Field points = Field::Random(7, 3);
  const Frame frame(4, {SurfaceFrame("sheet", points, {}, 0), SurfaceFrame("ball", points, {}, 0)});
  CHECK(frame.no_surface_text("shet") ==
        "the frame has no surface \"shet\"; did you mean \"sheet\"? it has: sheet, ball");
  CHECK(frame.no_surface_text("x\n") == "the frame has no surface \"x\\x0a\"; it has: sheet, ball");
  CHECK(Frame().no_surface_text("a") == "the frame has no surface \"a\"; it has: none");
  const Frame many(4, std::vector<SurfaceFrame>(1000, SurfaceFrame("s", points, {}, 0)));
  CHECK(many.no_surface_text("tea").size() < 200);
}

#ifdef PLIANT_CHECKS
TEST_CASE("to ask for a surface that is not there ends the program and says which",
          "[simulation][frame]") {
  const Frame frame(4, {SurfaceFrame("sheet", Field::Random(7, 3), {}, 0)});
  const std::string said = last_words([&] { (void)frame.surface("shet"); });
  CHECK_THAT(said, contains_text("requirement broken: the frame has no surface \"shet\"; "
                                 "did you mean \"sheet\"? it has: sheet\n"));
}
#endif
