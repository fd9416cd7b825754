#include "pliant/core/file_ending.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("an ending is that of the name, in lower case", "[core][file_ending]") {
  CHECK(ending_of("Head.OBJ") == ".obj");
  CHECK(ending_of("a.b/c.0001.Ply") == ".ply");
  CHECK(ending_of("a.obj/c").empty());
  CHECK(ending_of(".npy").empty());  // a hidden file's name
}
