#include <random>

#include "files/gltf/gltf_files.hpp"
#include "pliant/files/gltf/gltf_accessor.hpp"
#include "pliant/files/gltf/read_gltf.hpp"
#include "pliant/mesh/mesh.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

// A square of two triangles with (u,v), sparse positions and indices: uses every feature that is
// read.
std::string whole_gltf() {
  const GltfParts parts{
      R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":2,)"
      R"("indices":{"bufferView":3,"componentType":5121},"values":{"bufferView":4}}},)"
      R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
      R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"})",
      R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},)"
      R"({"buffer":0,"byteOffset":80,"byteLength":12},{"buffer":0,"byteOffset":92,"byteLength":2},)"
      R"({"buffer":0,"byteOffset":94,"byteLength":24})",
      R"({"attributes":{"POSITION":0,"NORMAL":0,"TEXCOORD_0":1},"indices":2,"material":0})",
      floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + floats({0, 0, 1, 0, 1, 1, 0, 1}) +
          std::string("\0\0\1\0\2\0\0\0\2\0\3\0", 12) + std::string("\x01\x03", 2) +
          floats({7, 8, 9, 4, 5, 6}),
      R"({"name":"top","children":[1],"rotation":[0,0,0.6,0.8]},{"name":"cloth","mesh":0})",
      R"("materials":[{"name":"silk"}],)"};
  return parts.text();
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

std::string small_glb() {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  return gltf.glb(meshes, cloth_node);
}

// The result is a valid mesh or a one-line error; the bytes are in a buffer of exactly their size.
void check_harmless(const std::string& bytes) {
  const auto mesh = parse_exactly(bytes);
  if (mesh) CHECK(check_mesh(*mesh));
  if (!mesh) CHECK(to_lines(mesh.error()).size() == 1);
}

}  // namespace

