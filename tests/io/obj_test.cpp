#include "pliant/io/obj.hpp"

#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/read_obj.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("an OBJ sequence reads back exactly, quads, order and (u,v)", "[io][obj]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({.columns = 5, .rows = 4, .triangles = GENERATE(false, true)});
  mesh.corner_uvs[2] = -1;
  auto writer = make_obj_writer({folder.file("a.obj"), &mesh, 1, 3}).value();
  for (int frame = 1; frame <= 3; ++frame) {
    const Field positions = Field::Random(20, 3) * 1e-3;
    REQUIRE(writer->write(frame, positions));
    const Mesh back = read_obj(folder.file("a.000" + std::to_string(frame) + ".obj")).value();
    CHECK(back.positions == positions);
    CHECK(back.uvs == mesh.uvs);
    CHECK(back.face_sizes == mesh.face_sizes);
    CHECK(back.corner_vertices == mesh.corner_vertices);
    CHECK(back.corner_uvs == mesh.corner_uvs);
  }
  REQUIRE(writer->finish());
  CHECK(folder.entry_count() == 3);
}
