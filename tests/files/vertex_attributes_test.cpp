#include <limits>
#include <string>
#include <vector>

#include "files/gltf/gltf_files.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/read_mesh.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

const std::string soft_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nproperty float soft\nproperty uchar red\nproperty list uchar int more\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0.5 255 0\n1 0 0 0.25 0 1 7\n1 0 1 -2 3 0\n0 0 1 1e3 4 0\n4 0 1 2 3\n";

// A triangle with an attribute of each kind.
GltfParts triangle_with(const std::string& accessor = R"("componentType":5126,"count":3)") {
  return {R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
          R"({"bufferView":1,)" +
              accessor + R"(,"type":"SCALAR"})",
          R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12})",
          R"({"attributes":{"POSITION":0,"_SOFT":1,"_FAR":9,"_TEXT":"x"}})",
          floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0.5f, 0.25f, -3})};
}

std::string gltf_problem(const GltfParts& parts, const std::string& name) {
  const std::vector<std::string> names = {name};
  const auto mesh = parse_gltf(parts.text(), "a.gltf", {}, "", 0, names);
  return mesh ? "none" : mesh.error().message;
}

}  // namespace

TEST_CASE("a PLY keeps the vertex properties that are asked for", "[mesh][maps]") {
  const std::vector<std::string> names = {"red", "soft"};
  const Mesh mesh = parse_ply(soft_ply, "a", "", names).value();
  REQUIRE(mesh.attributes.size() == 2);
  CHECK(mesh.attributes[0] == VertexAttribute{"red", {255, 0, 3, 4}});
  CHECK(mesh.attributes[1] == VertexAttribute{"soft", {0.5, 0.25, -2, 1000}});
  const Mesh plain = parse_ply(soft_ply, "a").value();
  CHECK(plain.attributes.empty());
  CHECK(plain.positions == mesh.positions);
  for (const std::string name : {"stiff", "more", ""}) {
    const auto missing = parse_ply(soft_ply, "m.ply", "", std::vector{name});
    REQUIRE_FALSE(missing);
    CHECK(missing.error().file == "m.ply");
    CHECK_THAT(missing.error().message, Contains("the vertices have no number \"" + name +
                                                 R"("; they have "x", "y", "z", "soft", "red")"));
  }
}

TEST_CASE("a glTF keeps the attributes of its author that are asked for", "[mesh][maps]") {
  const std::vector<std::string> names = {"_SOFT"};
  const Mesh mesh = parse_gltf(triangle_with().text(), "a", {}, "", 0, names).value();
  REQUIRE(mesh.attributes.size() == 1);
  CHECK(mesh.attributes[0] == VertexAttribute{"_SOFT", {0.5, 0.25, -3}});
  CHECK(parse_gltf(triangle_with().text(), "a")->attributes.empty());
  // Whole numbers as they are, or as fractions.
  const std::string bytes = R"("componentType":5121,"count":3)";
  CHECK(parse_gltf(triangle_with(bytes).text(), "a", {}, "", 0, names)->attributes[0].values ==
        std::vector<double>{0, 0, 0});
  CHECK(parse_gltf(triangle_with(bytes + R"(,"normalized":true,"byteOffset":2)").text(), "a", {},
                   "", 0, names)
            ->attributes[0]
            .values == std::vector<double>{0, 63.0 / 255, 0});
}

TEST_CASE("an attribute that a glTF does not have is named", "[mesh][maps]") {
  for (const std::string name : {"_HARD", "_FAR", "_TEXT"})
    CHECK_THAT(
        gltf_problem(triangle_with(), name),
        Contains("meshes[0].primitives[0] has no attribute \"" + name + R"("; it has "_SOFT")"));
  CHECK_THAT(gltf_problem(triangle_with(), "POSITION"),
             Contains("attribute \"POSITION\" is not read, only those whose names begin with _; "
                      "it has \"_SOFT\""));
  CHECK_THAT(gltf_problem(triangle_with(R"("componentType":5126,"count":2)"), "_SOFT"),
             Contains("has 3 vertices, but 2 numbers \"_SOFT\""));
  CHECK_THAT(gltf_problem(triangle_with(R"("componentType":5126,"count":4)"), "_SOFT"),
             Contains("accessors[1]"));
  CHECK_THAT(gltf_problem(triangle_with(R"("componentType":5130,"count":3)"), "_SOFT"),
             Contains("componentType 5130"));
  GltfParts parts = triangle_with();
  parts.bytes.replace(36, 12, floats({0, std::numeric_limits<float>::infinity(), 0}));
  CHECK_THAT(gltf_problem(parts, "_SOFT"), Contains("vertex 1: the attribute _SOFT is inf"));
}

TEST_CASE("formats without attributes say so", "[mesh][maps]") {
  const ScratchFolder folder;
  const auto file = folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
  const std::vector<std::string> names = {"soft"};
  CHECK(read_mesh(file));
  const auto mesh = read_mesh(file, "", 0, names);
  REQUIRE_FALSE(mesh);
  CHECK(mesh.error().file == file.string());
  CHECK_THAT(mesh.error().message, Contains(".obj has no attribute \"soft\"; only .ply, .gltf"));
  const auto ply = read_mesh(folder.write("m.ply", soft_ply), "", 0, names);
  CHECK(ply->attributes[0].values[0] == 0.5);
}

TEST_CASE("attributes of a program's mesh have a finite number for each vertex", "[mesh][maps]") {
  Mesh mesh = parse_ply(soft_ply, "a").value();
  mesh.attributes = {{"m", {1, 2, 3}}};
  CHECK_THAT(check_mesh(mesh).error().message, Contains("m has 3 values, but the mesh has 4"));
  mesh.attributes = {{"m", {1, 2, 3, std::numeric_limits<double>::quiet_NaN()}}};
  CHECK_THAT(check_mesh(mesh).error().message, Contains("vertex 3: the attribute m is nan"));
  mesh.attributes = {{"m", {1, 2, 3, 4}}};
  CHECK(check_mesh(mesh));
}
