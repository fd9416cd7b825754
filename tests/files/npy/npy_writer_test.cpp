#include "pliant/files/formats.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/npy.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("a .npy file holds frames x vertices x 3 in C order", "[output][npy]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({.columns = 5, .rows = 4});
  auto writer = make_npy_writer({folder.file("a.npy"), &mesh, 3, 5}).value();
  std::vector<Field> frames;
  for (int frame = 3; frame <= 5; ++frame) {
    frames.push_back(Field::Random(20, 3));
    REQUIRE(writer->write(frame, {frames.back()}));
  }
  CHECK_FALSE(std::filesystem::exists(folder.file("a.npy")));
  REQUIRE(writer->finish());

  const NpyFile npy = NpyFile::read(folder.file("a.npy"));
  CHECK_THAT(npy.header, Catch::Matchers::StartsWith(
                             "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 20, 3), }"));
  CHECK(npy.header.back() == '\n');
  CHECK(npy.offset % 64 == 0);
  REQUIRE(npy.numbers.size() == 3 * 20 * 3);
  for (int frame = 0; frame < 3; ++frame) {
    for (int vertex = 0; vertex < 20; ++vertex) {
      for (int k = 0; k < 3; ++k) {
        CHECK(npy.numbers[(frame * 20 + vertex) * 3 + k] == frames[frame](vertex, k));
      }
    }
  }
}

TEST_CASE("an unfinished .npy file leaves nothing", "[output][npy]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  {
    auto writer = make_npy_writer({folder.file("a.npy"), &mesh, 1, 2}).value();
    REQUIRE(writer->write(1, {mesh.positions}));
  }
  CHECK(folder.entry_count() == 0);
}
