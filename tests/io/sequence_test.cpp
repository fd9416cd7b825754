#include "pliant/io/sequence.hpp"

#include "io/animated_meshes.hpp"
#include "pliant/core/read_file.hpp"
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

TEST_CASE("a sequence is resumed after its last whole frame", "[io][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const auto frames = bump(mesh.positions, 4, 6);
  const std::string name = GENERATE("a.obj", "a.ply");
  AnimationPlan plan = plan_of(folder.file(name), mesh);
  REQUIRE(write_all(plan, {{frames[0], frames[1], frames[2]}}));
  folder.write(sequence_file(name, 2).string(),
               "touched");  // only the first and the last are looked at
  folder.write(sequence_file(name, 5).string(), "stale");  // behind a gap
  plan.resume = true;
  REQUIRE(write_all(plan, {frames}));
  CHECK(folder.entry_count() == 6);
  CHECK(read_file(folder.file(sequence_file(name, 2).string())).value() == "touched");

  const ScratchFolder whole;
  plan.file = whole.file(name);
  REQUIRE(write_all(plan, {frames}));
  for (const int frame : {1, 3, 4, 5, 6}) {
    const std::string file = sequence_file(name, frame).string();
    CHECK(read_file(folder.file(file)).value() == read_file(whole.file(file)).value());
  }
}

TEST_CASE("what another scene wrote is not resumed", "[io][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const auto frames = bump(mesh.positions, 4, 6);
  AnimationPlan plan = plan_of(folder.file("a.obj"), mesh);
  REQUIRE(write_all(plan, {{frames[0], frames[1], frames[2]}}));
  const auto third = folder.file("a.0003.obj");
  const std::string bytes = read_file(third).value();
  for (const std::string& other :
       {bytes + "\n", bytes.substr(0, bytes.size() - 1), std::string()}) {
    folder.write("a.0003.obj", other);
    plan.resume = true;
    const auto resumed = write_all(plan, {frames});
    REQUIRE_FALSE(resumed);
    CHECK(resumed.error().file == third.string());
    CHECK_THAT(resumed.error().message, contains_text("cannot be resumed"));
    CHECK(folder.entry_count() == 3);
  }
}

TEST_CASE("one file cannot be resumed", "[io][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const char* name : {"a.npy", "a.glb", "a.gltf", "a.usda", "a.pc2", "a.mdd"}) {
    AnimationPlan plan = plan_of(folder.file(name), mesh);
    plan.resume = true;
    const auto writer = make_writer(plan);
    REQUIRE_FALSE(writer);
    CHECK_THAT(writer.error().message, contains_text("whole at its end only"));
  }
  CHECK(folder.entry_count() == 0);
}