TEST_CASE("what lies outside what it points into is refused", "[mesh][read_gltf]") {
  const std::string text = whole_gltf();
  REQUIRE(gltf_complaint(text) == "none");
  struct Case {
    std::string from, to, expected;
  };
  const std::vector<Case> cases = {
      // accessors in their views
      {R"("componentType":5126,"count":4,"type":"VEC3")",
       R"("componentType":5126,"count":5,"type":"VEC3")",
       "accessors[0] reaches past the end of bufferViews[0]: 5 elements at byte 0 of 48"},
      {R"("componentType":5126,"count":4,"type":"VEC3")",
       R"("componentType":5126,"count":18446744073709551615,"type":"VEC3")",
       "accessors[0] reaches past the end of bufferViews[0]: 18446744073709551615 elements at "
       "byte 0 of 48"},
      {R"("bufferView":0,)", R"("bufferView":0,"byteOffset":1,)",
       "accessors[0] reaches past the end of bufferViews[0]: 4 elements at byte 1 of 48"},
      {R"("bufferView":0,)", R"("bufferView":0,"byteOffset":18446744073709551612,)",
       "4 elements at byte 18446744073709551612 of 48"},
      {R"("byteLength":48})", R"("byteLength":48,"byteStride":16})",
       "accessors[0] reaches past the end of bufferViews[0]: 4 elements at byte 0 of 48"},
      {R"("byteLength":48})", R"("byteLength":48,"byteStride":4})",
       "accessors[0] has elements of 12 bytes, but bufferViews[0].byteStride is 4"},
      {R"("byteLength":48})", R"("byteLength":48,"byteStride":0})",
       "bufferViews[0].byteStride is 0, but must be from 4 to 252"},
      // views in their buffers
      {R"("byteLength":48})", R"("byteLength":4800})",
       "bufferViews[0] reaches past the end of its buffer: 4800 bytes at 0 of 118"},
      {R"("byteOffset":48)", R"("byteOffset":18446744073709551600)",
       "bufferViews[1] reaches past the end of its buffer: 32 bytes at 18446744073709551600 of"},
      {R"("byteLength":118)", R"("byteLength":119)",
       "buffers[0] is truncated: it has 118 of 119 bytes"},
      {R"("byteLength":118)", R"("byteLength":110)",
       "bufferViews[4] reaches past the end of its buffer: 24 bytes at 94 of 110"},
      // sparse
      {R"("sparse":{"count":2)", R"("sparse":{"count":3)",
       "accessors[0] reaches past the end of bufferViews[3]: 3 elements at byte 0 of 2"},
      {R"("sparse":{"count":2)", R"("sparse":{"count":5)",
       "accessors[0] replaces 5 of its 4 elements"},
      {R"("values":{"bufferView":4)", R"("values":{"bufferView":4,"byteOffset":4)",
       "accessors[0] reaches past the end of bufferViews[4]: 2 elements at byte 4 of 24"},
      {R"("values":{"bufferView":4)", R"("values":{"bufferView":4,"byteOffset":4000000000)",
       "accessors[0] reaches past the end of bufferViews[4]: 2 elements at byte 4000000000 of 24"},
      {R"("values":{"bufferView":4})", R"("values":{})", "accessors[0].sparse has no bufferView"},
      {R"("sparse":{"count":2)", R"("sparse":{"count":-2)",
       "accessors[0].sparse.count is not a whole number of at least 0"},
      {R"("bufferView":3,"componentType":5121)", R"("bufferView":30,"componentType":5121)",
       "accessors[0].sparse.indices.bufferView is 30, but the file's bufferViews are numbered from "
       "0 to 4"},
      {R"("bufferView":3,"componentType":5121)", R"("bufferView":3,"componentType":5126)",
       "accessors[0] has sparse indices of the componentType 5126"},
      {R"("bufferView":3,"componentType":5121)",
       R"("bufferView":3,"byteOffset":1,"componentType":5121)",
       "accessors[0] reaches past the end of bufferViews[3]: 2 elements at byte 1 of 2"},
      {R"("bufferView":3)", R"("bufferView":2)",
       "accessors[0] has the sparse index 0, but must have one from 1 to 3 after those before it"},
      {R"("bufferView":3)", R"("bufferView":4,"byteOffset":2)",
       "accessors[0] has the sparse index 224, but must have one from 0 to 3 after those before "
       "it"},
      // indices of vertices
      {R"("bufferView":2)", R"("bufferView":1)",
       "meshes[0].primitives[0]: index 5 refers to vertex 16256, but there are 4 (counted from 0)"},
      {R"("componentType":5123)", R"("componentType":5126)",
       "accessors[2] has the componentType 5126; indices must have 5121, 5123 or 5125"},
      {R"("count":6,"type":"SCALAR")", R"("count":6,"type":"VEC2")",
       "accessors[2] is of type \"VEC2\", not SCALAR"},
      {R"("count":6)", R"("count":5)",
       "meshes[0].primitives[0] has 5 corners of triangles, which is not a multiple of 3"},
      // attributes
      {R"("count":4,"type":"VEC2")", R"("count":3,"type":"VEC2")",
       "meshes[0].primitives[0] has 4 vertices, but 3 (u,v)"},
      {R"("NORMAL":0)", R"("NORMAL":1)", "accessors[1] is of type \"VEC2\", not VEC3"},
      {R"("componentType":5126,"count":4,"type":"VEC2")",
       R"("componentType":5125,"count":4,"type":"VEC2")",
       "accessors[1] has the componentType 5125, which vectors must not have"},
      {R"("componentType":5126,"count":4,"type":"VEC2")",
       R"("componentType":5130,"count":4,"type":"VEC2")",
       "accessors[1] has the componentType 5130, which vectors must not have"},
      // indices of the document
      {R"("POSITION":0)", R"("POSITION":3)",
       "meshes[0].primitives[0].POSITION is 3, but the file's accessors are numbered from 0 to 2"},
      {R"("bufferView":0)", R"("bufferView":5)",
       "accessors[0].bufferView is 5, but the file's bufferViews are numbered from 0 to 4"},
      {R"("buffer":0)", R"("buffer":1)",
       "bufferViews[0].buffer is 1, but the file's buffers are numbered from 0 to 0"},
      {R"("mesh":0)", R"("mesh":4294967296)",
       "nodes[1].mesh is 4294967296, but the file's meshes are numbered from 0 to 0"},
      {R"("mesh":0)", R"("mesh":-1)", "nodes[1].mesh is not a whole number of at least 0"},
      {R"("mesh":0)", R"("mesh":0.5)", "nodes[1].mesh is not a whole number of at least 0"},
      {R"("children":[1])", R"("children":[2])",
       "nodes[0].children is 2, but the file's nodes are numbered from 0 to 1"},
      {R"("children":[1])", R"("children":["1"])",
       "nodes[0].children has an element that is not a whole number of at least 0"},
      // the tree
      {R"("children":[1])", R"("children":[1,1])",
       R"(nodes[1] "cloth" is in the tree of the scene twice)"},
      {R"("children":[1])", R"("children":[0])",
       "the nodes of the file are in a cycle, each a child of the one before: nodes[0]"},
      {R"("mesh":0)", R"("mesh":0,"children":[0])",
       "the nodes of the file are in a cycle, each a child of the one before: nodes[0]"},
      {R"("rotation":[0,0,0.6,0.8])", R"("rotation":[0,0,0,0])",
       "nodes[0].rotation is a quaternion whose length is 0 or not finite"},
      {R"("rotation":[0,0,0.6,0.8])", R"("rotation":[0,0,0.6])",
       "nodes[0].rotation is not a list of 4 numbers"},
      {R"("rotation":[0,0,0.6,0.8])", R"("matrix":[1],"scale":[1,1,1])",
       "nodes[0].matrix is not a list of 16 numbers"},
      {R"("mesh":0)", R"("mesh":0,"scale":[1,1,1],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])",
       "nodes[1].matrix is given together with a translation, rotation or scale"},
      {R"("mesh":0)", R"("mesh":0,"matrix":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1])",
       "the object's transform is not affine: its last row is 0.5 0 0 1, not 0 0 0 1"},
      {R"("mesh":0)", R"("mesh":0,"scale":[1e300,1e300,1e300],"translation":[1e999,0,0])",
       "the file is not glTF: its JSON has a number that is too large"},
      // members of the wrong kind
      {R"("name":"silk")", R"("name":7)", "materials[0].name is not text"},
      {R"("attributes":{)", R"("attributes":[],"x":{)",
       "meshes[0].primitives[0].attributes is not an object"},
      {R"("count":4,"type":"VEC3",)", R"("type":"VEC3",)", "accessors[0].count is missing"},
      {R"({"buffer":0,"byteLength":48})", "7", "bufferViews[0] is not an object"},
      {R"([{"name":"silk"}])", "7", "materials is not a list"}};
  for (const Case& c : cases) {
    CAPTURE(c.from, c.to);
    CHECK_THAT(gltf_complaint(changed(text, c.from, c.to)), contains_text(c.expected));
  }
}

