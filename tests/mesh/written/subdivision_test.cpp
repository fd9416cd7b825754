#include "pliant/mesh/written/subdivide.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("a build without OpenSubdiv says so", "[mesh][subdivision][without_opensubdiv]") {
  const Mesh mesh = square(2, 1, 0, true);
  const TriangleSurface surface = make_surface(mesh).value();
  const auto refined = subdivide(mesh, surface, {.levels = 0});
  REQUIRE(refined.has_value() == has_opensubdiv());
  if (refined) return;
  CHECK_THAT(refined.error().message, contains_text("this build has no OpenSubdiv"));
  CHECK(check_subdivision(mesh, surface, {}).error().message == refined.error().message);
}
