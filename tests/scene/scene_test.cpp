#include "pliant/scene/scene.hpp"

#include "support/catch.hpp"

namespace pliant {
namespace {

TEST_CASE("the line of a channel is its own, else its element's, else 0", "[scene]") {
  SceneOrigin origin;
  origin.lines = {{"", 1}, {".fps", 1}, {"sheet", 4}, {"sheet.density", 7}};
  CHECK(origin.line_of("sheet") == 4);
  CHECK(origin.line_of("sheet", "density") == 7);
  CHECK(origin.line_of("sheet", "damping") == 4);
  CHECK(origin.line_of("poke", "magnitude") == 0);
  CHECK(origin.line_of("", "fps") == 1);
  CHECK(SceneOrigin{}.line_of("sheet", "density") == 0);
}

}  // namespace
}  // namespace pliant