TEST_CASE("the file that ended assimp by a segmentation fault is refused", "[mesh][read_gltf]") {
  CHECK(
      gltf_complaint(R"({"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":1,)"
                     R"("type":"VEC3","sparse":{"count":1,"indices":{},"values":{}}}],"meshes":[{)"
                     R"("primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],)"
                     R"("scenes":[{"nodes":[0]}],"scene":0})") ==
      "a.gltf: error: accessors[0].sparse has no bufferView");
}

TEST_CASE("a few bytes of glTF make no more elements than they can hold", "[mesh][read_gltf]") {
  const auto zeros = [](const std::string& count, const std::string& primitives) {
    return fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
        R"("meshes":[{{"primitives":[{}]}}],"accessors":[{{"componentType":5126,"count":{},)"
        R"("type":"VEC3"}}]}})",
        primitives, count);
  };
  const std::string one = R"({"attributes":{"POSITION":0}})";
  for (const std::string count : {"4294967296", "18446744073709551615", "2147483647", "1500000"}) {
    CHECK_THAT(gltf_complaint(zeros(count, one)),
               contains_text("accessors[0] has " + count + " elements, and 0 were read before it"));
  }
  // Nor by reading the same accessors again.
  const std::string fan = R"({"attributes":{"POSITION":0},"mode":6})";
  const std::string many = fan + repeated("," + fan, 99);
  CHECK_THAT(gltf_complaint(zeros("300000", many)),
             contains_text("accessors[0] has 300000 elements, and 900000 were read before it"));
  CHECK(gltf_complaint(zeros("3000", many)) == "none");
}

