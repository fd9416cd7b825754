#include "pliant/files/read_mesh.hpp"

#include "files/mesh_files.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;

namespace {

const std::string obj =
    "v 0 0 0\nv 1 0 0\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 1 1\no a\nf 1/1 2/2 3/3\no b\nf 3/3 2/2 1/1\n";

std::string complaint_of_file(const std::filesystem::path& file, const std::string& object = {},
                              int uv_set = 0) {
  const auto mesh = read_mesh(file, object, uv_set);
  return mesh ? "none" : to_lines(mesh.error()).front();
}

}  // namespace

TEST_CASE("the ending picks the reader, in any case", "[mesh][read_mesh][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(true);
  Gltf gltf;
  const std::string mesh = fmt::format("{{\"primitives\":[{}]}}", gltf.primitive(sheet));
  const std::string node = "{\"mesh\":0}";
  const std::string dae = collada(sheet, collada_faces(sheet, 0, 8, false),
                                  "<node id=\"n\"><instance_geometry url=\"#g\"/></node>\n");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 0 1\n"
      "3 0 1 2\n";
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"a.gltf", gltf.text(mesh, node)},
           {"a.GlTF", gltf.text(mesh, node)},
           {"a.glb", gltf.glb(mesh, node)},
           {"a.GLB", gltf.glb(mesh, node)},
           {"a.fbx", fbx_text(sheet)},
           {"a.FBX", fbx_binary(sheet)},
           {"a.dae", dae},
           {"a.Dae", dae},
           {"a.ply", ply},
           {"a.PLY", ply},
           {"a.Obj", obj.substr(0, obj.find("o b"))}}) {
    CAPTURE(name);
    CHECK(read_mesh(folder.write(name, text)));
  }
}

TEST_CASE("another ending is refused with those that are read", "[mesh][read_mesh]") {
  const ScratchFolder folder;
  for (const std::string name : {"a.stl", "a", "a.obj.gz", ".obj"}) {
    CHECK_THAT(complaint_of_file(folder.file(name)),
               EndsWith(name + "; allowed: .obj, .ply, .gltf, .glb, .fbx, .dae"));
  }
}

TEST_CASE("object and set of (u,v) reach each reader", "[mesh][read_mesh]") {
  const ScratchFolder folder;
  const auto file = folder.write("a.obj", obj);
  CHECK(read_mesh(file, "b")->corner_vertices == std::vector{2, 1, 0});
  CHECK_THAT(complaint_of_file(file), contains_text("2 objects"));
  CHECK_THAT(
      complaint_of_file(file, "b", 1),
      EndsWith("a.obj: error: the object has 1 UV set, so there is no set 1 (counted from 0)"));
  for (const int uv_set : {-1, 8}) {
    CHECK(complaint_of_file(file, "b", uv_set) == file.string() + ": error: the set of (u,v) is " +
                                                      std::to_string(uv_set) +
                                                      ", but must be from 0 to 7");
  }
  const auto twice = folder.write("b.obj", obj + "o a\nf 1/1 2/2 3/3\n");
  CHECK_THAT(complaint_of_file(twice, "a"), contains_text("2 objects named \"a\""));
}
