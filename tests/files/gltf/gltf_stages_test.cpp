#include <bit>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "files/gltf/gltf_files.hpp"
#include "pliant/files/gltf/gltf_accessor.hpp"
#include "pliant/files/gltf/gltf_buffers.hpp"
#include "pliant/files/gltf/gltf_container.hpp"
#include "pliant/files/gltf/gltf_document.hpp"
#include "pliant/files/gltf/gltf_object.hpp"
#include "pliant/files/gltf/gltf_scene.hpp"
#include "support/catch.hpp"

// Each stage of the reader by itself; read_gltf_test.cpp and broken_gltf_test.cpp test all of them
// in a row.

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

std::string chunk(const std::string& kind, const std::string& bytes) {
  return little_endian(bytes.size(), 4) + kind + bytes;
}

std::string glb_of(const std::string& chunks) {
  return "glTF" + little_endian(2, 4) + little_endian(12 + chunks.size(), 4) + chunks;
}

// A document with one mesh of one triangle; nodes and roots are to be added.
gltf::Document triangle_document() {
  gltf::Document document;
  document.accessors = {{.component_type = 5126, .count = 3, .type = "VEC3"}};
  document.meshes = {{"weave", {{.positions = 0}}}};
  return document;
}

}  // namespace

TEST_CASE("a glTF's container gives back the chunks of a .glb", "[mesh][gltf]") {
  const std::string json = chunk("JSON", "{} ");
  const std::string binary = chunk(std::string("BIN\0", 4), "12345"), other = chunk("MORE", "?");
  struct Case {
    std::string bytes;
    std::optional<std::string> binary;
  };
  for (const Case& each :
       {Case{glb_of(json), {}}, Case{glb_of(json + binary), "12345"},
        Case{glb_of(json + other + binary), "12345"},
        Case{glb_of(json + binary + chunk(std::string("BIN\0", 4), "6")), "12345"}}) {
    const auto container = gltf::open_container(each.bytes);
    REQUIRE(container);
    CHECK(container->json == "{} ");
    CHECK(container->binary == each.binary);
  }
  for (std::size_t size = 4; size < glb_of(json + binary).size(); ++size) {
    CHECK_FALSE(gltf::open_container(glb_of(json + binary).substr(0, size)));
  }
  CHECK(gltf::open_container("{}")->json == "{}");  // a .gltf
}

TEST_CASE("a glTF's document has indices within its lists only", "[mesh][gltf]") {
  const auto document = [](const std::string& view, const std::string& mesh) {
    return gltf::read_document(
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":)" + mesh +
        R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)" +
        R"("accessors":[{"bufferView":)" + view +
        R"(,"componentType":5126,"count":3,"type":"VEC3"}],)" +
        R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})");
  };
  const auto sound = document("0", "0");
  REQUIRE(sound);
  CHECK(sound->accessors[0].view == 0);
  CHECK(sound->nodes[0].mesh == 0);
  CHECK(sound->nodes[0].to_parent == Eigen::Matrix4d::Identity());
  CHECK(sound->roots == std::vector<std::size_t>{0});
  for (const std::string bad : {"1", "-1", "18446744073709551615", "0.5", "\"0\""}) {
    CAPTURE(bad);
    REQUIRE_FALSE(document(bad, "0"));
    CHECK_THAT(document(bad, "0").error().message, Contains("accessors[0].bufferView"));
    REQUIRE_FALSE(document("0", bad));
    CHECK_THAT(document("0", bad).error().message, Contains("nodes[0].mesh"));
  }
}

TEST_CASE("a glTF's buffers are read once, and cut to their size", "[mesh][gltf]") {
  gltf::Document document;
  document.buffers = {{.size = 3}, {.size = 4, .uri = "a.bin"}, {.size = 9, .uri = "a.bin"}};
  int reads = 0;
  const ReadReference read = [&](const std::string&, std::size_t) -> Result<std::string> {
    ++reads;
    return "abcdefg";
  };
  gltf::Buffers buffers(document, "12345", 100, read);
  CHECK(reads == 0);
  CHECK(buffers.bytes(0).value() == "123");
  CHECK(buffers.size_so_far() == 100);
  for (int k = 0; k < 3; ++k) CHECK(buffers.bytes(1).value() == "abcd");
  CHECK(reads == 1);
  CHECK(buffers.size_so_far() == 107);
  CHECK_FALSE(buffers.bytes(2));  // truncated
}

TEST_CASE("a file that a glTF refers to by several names is read once", "[mesh][gltf]") {
  gltf::Document document;
  for (const char* uri : {"a.bin", "./a.bin", "b/../a.bin", "b.bin"})
    document.buffers.push_back({.size = 2, .uri = uri});
  std::string reads;
  const ReadReference read = [&](const std::string& uri, std::size_t) -> Result<std::string> {
    reads += uri + " ";
    return "xyz";
  };
  gltf::Buffers buffers(document, {}, 100, read,
                        [](const std::string& uri) { return uri.substr(uri.rfind('/') + 1); });
  for (std::size_t k = 0; k < 4; ++k) CHECK(buffers.bytes(k).value() == "xy");
  CHECK(reads == "a.bin b.bin ");
  CHECK(buffers.size_so_far() == 106);
}

