#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "files/boxed/boxed_programs.hpp"
#include "files/mesh_files.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/files/boxed/boxed_reader.hpp"
#include "pliant/files/open_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;

namespace {

Result<Mesh> misread(const std::filesystem::path& file, const std::string& what,
                     const RunContext& context = {}) {
  return read_boxed(misbehaving(), OpenFile::open(file).value(), what, 0, context);
}

std::string boxed_complaint(const std::filesystem::path& file, const std::string& what) {
  const auto mesh = misread(file, what);
  if (mesh) return "none";
  CHECK(mesh.error().code == ErrorCode::InvalidInput);
  return to_lines(mesh.error()).front();
}

}  // namespace

TEST_CASE("whatever becomes of the reader is one line that names the file",
          "[mesh][read_boxed][threads][boxed]") {
  const ScratchFolder folder;
  const auto file = folder.write("a.fbx", "1234567");
  const auto check = [&](const std::string& what, const std::string& expected) {
    CAPTURE(what);
    CHECK_THAT(boxed_complaint(file, what), EndsWith("a.fbx: error: the FBX reader " + expected +
                                                     ": the file is broken or hostile"));
  };
  check("crash", "crashed on this file (signal 11, Segmentation fault)");
  check("abort", "crashed on this file (signal 6, Aborted)");
  check("give up", "failed with exit code 3");
  check("rubbish", "produced something that is not a mesh");
  check("uninitialised", "produced two different meshes from this file");
  check("nothing", "produced something that is not a mesh");
  check("allocate", "needs more than 537 MB of memory for a file of 7 B");
  check("flood", "produced more than 134 MB from this file of 7 B");
  CHECK_THAT(boxed_complaint(folder.write("b.dae", ""), "crash"),
             contains_text("the Collada reader"));
}

TEST_CASE("what the reader says is one short line", "[mesh][read_boxed][threads][boxed]") {
  const ScratchFolder folder;
  const std::string told = boxed_complaint(folder.write("a.fbx", ""), "tell lies");
  CHECK_THAT(told, contains_text("the file cannot be read: ?[2Jgo and \"run\" thisxxx"));
  CHECK(told.find_first_of("\x1b\n") == std::string::npos);
  CHECK(told.size() < 400);
}

TEST_CASE("a budget below the file's own bound is memory that is short",
          "[mesh][read_boxed][threads][boxed]") {
  const ScratchFolder folder;
  const auto file = folder.write("a.fbx", std::string(1 << 20, 'x'));
  MemoryBudget little(1000);
  const auto mesh = misread(file, "allocate", {.memory = &little});
  REQUIRE_FALSE(mesh);
  CHECK(mesh.error().code == ErrorCode::OutOfMemory);
  CHECK_THAT(mesh.error().message, contains_text("537 MB"));
}

TEST_CASE("time and memory grow with the file", "[mesh][read_boxed]") {
  const BoxLimits small = box_limits(0, SIZE_MAX), large = box_limits(100'000'000, SIZE_MAX);
  CHECK(small.memory == std::size_t{512} << 20);
  CHECK(small.seconds == 60);
  CHECK(large.seconds == 160);
  CHECK(large.memory == small.memory + 4'000'000'000);
  CHECK(box_limits(100'000'000, 1'000'000'000).memory == 1'000'000'000);
}

TEST_CASE("reading ends when its caller wants to stop", "[mesh][read_boxed][threads][boxed]") {
  const ScratchFolder folder;
  const auto mesh =
      misread(folder.write("a.fbx", ""), "spin", {.should_stop = [] { return true; }});
  REQUIRE_FALSE(mesh);
  CHECK(mesh.error().code == ErrorCode::Interrupted);
}

// An answer through all stages: the file contains the answer of the program.
TEST_CASE("no answer makes a mesh that is none", "[mesh][read_boxed][threads][boxed]") {
  const ScratchFolder folder;
  const int input = open(folder.write("a.fbx", fbx_binary(small_sheet(false))).c_str(), O_RDONLY);
  std::string whole =
      run_boxed(reader(), {"fbx", "", "0"}, input, box_limits(0, SIZE_MAX), {})->answer;
  close(input);
  // The object then has the name of the behaviour requested from the program.
  whole.replace(whole.find("cloth"), 5, "echo");
  const std::size_t length_at = 8 + 4 + 4;
  whole[length_at] = 4;
  const auto file = folder.file("b.fbx");
  const auto read = [&](const std::string& answer) {
    folder.write("b.fbx", answer);
    return misread(file, "echo");
  };
  REQUIRE(read(whole));
  CHECK(read(whole)->face_sizes == std::vector<int>(4, 4));
  std::mt19937 random(1);
  int meshes = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string mutant = whole;
    for (int k = 0; k < 2; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
    const auto mesh = read(mutant);
    meshes += mesh.has_value();
    if (mesh) CHECK(check_mesh(*mesh));
    if (!mesh) CHECK(mesh.error().code == ErrorCode::InvalidInput);
  }
  CHECK(meshes > 50);
}
