#include "pliant/scene/inputs.hpp"

#include <string>
#include <vector>

#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A glTF that refers to these URIs, valid or not.
std::string gltf_with(const std::vector<std::string>& uris) {
  std::string buffers;
  for (const std::string& uri : uris)
    buffers += (buffers.empty() ? "" : ",") + (R"({"byteLength":0,"uri":")" + uri + "\"}");
  return R"({"asset":{"version":"2.0"},"scenes":[{}],"buffers":[)" + buffers + "]}";
}

std::string scene_of_meshes(const std::vector<std::string>& meshes) {
  std::string surfaces;
  for (const std::string& mesh : meshes) {
    surfaces += "<surface name=\"s" + std::to_string(surfaces.size()) + "\"><mesh file=\"" + mesh +
                "\"/></surface>";
  }
  return "<scene version=\"1\" start=\"1\" end=\"2\">" + surfaces + "</scene>";
}

}  // namespace

TEST_CASE("a scene's inputs are all files that reading it opens", "[scene][inputs]") {
  const ScratchFolder folder;
  const auto real = std::filesystem::canonical(folder.path());
  folder.write("a.gltf", gltf_with({"a.bin", "more.bin", "a.bin", "data:;base64,", "../out.bin"}));
  folder.write("b.GLTF", gltf_with({"more.bin"}));
  folder.write("c.gltf", "rubbish");
  const auto file = folder.write(
      "scene.xml", scene_of_meshes({"a.gltf", "b.GLTF", "a.gltf", "c.gltf", "none.glb", "d.obj"}));
  const auto inputs = inputs_of(load_scene(file).value());
  struct Expected {
    std::filesystem::path file;
    std::string_view role;
  };
  const std::string_view mesh = "a mesh of the scene";
  const std::string_view reference = "a file that a mesh of the scene refers to";
  const std::vector<Expected> expected = {{file, "the scene"},
                                          {folder.file("a.gltf"), mesh},
                                          {real / "a.bin", reference},
                                          {real / "more.bin", reference},
                                          {folder.file("b.GLTF"), mesh},
                                          {folder.file("c.gltf"), mesh},
                                          {folder.file("none.glb"), mesh},
                                          {folder.file("d.obj"), mesh}};
  REQUIRE(inputs.size() == expected.size());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    CHECK(inputs[k].file == expected[k].file);
    CHECK(inputs[k].role == expected[k].role);
  }
}

TEST_CASE("the mesh of a collider and its cache are inputs", "[scene][inputs]") {
  const ScratchFolder folder;
  folder.write("a.gltf", gltf_with({"a.bin"}));
  const auto file = folder.write(
      "scene.xml",
      "<scene version=\"1\" start=\"1\" end=\"2\"><collider name=\"c\"><mesh file=\"a.gltf\" "
      "cache=\"a.npy\"/></collider></scene>");
  const Scene scene = load_scene(file).value();
  const auto inputs = inputs_of(scene);
  REQUIRE(inputs.size() == 4);
  CHECK(inputs[1].file == folder.file("a.npy"));
  CHECK(inputs[2].file == folder.file("a.gltf"));
  CHECK(inputs[3].file == std::filesystem::canonical(folder.path()) / "a.bin");
  // It is written as it was read.
  const std::string text = to_xml(scene, folder.path().string()).value();
  CHECK(parse_scene(text, "again.xml", folder.path().string()).value() == scene);
}

TEST_CASE("a scene's root is its folder, another one, or each mesh's own", "[scene][inputs]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.file("shot"));
  folder.write("near.bin", "");
  const auto mesh = folder.write("shot/a.gltf", gltf_with({"../near.bin", "own.bin"}));
  const auto file = folder.write("shot/scene.xml", scene_of_meshes({"a.gltf"}));
  CHECK(inputs_of(load_scene(file).value()).size() == 3);
  CHECK(inputs_of(load_scene(file, folder.path()).value()).size() == 4);
  CHECK(inputs_of(parse_scene(scene_of_meshes({"a.gltf"}), "x", folder.file("shot")).value())
            .size() == 3);
  Scene scene;
  scene.surfaces.push_back({.name = "s", .shape = MeshFile{.path = mesh}});
  CHECK(inputs_of(scene).size() == 2);
  CHECK(inputs_of(Scene{}).empty());
  // Relative to the current folder, not to the folder of a mesh elsewhere.
  const auto parsed = parse_scene(scene_of_meshes({mesh.string()}), "x", "").value();
  CHECK(std::get<MeshFile>(parsed.surfaces.front().shape).root == ".");
}
