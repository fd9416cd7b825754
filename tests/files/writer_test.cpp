#include "pliant/files/writer.hpp"

#include <cctype>
#include <numeric>
#include <span>
#include <string>
#include <string_view>

#include "files/animated_meshes.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/stopping.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

AnimationPlan plan(const std::filesystem::path& file, const Mesh& mesh) {
  return {.file = file,
          .surfaces = {{"sheet", &mesh, mesh.positions}},
          .first_frame = 1,
          .last_frame = 1};
}

}  // namespace

TEST_CASE("every known ending has a writer, and no other", "[output][writer]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const std::string& ending : known_endings()) {
    CHECK(make_writer(plan(folder.file("a" + ending), mesh)));
    std::string upper = ending;
    for (char& c : upper) c = static_cast<char>(std::toupper(c));
    CHECK(make_writer(plan(folder.file("a" + upper), mesh)));
  }
  for (const char* name : {"a", "a.xyz", ".npy"}) {
    const auto writer = make_writer(plan(folder.file(name), mesh));
    REQUIRE_FALSE(writer);
    CHECK(writer.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(writer.error().message, Contains("allowed: .npy, .obj, .ply"));
  }
}

TEST_CASE("what will be written is known ahead", "[output][writer]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const std::string& ending : known_endings()) {
    for (const int count : {1, 2}) {
      const ScratchFolder inner;
      AnimationPlan plan{.file = inner.file("a" + ending), .first_frame = 1, .last_frame = 2};
      std::vector<std::vector<Field>> frames;
      for (int k = 0; k < count; ++k) {
        plan.surfaces.push_back(
            {std::string(1, static_cast<char>('x' + k)), &mesh, mesh.positions});
        frames.push_back(bump(mesh.positions, 4, 2));
      }
      REQUIRE(write_all(plan, frames));
      CAPTURE(ending, count);
      int unnamed = 0;
      for (const auto& entry : std::filesystem::directory_iterator(inner.path()))
        unnamed += is_named_at_the_end(plan, entry.path().filename().string()) ? 1 : 0;
      CHECK(unnamed == (ending == ".gltf" ? 1 : 0));
      CHECK(static_cast<int>(files_of(plan).size()) + unnamed == inner.entry_count());
      for (const auto& file : files_of(plan)) CHECK(std::filesystem::exists(file));
    }
  }
}

TEST_CASE("a folder in the way is told ahead", "[output][writer]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const std::string& ending : known_endings()) {
    const bool is_sequence = ending == ".obj" || ending == ".ply";
    std::filesystem::create_directory(folder.file(is_sequence ? "a.0001" + ending : "a" + ending));
    const auto writer = make_writer(plan(folder.file("a" + ending), mesh));
    REQUIRE_FALSE(writer);
    CHECK(writer.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(writer.error().message, Contains("it is a folder"));
    // A path below a file: nobody can write there, not even root.
    folder.write("file", "");
    CHECK_FALSE(make_writer(plan(folder.file("file") / ("a" + ending), mesh)));
  }
}

TEST_CASE("what is in the way of any file is told ahead", "[output][writer]") {
  const Mesh mesh = make_mesh({});
  const auto refused = [&](const AnimationPlan& plan, const char* words) {
    const auto writer = make_writer(plan);
    REQUIRE_FALSE(writer);
    CHECK(writer.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(writer.error().message, Contains(words));
  };
  for (const char* name : {"a.0003.obj", "a.0003.ply", "a.npy", "a.pc2", "a.mdd", "a.obj", "a.glb",
                           "a.gltf", "a.usda"}) {
    const ScratchFolder folder;
    std::filesystem::create_symlink(folder.file("nowhere"), folder.file(name));
    std::string ending = std::filesystem::path(name).extension().string();
    if (std::string_view(name) == "a.obj") ending = ".pc2";  // the mesh beside the cache
    AnimationPlan in_the_way = plan(folder.file("a" + ending), mesh);
    in_the_way.last_frame = 5;
    refused(in_the_way, "symbolic link");
    CHECK(folder.entry_count() == 1);
  }
  // The digits of the frame and of the numbers file count too.
  const ScratchFolder folder;
  const std::string stem(250, 'n');
  refused(plan(folder.file(stem + ".gltf"), mesh), "the folder allows 255");
  refused(plan(folder.file(stem + ".obj"), mesh), "the folder allows 255");
  AnimationPlan two = plan(folder.file(stem + ".npy"), mesh);
  two.surfaces.push_back({"other", &mesh, mesh.positions});
  refused(two, "the folder allows 255");
  two.surfaces.pop_back();
  CHECK(write_all(two, {bump(mesh.positions, 4, 2)}));
}

TEST_CASE("a writer of any format is stopped while it makes its files", "[output][stopping]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({.columns = 300, .rows = 200});
  if (GENERATE(false, true)) {  // a normal and a (u,v) of its own for each corner
    mesh.corner_normals.resize(mesh.corner_vertices.size());
    std::iota(mesh.corner_normals.begin(), mesh.corner_normals.end(), 0);
  }
  for (const std::string& ending : known_endings()) {
    CAPTURE(ending);
    const auto work = [&](const StopRequest& should_stop) -> Result<void> {
      AnimationPlan own = plan(folder.file("a" + ending), mesh);
      own.should_stop = should_stop;
      auto writer = make_writer(own);
      if (!writer) return fail(writer.error());
      SurfacePose pose;
      pose.positions = 2 * mesh.positions;
      if (auto written = (*writer)->write(1, std::span(&pose, 1)); !written) return written;
      return (*writer)->finish();
    };
    check_stops(work, 3);
  }
}
