#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include "files/animated_meshes.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("an OBJ sequence reads back exactly, quads, order and (u,v)", "[output][obj]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({.columns = 5, .rows = 4, .triangles = GENERATE(false, true)});
  mesh.corner_uvs[2] = -1;
  auto writer = make_obj_writer({folder.file("a.obj"), &mesh, 1, 3}).value();
  for (int frame = 1; frame <= 3; ++frame) {
    const Field positions = Field::Random(20, 3) * 1e-3;
    REQUIRE(writer->write(frame, {positions}));
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

TEST_CASE("materials, groups and shading come back from an OBJ", "[output][obj]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  auto writer = make_obj_writer({folder.file("a.obj"), &mesh, 1, 1}).value();
  Field positions = mesh.positions + 0.2 * Field::Random(12, 3);
  REQUIRE(writer->write(1, {positions}));
  const Mesh back = read_obj(folder.file("a.0001.obj")).value();
  CHECK(back.object == "Sheet");
  CHECK(back.materials == mesh.materials);
  CHECK(back.groups == mesh.groups);
  CHECK(back.corner_normals == mesh.corner_normals);
}

TEST_CASE("names that would break a line of an OBJ do not", "[output][obj]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({});
  mesh.object = "a\nb";
  mesh.materials = {{"x # y\\"}, {0, 0, 0, 0}};
  REQUIRE(make_obj_writer({folder.file("a.obj"), &mesh, 1, 1}).value()->write(1, {mesh.positions}));
  const Mesh back = read_obj(folder.file("a.0001.obj")).value();
  CHECK(back.object == "a_b");
  CHECK(back.materials.names == std::vector<std::string>{"x _ y_"});
}

TEST_CASE("assimp finds the vertices of an OBJ and of a PLY", "[output][obj]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({.columns = 5, .rows = 4});
  const Field positions = Field::Random(20, 3);
  REQUIRE(make_obj_writer({folder.file("a.obj"), &mesh, 1, 1}).value()->write(1, {positions}));
  REQUIRE(make_ply_writer({folder.file("a.ply"), &mesh, 1, 1}).value()->write(1, {positions}));
  for (const char* name : {"a.0001.obj", "a.0001.ply"}) {
    Assimp::Importer importer;
    const aiScene* const scene = importer.ReadFile(folder.file(name).string(), 0);
    REQUIRE(scene);
    REQUIRE(scene->mNumMeshes == 1);
    const aiMesh& found = *scene->mMeshes[0];
    REQUIRE(found.mNumFaces == 12);
    for (unsigned face = 0; face < 12; ++face) {
      REQUIRE(found.mFaces[face].mNumIndices == 4);
      for (unsigned k = 0; k < 4; ++k) {
        const aiVector3D& at = found.mVertices[found.mFaces[face].mIndices[k]];
        const int vertex = mesh.corner_vertices[4 * face + k];
        CHECK_THAT(at.x, WithinAbs(positions(vertex, 0), 1e-7));
        CHECK_THAT(at.y, WithinAbs(positions(vertex, 1), 1e-7));
        CHECK_THAT(at.z, WithinAbs(positions(vertex, 2), 1e-7));
      }
    }
  }
}
