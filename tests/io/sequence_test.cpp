#include "pliant/io/sequence.hpp"

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("sequence files carry the frame in their names", "[io][sequence]") {
  CHECK(sequence_file("a/out.obj", 1) == "a/out.0001.obj");
  CHECK(sequence_file("out.obj", 12345) == "out.12345.obj");
  CHECK(sequence_file("out.obj", -3) == "out.-0003.obj");
  CHECK(sequence_file("out.##.obj", 7) == "out.07.obj");
  CHECK(sequence_file("out_######.obj", 7) == "out_000007.obj");
  CHECK(sequence_file("#/o##t#.obj", 7) == "#/o##t7.obj");
  CHECK(sequence_file("v1.2.obj", 7) == "v1.2.0007.obj");
}

TEST_CASE("a sequence is probed ahead, and the probe leaves nothing", "[io][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  CHECK(check_sequence({folder.file("a.obj"), &mesh, 1, 3}));
  CHECK(folder.entry_count() == 0);
  const auto probe = check_sequence({folder.file("none") / "a.obj", &mesh, 1, 3});
  REQUIRE_FALSE(probe);
  CHECK(probe.error().code == ErrorCode::Unwritable);
}
