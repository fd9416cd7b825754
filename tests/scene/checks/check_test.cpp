#include "pliant/scene/checks/check.hpp"

#include <limits>
#include <string>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

TEST_CASE("names begin with a letter or underscore", "[scene][check]") {
  for (const std::string text : {"a", "_", "Sheet_2", "a-b", "_9-"}) CHECK(is_name(text));
  for (const std::string text : {"", "2a", "-a", "a b", "a.b", "ä", " a", "a/b"}) {
    CAPTURE(text);
    CHECK_FALSE(is_name(text));
  }
}

TEST_CASE("a scene built in code is checked as a whole", "[scene][check]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0})});
  REQUIRE(check_scene(s).empty());
  auto& grid = std::get<GridSheet>(s.surfaces[0].shape);
  const double infinity = std::numeric_limits<double>::infinity();
  std::string expected;
  SECTION("fps 0") {
    s.fps = 0;
    expected = "fps is 0";
  }
  SECTION("fps infinite") {
    s.fps = infinity;
    expected = "fps is inf";
  }
  SECTION("fps tiny") {
    s.fps = 1e-320;
    expected = "fps is 1e-320";
  }
  SECTION("end before start") {
    s.end = 0;
    expected = "end is 0, but must not be before start, which is 1";
  }
  SECTION("too many frames") {
    s.end = 1'000'001;
    expected = "1000001 frames from start 1 to end 1000001 are too many; at most 1000000";
  }
  SECTION("far away") {
    s.end = std::numeric_limits<int>::max();
    expected = "end is 2147483647, but must be from -1000000000 to 1000000000";
  }
  SECTION("a name") {
    s.surfaces[1].name = "2b";
    expected = "the name \"2b\" must be a letter or _";
  }
  SECTION("a name twice") {
    s.forces[0].name = "b";
    expected = "<point> name=\"b\": the name is already used";
  }
  SECTION("a target") {
    s.forces[0].targets = {"a", "c"};
    expected = "f.targets: no surface is named \"c\"";
  }
  SECTION("columns") {
    grid.columns = 2;
    expected = "a.columns is 2, but must be from 3 to 100000000";
  }
  SECTION("rows") {
    grid.rows = -7;
    expected = "a.rows is -7";
  }
  SECTION("vertices") {
    grid.columns = grid.rows = 200'000;
    expected = "200000 x 200000 = 40000000000 vertices";
  }
  SECTION("width") {
    grid.width = 0;
    expected = "width is 0, but must be greater than 0";
  }
  SECTION("depth") {
    grid.depth = 1.7e308;
    expected = "depth is 1.7e+308";
  }
  const auto errors = check_scene(s);
  REQUIRE(errors.size() == 1);
  CHECK_THAT(errors[0].message, Contains(expected));
}

TEST_CASE("every problem is found, each with its line", "[scene][check]") {
  Scene s = scene({sheet("a")}, {poke("a", {0, 0, 0})});
  s.fps = -1;
  s.forces[0].targets = {"x", "y"};
  s.origin = origin_of("s.xml", {{"", 1}, {".fps", 2}, {"a", 5}, {"a.targets", 7}});
  const auto errors = check_scene(s);
  REQUIRE(errors.size() == 4);
  CHECK(errors[0].line == 2);
  CHECK(errors[3].line == 7);
  CHECK(errors[3].file == "s.xml");
}
