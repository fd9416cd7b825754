#include "pliant/io/writer.hpp"

#include <cctype>

#include "io/animated_meshes.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

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

TEST_CASE("every known ending has a writer, and no other", "[io][writer]") {
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

TEST_CASE("what will be written is known ahead", "[io][writer]") {
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
      CHECK(static_cast<int>(files_of(plan).size()) == inner.entry_count());
      for (const auto& file : files_of(plan)) CHECK(std::filesystem::exists(file));
    }
  }
}

TEST_CASE("a folder in the way is told ahead", "[io][writer]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const std::string& ending : known_endings()) {
    const bool is_sequence = ending == ".obj" || ending == ".ply";
    std::filesystem::create_directory(folder.file(is_sequence ? "a.0001" + ending : "a" + ending));
    const auto writer = make_writer(plan(folder.file("a" + ending), mesh));
    REQUIRE_FALSE(writer);
    CHECK(writer.error().code == ErrorCode::Unwritable);
    CHECK_THAT(writer.error().message, Contains("it is a folder"));
    // A path below a file: nobody may write there, not even root.
    folder.write("file", "");
    CHECK_FALSE(make_writer(plan(folder.file("file") / ("a" + ending), mesh)));
  }
}