TEST_CASE("a glTF's accessor is the same numbers, however they lie", "[mesh][gltf]") {
  std::string bytes = "??";
  std::vector<double> expected;
  for (int k = 0; k < 5; ++k) {
    bytes += floats({1.5F * static_cast<float>(k), -2, 0.25F}) + "pad!";
    expected.insert(expected.end(), {1.5 * k, -2, 0.25});
  }
  std::string tight;
  for (std::size_t k = 0; k < 5; ++k) tight += bytes.substr(2 + 16 * k, 12);
  gltf::Document document;
  document.buffers = {{.size = bytes.size() + tight.size()}};
  document.views = {{0, 2, bytes.size() - 2, 16}, {0, bytes.size(), tight.size(), 0}};
  for (const std::size_t view : {0, 1}) {
    document.accessors.push_back(
        {.view = view, .component_type = 5126, .count = 5, .type = "VEC3"});
  }
  document.accessors.push_back({.component_type = 5126, .count = 5, .type = "VEC3"});
  const std::string all = bytes + tight;
  const ReadReference none;
  gltf::Buffers buffers(document, all, all.size(), none);
  gltf::AccessorReader reader(document, buffers);
  CHECK(reader.vectors(0, 3).value() == expected);
  CHECK(reader.vectors(1, 3).value() == expected);
  CHECK(reader.vectors(2, 3).value() == std::vector<double>(15, 0.0));
  CHECK_FALSE(reader.vectors(0, 2));
  CHECK_FALSE(reader.indices(0));
}

TEST_CASE("elements of a glTF are charged until its bytes are used up", "[mesh][gltf]") {
  gltf::Document document;
  document.accessors = {{.component_type = 5126, .count = 400'000, .type = "VEC3"}};
  const ReadReference none;
  gltf::Buffers buffers(document, {}, 200'000, none);
  gltf::AccessorReader reader(document, buffers);
  for (int k = 0; k < 3; ++k) CHECK(reader.charge(0));  // 1 000 000 and 200 000
  CHECK_FALSE(reader.charge(0));
}

TEST_CASE("a glTF's nodes come before their children, and place them", "[mesh][gltf]") {
  gltf::Document document = triangle_document();
  const auto node = [](const std::string& name, const Eigen::Affine3d& place,
                       std::vector<std::size_t> children) {
    return gltf::Node{name, place.matrix(), 0, std::move(children)};
  };
  const Eigen::Affine3d turn(Eigen::AngleAxisd(0.5, Eigen::Vector3d(0, 0, 1)));
  const Eigen::Affine3d move(Eigen::Translation3d(1, 2, 3));
  document.nodes = {node("d", move, {}), node("a", turn, {3, 0}), node("e", move, {}),
                    node("b", move, {4}), node("c", turn, {})};
  document.roots = {1, 2};
  const std::vector<gltf::Object> objects = gltf::objects_of(document).value();
  std::string names;
  for (const gltf::Object& object : objects) names += document.nodes[object.node].name;
  REQUIRE(names == "abcde");
  CHECK(objects[0].to_file == turn.matrix());
  CHECK(objects[1].to_file == turn.matrix() * move.matrix());
  CHECK(objects[2].to_file == turn.matrix() * move.matrix() * turn.matrix());
  CHECK(gltf::choose(document, objects, "c").value().to_file == objects[2].to_file);
  CHECK_FALSE(gltf::choose(document, objects, "f"));

  document.nodes[4].children = {1};  // its own ancestor
  CHECK_FALSE(gltf::objects_of(document));
}

TEST_CASE("a glTF's mesh is where its object is", "[mesh][gltf]") {
  const std::string bytes = floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
  gltf::Document document = triangle_document();
  document.accessors[0].view = 0;
  document.buffers = {{.size = bytes.size()}};
  document.views = {{0, 0, bytes.size(), 0}};
  const ReadReference none;
  gltf::Buffers buffers(document, bytes, bytes.size(), none);
  gltf::AccessorReader reader(document, buffers);
  document.nodes = {{.name = "cloth"}};
  document.meshes[0].primitives.push_back(document.meshes[0].primitives[0]);
  gltf::Object object{.node = 0, .mesh = 0, .to_file = Eigen::Matrix4d::Identity()};
  object.to_file.topRightCorner<3, 1>() << 5, 6, 7;
  object.to_file(2, 0) = 2;
  const Mesh mesh = gltf::mesh_of(document, object, reader, 0).value();
  REQUIRE(mesh.vertex_count() == 3);  // shared by both of its primitives
  CHECK(mesh.face_sizes == std::vector{3, 3});
  CHECK(mesh.positions.row(0) == Eigen::RowVector3d(5, 6, 7));
  CHECK(mesh.positions.row(1) == Eigen::RowVector3d(6, 6, 9));
  CHECK(mesh.positions.row(2) == Eigen::RowVector3d(5, 7, 7));
}
