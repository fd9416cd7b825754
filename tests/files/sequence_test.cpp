#include "pliant/files/sequence.hpp"

#include <sys/stat.h>

#include "files/animated_meshes.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("sequence files carry the frame in their names", "[output][sequence]") {
  CHECK(sequence_file("a/out.obj", 1) == "a/out.0001.obj");
  CHECK(sequence_file("out.obj", 12345) == "out.12345.obj");
  CHECK(sequence_file("out.obj", -3) == "out.-0003.obj");
  CHECK(sequence_file("out.##.obj", 7) == "out.07.obj");
  CHECK(sequence_file("out_######.obj", 7) == "out_000007.obj");
  CHECK(sequence_file("#/o##t#.obj", 7) == "#/o##t7.obj");
  CHECK(sequence_file("v1.2.obj", 7) == "v1.2.0007.obj");
}

TEST_CASE("a sequence is probed ahead, and the probe leaves nothing", "[output][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  CHECK(check_sequence({folder.file("a.obj"), &mesh, 1, 3}));
  CHECK(folder.entry_count() == 0);
  const auto probe = check_sequence({folder.file("none") / "a.obj", &mesh, 1, 3});
  REQUIRE_FALSE(probe);
  CHECK(probe.error().code == ErrorCode::Unwritable);
}

namespace {

/// Writes frames 1, 2, … and returns the counts of kept and written files.
FileCounts resumed(AnimationPlan plan, const std::vector<std::vector<Field>>& frames) {
  plan.resume = true;
  plan.first_frame = 1;
  plan.last_frame = static_cast<int>(frames.front().size());
  auto writer = make_writer(plan).value();
  for (std::size_t k = 0; k < frames.front().size(); ++k) {
    std::vector<SurfacePose> poses;
    for (const auto& of_surface : frames) poses.push_back({of_surface[k]});
    REQUIRE(writer->write(static_cast<int>(k) + 1, poses));
  }
  REQUIRE(writer->finish());
  return writer->file_counts();
}

}  // namespace

TEST_CASE("a sequence that is resumed keeps what would be written, and nothing else",
          "[output][sequence]") {
  const ScratchFolder folder, whole;
  const Mesh mesh = make_mesh({});
  const auto frames = bump(mesh.positions, 4, 12);
  const std::string name = GENERATE("a.obj", "a.ply");
  AnimationPlan plan = plan_of(whole.file(name), mesh);
  REQUIRE(write_all(plan, {frames}));
  plan.file = folder.file(name);
  const auto file = [&](int frame) { return sequence_file(name, frame).string(); };
  const auto bytes_of = [&](int frame) { return read_file(whole.file(file(frame))).value(); };
  for (const int kept : {1, 2, 9, 12}) folder.write(file(kept), bytes_of(kept));
  folder.write(file(3), "");
  folder.write(file(4), bytes_of(4).substr(0, bytes_of(4).size() - 1));
  folder.write(file(5), bytes_of(5) + "\n");
  std::string flipped = bytes_of(6);
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 1);
  folder.write(file(6), flipped);
  folder.write(file(7), bytes_of(8));             // complete, but of another frame
  folder.write(file(13), "beyond the last one");  // not a file of this bake
  // 8, 10 and 11 are missing.
  const auto before = std::filesystem::last_write_time(folder.file(file(2)));

  const FileCounts counts = resumed(plan, {frames});
  CHECK(counts.kept == 4);
  CHECK(counts.written == 8);
  CHECK(std::filesystem::last_write_time(folder.file(file(2))) == before);
  for (int frame = 1; frame <= 12; ++frame) {
    CAPTURE(frame);
    CHECK(read_file(folder.file(file(frame))).value() == bytes_of(frame));
  }
  CHECK(folder.entry_count() == 13);
  CHECK(resumed(plan, {frames}).kept == 12);
}

TEST_CASE("what another scene or mesh wrote is written again", "[output][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({}), other = dressed_sheet();
  AnimationPlan plan = plan_of(folder.file("a.obj"), mesh);
  auto frames = bump(mesh.positions, 4, 6);
  REQUIRE(write_all(plan, {frames}));
  frames[3](4, 1) += 1e-9;  // a key in the middle; the first and the last frame are unchanged
  FileCounts counts = resumed(plan, {frames});
  CHECK(counts.kept == 5);
  CHECK(counts.written == 1);
  counts = resumed(plan_of(folder.file("a.obj"), other), {bump(other.positions, 4, 6)});
  CHECK(counts.kept == 0);
  CHECK(counts.written == 6);
}

TEST_CASE("files of several surfaces are kept each by itself", "[output][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan = plan_of(folder.file("a.##.ply"), mesh);
  plan.surfaces.push_back({"other", &mesh, mesh.positions});
  const auto frames = bump(mesh.positions, 4, 4);
  REQUIRE(write_all(plan, {frames, frames}));
  folder.write("a-other.02.ply", "");
  std::filesystem::remove(folder.file("a-sheet.03.ply"));
  const FileCounts counts = resumed(plan, {frames, frames});
  CHECK(counts.kept == 6);
  CHECK(counts.written == 2);
  for (const char* frame : {"02", "03"}) {
    CHECK(read_file(folder.file(std::string("a-other.") + frame + ".ply")).value() ==
          read_file(folder.file(std::string("a-sheet.") + frame + ".ply")).value());
  }
}

TEST_CASE("what is no regular file in the place of a frame is refused ahead",
          "[output][sequence]") {
  const Mesh mesh = make_mesh({});
  const std::string in_the_way = GENERATE("folder", "link", "dangling", "pipe");
  const ScratchFolder folder;
  AnimationPlan plan = plan_of(folder.file("a.obj"), mesh);
  const auto frames = bump(mesh.positions, 4, 4);
  REQUIRE(write_all(plan, {frames}));
  const auto third = folder.file("a.0003.obj");
  std::filesystem::rename(third, folder.file("kept.obj"));
  if (in_the_way == "folder") std::filesystem::create_directory(third);
  if (in_the_way == "link") std::filesystem::create_symlink("kept.obj", third);
  if (in_the_way == "dangling") std::filesystem::create_symlink("none.obj", third);
  if (in_the_way == "pipe") REQUIRE(mkfifo(third.c_str(), 0600) == 0);
  plan.resume = true;
  plan.first_frame = 1;
  plan.last_frame = 4;
  const auto writer = make_writer(plan);
  REQUIRE_FALSE(writer);
  CHECK(writer.error().code == ErrorCode::InvalidInput);
  CHECK(writer.error().file == third.string());
}

TEST_CASE("one file cannot be resumed", "[output][sequence]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const char* name : {"a.npy", "a.glb", "a.gltf", "a.usda", "a.pc2", "a.mdd"}) {
    AnimationPlan plan = plan_of(folder.file(name), mesh);
    plan.resume = true;
    const auto writer = make_writer(plan);
    REQUIRE_FALSE(writer);
    CHECK_THAT(writer.error().message, contains_text("one file, which cannot be resumed"));
  }
  CHECK(folder.entry_count() == 0);
}