TEST_CASE("extensions that a glTF requires are named", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string text = gltf.text(gltf_mesh(gltf.primitive(small_sheet(true))), cloth_node);
  const auto with = [&](const std::string& member, const std::string& name) {
    std::string changed_text = text;
    return changed_text.insert(
        1, fmt::format(R"("{}":["KHR_mesh_quantization","{}"],)", member, name));
  };
  for (const std::string name :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing",
        "CESIUM_RTC", "VENDOR_thing", "materials"}) {
    CHECK(gltf_complaint(with("extensionsRequired", name)) ==
          fmt::format("a.gltf: error: extensionsRequired names \"{}\", which is not supported; "
                      "export without it",
                      name));
    CHECK(gltf_complaint(with("extensionsUsed", name)) == "none");
  }
  CHECK(parse_exactly(with("extensionsUsed", "KHR_texture_transform"))->left_out.empty());
  for (const std::string name :
       {"KHR_materials_unlit", "KHR_materials_variants", "ADOBE_materials_thin_transparency",
        "KHR_texture_basisu", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual"}) {
    CHECK(parse_exactly(with("extensionsRequired", name))->left_out ==
          fmt::format("1 extension that concerns looks ({})", name));
  }
}

TEST_CASE("a file that is no glTF is refused without quoting it", "[mesh][read_gltf]") {
  struct Case {
    std::string text, expected;
  };
  const std::string sound = R"({"asset":{"version":"2.0"},)";
  const std::vector<Case> cases = {
      {"", "a.gltf:1: error: the file is not glTF: it is not valid JSON from here on"},
      {"root:secret:0:0\n", "a.gltf:1: error: the file is not glTF: it is not valid JSON"},
      {"{\"asset\":\n{\"secret\"", "a.gltf:2: error: the file is not glTF: it is not valid JSON"},
      {"{\"secret\":1}", "a.gltf: error: the file is not glTF: it has no asset.version"},
      {"[\"secret\"]", "a.gltf: error: the file is not glTF: it has no asset.version"},
      {"\"secret\"", "a.gltf: error: the file is not glTF: it has no asset.version"},
      {"{\"asset\":{\"version\":\"1.0\"}}",
       "a.gltf: error: asset.version is \"1.0\"; only glTF 2.0 is supported"},
      {"{\"asset\":{\"version\":\"2.1\",\"minVersion\":\"2.1\"}}",
       "a.gltf: error: asset.minVersion is \"2.1\"; only glTF 2.0 is supported"},
      {sound + "\"scenes\":[]}", "a.gltf: error: the file has no faces"},
      {sound + "\"scenes\":[{}]}", "a.gltf: error: the file has no faces"},
      {repeated("[", 1000000), "a.gltf: error: the file's JSON is nested more than 200 deep"},
      {"[" + repeated("0,", 4'000'000) + "0]",
       "a.gltf: error: the file's JSON has more than 4000000 values"},
      {sound + "\"buffers\":[" + repeated("{\"byteLength\":0},", 1000) + "{\"byteLength\":0}]}",
       "a.gltf: error: buffers has more than 1000 elements"}};
  for (const Case& c : cases) {
    CAPTURE(c.text.substr(0, 100));
    CHECK_THAT(gltf_complaint(c.text), StartsWith(c.expected));
    CHECK(gltf_complaint(c.text).find("secret") == std::string::npos);
  }
}

TEST_CASE("a .glb's lengths are those of the file and its chunks", "[mesh][read_gltf]") {
  const std::string glb = small_glb();
  REQUIRE(gltf_complaint(glb) == "none");
  const auto number = [](std::uint64_t n) { return little_endian(n, 4); };
  const auto with = [&](std::size_t at, const std::string& bytes) {
    std::string text = glb;
    return text.replace(at, bytes.size(), bytes);
  };
  const std::uint64_t json_size =
      static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
  const std::size_t binary = 20 + json_size;
  struct Case {
    std::string text, expected;
  };
  const std::vector<Case> cases = {
      {"glTF", "the file is truncated: it ends within its header"},
      {with(4, number(1)), "the file is glTF version 1; only version 2 is supported"},
      {"glTF" + number(2) + number(400), "the file is truncated: it has 12 of 400 bytes"},
      {"glTF" + number(2) + number(12), "the file has no JSON"},
      {glb + "more", fmt::format("the file has data after its end: it has {} of {} bytes",
                                 glb.size() + 4, glb.size())},
      {with(12, number(1u << 30)), "the chunk at byte 12 reaches past the end of the file"},
      {with(12, number(0xffffffff)), "the chunk at byte 12 reaches past the end of the file"},
      {with(binary, number(glb.size())),
       fmt::format("the chunk at byte {} reaches past the end of the file", binary)},
      {with(16, "BIN "), "the file's first chunk is not JSON"},
      {with(binary + 4, "JSON"), "buffers[0] has no uri, and no bytes in the file"}};
  for (const Case& c : cases) {
    CAPTURE(c.expected);
    CHECK_THAT(gltf_complaint(c.text), EndsWith(": error: " + c.expected));
  }
}

TEST_CASE("a glTF's base64 is that and nothing else", "[mesh][read_gltf]") {
  const std::string text = whole_gltf();
  const std::size_t at = text.find("data:;base64,") + 13;
  const auto with = [&](const std::string& digits) {
    return text.substr(0, at) + digits + text.substr(at + digits.size());
  };
  for (const std::string digits : {"-AAA", "AA A", "AA=A", "A===", "=AAA", "%41A"})
    CHECK_THAT(gltf_complaint(with(digits)), EndsWith("buffers[0].uri is not valid base64"));
  const std::size_t end = text.find('"', at);
  std::string cut = text;
  CHECK_THAT(gltf_complaint(cut.erase(end - 1, 1)), EndsWith("is not valid base64"));
  CHECK_THAT(gltf_complaint(changed(text, "data:;base64,", "data:;base16,")),
             EndsWith("buffers[0].uri is data that is not marked as base64"));
  CHECK_THAT(gltf_complaint(changed(text, "data:;base64,", "data:")),
             EndsWith("buffers[0].uri is data that is not marked as base64"));
  CHECK(gltf_complaint(changed(text, "data:;base64,", "data:model/gltf-buffer;base64,")) == "none");
}

TEST_CASE("coordinates of a glTF that are not finite are refused", "[mesh][read_gltf]") {
  Mesh sheet = small_sheet(true);
  sheet.positions(4, 1) = NAN;
  Gltf gltf;
  const std::string text = gltf.text(gltf_mesh(gltf.primitive(sheet)), cloth_node);
  CHECK_THAT(gltf_complaint(text), contains_text(" 4 ") && contains_text("not finite"));
}

TEST_CASE("(u,v) of a glTF that are not finite are left out", "[mesh][read_gltf]") {
  Mesh sheet = small_sheet(true);
  sheet.uvs[4][0] = INFINITY;
  Gltf gltf;
  const Mesh mesh = parse_exactly(gltf.text(gltf_mesh(gltf.primitive(sheet)), cloth_node)).value();
  CHECK(mesh.left_out == "1 (u,v) that is not a pair of numbers");
  for (std::size_t k = 0; k < mesh.corner_uvs.size(); ++k)
    CHECK(mesh.corner_uvs[k] == (mesh.corner_vertices[k] == 4 ? -1 : mesh.corner_vertices[k]));
}

TEST_CASE("no prefix or mutation of a glTF does harm", "[mesh][read_gltf]") {
  std::mt19937 random(1);
  for (const std::string& whole : {whole_gltf(), small_glb()}) {
    for (std::size_t length = 0; length < whole.size(); length += is_sanitized ? 3 : 1)
      check_harmless(whole.substr(0, length));
    for (int trial = 0; trial < rounds(3000); ++trial) {
      std::string mutant = whole;
      for (int k = 0; k < 2; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
      check_harmless(mutant);
    }
    // Changes that keep it JSON: digits replaced by digits, and whole pieces moved elsewhere.
    const std::string digits = "0123456789";
    for (int trial = 0; trial < rounds(3000); ++trial) {
      std::string mutant = whole;
      for (int k = 0; k < 2; ++k) {
        const std::size_t at = mutant.find_first_of(digits, random() % mutant.size());
        if (at != std::string::npos) mutant[at] = digits[random() % 10];
      }
      if (trial % 2 == 0)
        mutant.insert(mutant.find_first_of(digits), std::string(random() % 20, '9'));
      check_harmless(mutant);
    }
    for (int trial = 0; trial < rounds(1000); ++trial) {
      const std::size_t from = random() % whole.size(), size = random() % 40;
      std::string mutant = whole;
      check_harmless(mutant.insert(random() % mutant.size(), whole.substr(from, size)));
    }
  }
}
