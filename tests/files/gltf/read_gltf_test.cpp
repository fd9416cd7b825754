#include "pliant/files/gltf/read_gltf.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "files/gltf/gltf_files.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_mesh.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/normals.hpp"
#include "support/area_vectors.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

// A triangle fan, strip or list over four corners of a square, without indices or (u,v).
GltfParts square(int mode) {
  return {R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})",
          R"({"buffer":0,"byteLength":48})",
          fmt::format(R"({{"attributes":{{"POSITION":0}},"mode":{}}})", mode),
          floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})};
}

std::vector<int> corners(const std::string& text) {
  return parse_exactly(text).value().corner_vertices;
}

}  // namespace

TEST_CASE("vertices of a glTF keep their order and (u,v)", "[mesh][read_gltf]") {
  Mesh sheet = small_sheet(true);
  sheet.positions.row(0).swap(sheet.positions.row(7));  // any order
  std::swap(sheet.uvs[0], sheet.uvs[7]);
  for (int& vertex : sheet.corner_vertices) vertex = vertex == 0 ? 7 : vertex == 7 ? 0 : vertex;
  sheet.corner_uvs = sheet.corner_vertices;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  check_equal(parse_exactly(gltf.text(meshes, cloth_node)).value(), sheet);
  check_equal(parse_exactly(gltf.glb(meshes, cloth_node)).value(), sheet);
  const ScratchFolder folder;
  check_equal(read_mesh(folder.write("a.gltf", gltf.text(meshes, cloth_node))).value(), sheet);
  check_equal(read_mesh(folder.write("a.GLB", gltf.glb(meshes, cloth_node))).value(), sheet);
}

TEST_CASE("a glTF finds its buffers beside it", "[mesh][read_gltf]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  folder.write("my numbers.bin", gltf.bytes());
  for (const std::string uri : {"my numbers.bin", "my%20numbers.bin", "./my%20numbers.bin"}) {
    const auto file = folder.write("a.gltf", gltf.text(meshes, cloth_node, "0", uri));
    check_equal(read_mesh(file).value(), small_sheet(true));
    CHECK(gltf_references(OpenFile::open(file).value(), {}) ==
          std::vector{std::filesystem::canonical(folder.path()) / "my numbers.bin"});
  }
  const auto complaint = [&](const std::string& uri) {
    const auto file = folder.write("b.gltf", gltf.text(meshes, cloth_node, "0", uri));
    const auto mesh = read_mesh(file);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().code == ErrorCode::InvalidInput);
    return to_lines(mesh.error()).front();
  };
  CHECK_THAT(complaint("none.bin"),
             contains_text("b.gltf: error: the file refers to ") &&
                 EndsWith("none.bin: cannot read the file: No such file or directory"));
  folder.write("short.bin", gltf.bytes().substr(0, 40));
  CHECK_THAT(
      complaint("short.bin"),
      EndsWith(fmt::format("buffers[0] is truncated: it has 40 of {} bytes", gltf.bytes().size())));
  CHECK_THAT(complaint("."), EndsWith("it is a folder") || EndsWith("it is not a regular file"));
}

TEST_CASE("the parts of a mesh may lie in several buffers", "[mesh][read_gltf]") {
  const std::string positions = floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const std::string text = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":1,"byteLength":3}}],)"
      R"("buffers":[{{"byteLength":36,"uri":"data:;base64,{}"}},{{"byteLength":3,"uri":"b"}}]}})",
      base64(positions));
  const auto read = [](const std::string& uri, std::size_t) -> Result<std::string> {
    CHECK(uri == "b");
    return std::string("\x02\x01\x00", 3);
  };
  CHECK(parse_exactly(text, "", 0, read)->corner_vertices == std::vector{2, 1, 0});
  CHECK_THAT(gltf_complaint(text), EndsWith("buffers[1] is in another file"));
}

TEST_CASE("glTF's modes of triangles are read, points and lines passed over", "[mesh][read_gltf]") {
  CHECK(corners(square(5).text()) == std::vector{0, 1, 2, 2, 1, 3});
  CHECK(corners(square(6).text()) == std::vector{0, 1, 2, 0, 2, 3});
  GltfParts indexed = square(4);
  indexed.accessors += R"(,{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"})";
  indexed.views += R"(,{"buffer":0,"byteOffset":48,"byteLength":12})";
  indexed.primitives = R"({"attributes":{"POSITION":0},"indices":1})";
  for (const int index : {3, 2, 1, 1, 0, 3}) indexed.bytes += little_endian(index, 2);
  CHECK(corners(indexed.text()) == std::vector{3, 2, 1, 1, 0, 3});
  CHECK_THAT(
      gltf_complaint(square(4).text()),
      EndsWith("meshes[0].primitives[0] has 4 corners of triangles, which is not a multiple of 3"));
  CHECK_THAT(gltf_complaint(square(7).text()),
             EndsWith("meshes[0].primitives[0].mode is 7, but must be from 0 to 6"));

  Gltf gltf;
  const std::string sheet = gltf.primitive(small_sheet(true));
  std::string lines = sheet, points = sheet;
  lines.insert(1, "\"mode\":1,");
  points.insert(1, "\"mode\":0,");
  check_equal(
      parse_exactly(gltf.text(gltf_mesh(lines + "," + sheet + "," + points), cloth_node)).value(),
      small_sheet(true));
  for (const std::string& only : {lines, points}) {
    CHECK_THAT(gltf_complaint(gltf.text(gltf_mesh(only), cloth_node)),
               EndsWith("a.gltf: error: the file has no faces"));
  }
}

TEST_CASE("(u,v) point the same way in a glTF and in an OBJ", "[mesh][read_gltf]") {
  Mesh sheet = small_sheet(true);
  for (auto& [u, v] : sheet.uvs) v = v * 0.5;  // not symmetric in v
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const GridMapping of_obj = find_grid(parse_obj(obj_text(sheet), "a.obj").value()).value();
  const GridMapping of_gltf =
      find_grid(parse_exactly(gltf.text(meshes, cloth_node)).value()).value();
  CHECK(of_gltf.grid == of_obj.grid);
  CHECK(of_gltf.rest == of_obj.rest);
}

TEST_CASE("integers of a glTF are numbers, or shares of their largest", "[mesh][read_gltf]") {
  struct Case {
    int component;
    std::string normalized, bytes;
    std::array<double, 2> uv;  // of the second vertex, as in the file
  };
  const auto shorts = [](int a, int b) { return little_endian(a, 2) + little_endian(b, 2); };
  const std::vector<Case> cases = {
      {5121, "true", std::string("\0\0\0\0\xff\x33\0\0\0\0\0\0", 12), {1, 0.2}},
      {5121, "false", std::string("\0\0\0\0\x07\x02\0\0\0\0\0\0", 12), {7, 2}},
      {5120, "true", std::string("\0\0\0\0\x7f\x80\0\0\0\0\0\0", 12), {1, -1}},
      {5123, "true", shorts(0, 0) + shorts(65535, 13107) + shorts(0, 0), {1, 0.2}},
      {5122, "false", shorts(0, 0) + shorts(-3, 5) + shorts(0, 0), {-3, 5}},
      {5122, "true", shorts(0, 0) + shorts(-32768, 32767) + shorts(0, 0), {-1, 1}}};
  for (const Case& c : cases) {
    CAPTURE(c.component, c.normalized);
    GltfParts parts{
        fmt::format(R"({{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},)"
                    R"({{"bufferView":1,"componentType":{},"normalized":{},"count":3,)"
                    R"("type":"VEC2"}})",
                    c.component, c.normalized),
        R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12,"byteStride":4})",
        R"({"attributes":{"POSITION":0,"TEXCOORD_0":1}})",
        floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + c.bytes};
    parts.more = R"("extensionsRequired":["KHR_mesh_quantization"],)";
    const Mesh mesh = parse_exactly(parts.text()).value();
    CHECK(mesh.uvs.at(1) == std::array{c.uv[0], 1 - c.uv[1]});
  }
}

TEST_CASE("elements of a glTF may lie apart in their buffer", "[mesh][read_gltf]") {
  // x y z u v of each vertex; no bytes after the last v.
  const GltfParts parts{
      R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
      R"({"bufferView":0,"byteOffset":12,"componentType":5126,"count":3,"type":"VEC2"})",
      R"({"buffer":0,"byteOffset":4,"byteLength":60,"byteStride":20})",
      R"({"attributes":{"POSITION":0,"TEXCOORD_0":1}})",
      floats({9, 0, 0, 0, 0.5, 0.25, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})};
  const Mesh mesh = parse_exactly(parts.text()).value();
  Field expected(3, 3);
  expected << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  CHECK(mesh.positions == expected);
  CHECK(mesh.uvs == std::vector<std::array<double, 2>>{{0.5, 0.75}, {1, 1}, {0, 0}});
}

TEST_CASE("a sparse accessor replaces elements, be they zeros", "[mesh][read_gltf]") {
  const std::string sparse =
      R"("sparse":{"count":2,"indices":{"bufferView":1,"componentType":5121},)"
      R"("values":{"bufferView":2}})";
  const std::string rest = R"("componentType":5126,"count":4,"type":"VEC3",)";
  GltfParts parts = square(6);
  parts.views += R"(,{"buffer":0,"byteOffset":48,"byteLength":2})"
                 R"(,{"buffer":0,"byteOffset":50,"byteLength":24})";
  parts.bytes += std::string("\x01\x03", 2) + floats({7, 8, 9, 4, 5, 6});
  Field expected(4, 3);
  parts.accessors = "{\"bufferView\":0," + rest + sparse + "}";
  expected << 0, 0, 0, 7, 8, 9, 1, 1, 0, 4, 5, 6;
  CHECK(parse_exactly(parts.text())->positions == expected);
  parts.accessors = "{" + rest + sparse + "}";
  expected << 0, 0, 0, 7, 8, 9, 0, 0, 0, 4, 5, 6;
  CHECK(parse_exactly(parts.text())->positions == expected);
}

TEST_CASE("the transforms of a glTF's node and of all above it apply", "[mesh][read_gltf]") {
  const Mesh sheet = small_sheet(true);
  const double half = std::sqrt(0.5);
  const auto scale = GENERATE(std::array{2, 3, 4}, std::array{-2, 3, 4});  // the second mirrors
  const Eigen::Affine3d expected =
      Eigen::Translation3d(1, -2, 3) * Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitY()) *
      Eigen::Scaling(Vector3d(scale[0], scale[1], scale[2])) * Eigen::Translation3d(0.5, 0, 0);
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const std::string parent = fmt::format(
      R"({{"name":"parent","children":[1],"translation":[1,-2,3],"rotation":[0,{0:.17},0,{0:.17}],)"
      R"("scale":[{1},{2},{3}]}},)",
      half, scale[0], scale[1], scale[2]);
  const std::vector<std::string> children = {
      R"({"name":"cloth","mesh":0,"translation":[0.5,0,0]})",
      R"({"name":"cloth","mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0.5,0,0,1]})"};
  for (const std::string& child : children) {
    const Mesh mesh = parse_exactly(gltf.text(meshes, parent + child)).value();
    const Field moved = (expected * sheet.positions.transpose()).transpose();
    CHECK((mesh.positions - moved).cwiseAbs().maxCoeff() < 1e-14);  // in double, of numbers to 8
    Mesh turned = sheet;
    if (scale[0] < 0) turn_faces(turned);
    CHECK(mesh.corner_vertices == turned.corner_vertices);
  }
}

TEST_CASE("without a transform a glTF's positions keep their bits", "[mesh][read_gltf]") {
  Mesh sheet = small_sheet(true);
  for (double& number : sheet.positions.reshaped()) number = static_cast<float>(number / 3);
  sheet.positions(0, 1) = -0.0;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const Mesh mesh = parse_exactly(gltf.text(meshes, cloth_node)).value();
  CHECK(mesh.positions == sheet.positions);
  CHECK(std::signbit(mesh.positions(0, 1)));
}

TEST_CASE("an object of a glTF is a node with faces, taken by its name", "[mesh][read_gltf]") {
  Gltf gltf;
  Mesh other = small_sheet(true);
  other.positions.array() += 8;
  const std::string first = gltf_mesh(gltf.primitive(small_sheet(true)), "weave");
  const std::string second = gltf_mesh(gltf.primitive(other), "knit");
  const std::string nodes =
      R"({"name":"empty","children":[1,2]},{"name":"left","mesh":0},{"name":"right","mesh":1})";
  const std::string text = gltf.text(first + "," + second, nodes);
  check_equal(parse_exactly(text, "left").value(), small_sheet(true));
  CHECK(parse_exactly(text, "left")->object == "left");
  CHECK(parse_exactly(text, "right")->positions == other.positions);
  CHECK(parse_exactly(text, "knit")->positions == other.positions);  // the mesh's own name
  CHECK_THAT(gltf_complaint(text),
             contains_text("a.gltf: error: the file has 2 objects; choose one "
                           "with the attribute object: \"left\", \"right\""));
  CHECK_THAT(gltf_complaint(text, "empty"),
             contains_text("the file has no object \"empty\"; it has: \"left\", \"right\"; "
                           "`pliant info FILE` lists all of them whole"));
  const std::string nameless = R"({"children":[1,2]},{"mesh":0},{"mesh":1})";
  CHECK(parse_exactly(gltf.text(first + "," + second, nameless), "nodes[2]")->positions ==
        other.positions);
}

TEST_CASE("faces keep their outer sides in a node that reflects them", "[mesh][read_gltf]") {
  Gltf gltf;
  Mesh sheet = small_sheet(true);
  for (int k = 0; k < sheet.vertex_count(); ++k) sheet.positions(k, 1) = 0.25 * (k % 3) * (k % 2);
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  struct Case {
    std::string parent, own;
    bool is_mirrored;
  };
  const std::string one = R"("scale":[1,1,1])";
  for (const Case& c :
       {Case{one, R"("scale":[2,1,1])", false}, Case{one, R"("scale":[-1,1,1])", true},
        Case{R"("scale":[1,-2,1])", one, true},
        Case{R"("scale":[-1,-1,1])", R"("scale":[1,1,-1])", true},
        Case{R"("scale":[1,-1,1])", R"("scale":[1,1,-1])", false},
        Case{one, R"("scale":[-1,-1,-1],"rotation":[0.6,0,0,0.8])", true},
        Case{one, R"("matrix":[0,1,0,0,1,0,0,0,0,0,1,0,5,0,0,1])", true},
        Case{one, R"("matrix":[1,0.5,0,0,0,1,0,0,0.5,0,2,0,0,0,0,1])", false},
        Case{one, R"("scale":[-1e-120,1e-120,1e-120])", true}}) {
    CAPTURE(c.parent, c.own);
    const std::string nodes =
        fmt::format(R"({{"children":[1],{}}},{{"mesh":0,{}}})", c.parent, c.own);
    const Mesh read = parse_exactly(gltf.text(meshes, nodes)).value();
    Mesh expected = sheet;
    if (c.is_mirrored) turn_faces(expected);
    CHECK(read.corner_vertices == expected.corner_vertices);
    CHECK(read.corner_uvs == expected.corner_uvs);
    if (c.own.find("e-120") != std::string::npos) continue;  // its areas are no numbers
    // The map, from what it does to the vertices.
    const Eigen::RowVector3d origin = sheet.positions.row(0), place = read.positions.row(0);
    const Eigen::MatrixXd before = sheet.positions.rowwise() - origin;
    const Eigen::MatrixXd after = read.positions.rowwise() - place;
    const Matrix3d linear =
        (before.transpose() * before).inverse().eval() * before.transpose() * after;
    CHECK((linear.determinant() < 0) == c.is_mirrored);
    const Field moved = moved_areas(area_vectors(sheet), linear.transpose());
    CHECK((area_vectors(read) - moved).cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("a glTF's objects are listed as they are read and chosen", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string small = gltf_mesh(gltf.primitive(small_sheet(true)), "weave");
  const std::string large =
      gltf_mesh(gltf.primitive(make_mesh({.columns = 4, .rows = 5, .triangles = true})), "knit");
  const std::string name(200, 'n');
  const std::string nodes =
      fmt::format(R"({{"name":"a/b","mesh":0}},{{"name":"a/b","mesh":1}},{{"name":"{}","mesh":0}},)"
                  R"({{"name":"a/b#2","mesh":1}},{{"mesh":0}},{{"name":"knit","mesh":0}},)"
                  R"({{"name":"#1","mesh":1}})",
                  name);
  const ScratchFolder folder;
  const auto file = folder.write("a.gltf", gltf.text(small + "," + large, nodes, "0,1,2,3,4,5,6"));
  const auto objects = gltf_objects(file).value();
  std::vector<std::string> names, choices;
  for (const FileObject& each : objects) {
    names.push_back(each.name);
    choices.push_back(each.choice);
  }
  CHECK(names == std::vector<std::string>{"a/b", "a/b", name, "a/b#2", "nodes[4]", "knit", "#1"});
  // The second a/b has the name of another: its number is left.
  CHECK(choices ==
        std::vector<std::string>{"a/b#1", "#2", name, "a/b#2", "nodes[4]", "knit", "#1"});
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Mesh mesh = read_mesh(file, choices[k]).value();
    CAPTURE(choices[k]);
    CHECK(mesh.object == names[k]);
    CHECK(static_cast<std::uint64_t>(mesh.vertex_count()) == objects[k].vertices);
    CHECK(mesh.face_sizes.size() == objects[k].faces);
    CHECK(mesh.vertex_count() == (k == 1 || k == 3 || k == 6 ? 20 : 9));
  }
  CHECK_FALSE(read_mesh(file, "a/b"));
  CHECK_FALSE(read_mesh(file, "#8"));
  CHECK_FALSE(read_mesh(file, "#0"));
  CHECK(read_mesh(file, "weave#3")->object == "nodes[4]");  // the third with that mesh
}

TEST_CASE("a glTF without a scene shows all its nodes", "[mesh][read_gltf]") {
  Gltf gltf;
  std::string text = gltf.text(gltf_mesh(gltf.primitive(small_sheet(true))),
                               R"({"name":"low","mesh":0},{"name":"top","children":[0],)"
                               R"("translation":[5,0,0]})");
  const std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  text.erase(text.find(scene), scene.size());
  const Mesh mesh = parse_exactly(text).value();
  CHECK(mesh.object == "low");
  CHECK(mesh.positions.col(0) == (small_sheet(true).positions.col(0).array() + 5).matrix());
}

TEST_CASE("a scene that lists nodes below others shows them once", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::string nodes =
      R"({"name":"top","children":[1],"translation":[5,0,0]},{"name":"low","mesh":0})";
  for (const std::string roots : {"0,1", "1,0", "0,0", "0"}) {
    CHECK(parse_exactly(gltf.text(meshes, nodes, roots))->positions.col(0) ==
          (small_sheet(true).positions.col(0).array() + 5).matrix());
  }
}

TEST_CASE("a cycle of nodes is named, also outside the scene", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::string start =
      "a.gltf: error: the nodes of the file are in a cycle, each a child of the one before: ";
  struct Case {
    std::string nodes, told;
  };
  for (const Case& c :
       {Case{R"({"mesh":0},{"children":[1]})", "nodes[1] > nodes[1]"},
        Case{R"({"mesh":0},{"name":"a","children":[2]},{"name":"b","children":[1]})",
             R"(nodes[1] "a" > nodes[2] "b" > nodes[1] "a")"},
        Case{R"({"mesh":0},{"children":[2]},{"children":[3]},{"children":[2]})",
             "nodes[2] > nodes[3] > nodes[2]"}}) {
    const std::string text = gltf.text(meshes, c.nodes);
    CHECK(gltf_complaint(text) == start + c.told);
    // Without a scene no node of a cycle would be a root: it is no empty file.
    std::string bare = text;
    const std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
    bare.erase(bare.find(scene), scene.size());
    CHECK(gltf_complaint(bare) == start + c.told);
  }
  // A node with two parents is none, but has two places.
  const std::string two = R"({"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0})";
  CHECK_THAT(gltf_complaint(gltf.text(meshes, two)),
             contains_text("nodes[3] is in the tree of the scene twice"));
}

TEST_CASE("primitives of points and lines are left out and counted", "[mesh][read_gltf]") {
  GltfParts parts = square(4);
  parts.accessors += R"(,{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})";
  parts.primitives = R"({"attributes":{"POSITION":1}},{"attributes":{"POSITION":0},"mode":0},)"
                     R"({"attributes":{"POSITION":0},"mode":1})";
  const Mesh mesh = parse_exactly(parts.text()).value();
  CHECK(mesh.face_sizes == std::vector{3});
  CHECK(mesh.left_out == "2 primitives of points or lines");
}

TEST_CASE("only what the shown scene of a glTF holds is an object", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  std::string text =
      gltf.text(meshes, R"({"name":"a","mesh":0},{"name":"b","mesh":0,"scale":[2,2,2]})");
  const std::string scenes = R"("scenes":[{"nodes":[0]})";
  text.replace(text.find(scenes), scenes.size(), scenes + R"(,{"nodes":[1]})");
  CHECK(parse_exactly(text)->object == "a");
  std::string second = text;
  second.replace(second.find("\"scene\":0"), 9, "\"scene\":1");
  CHECK(parse_exactly(second)->object == "b");
  std::string first = text;
  first.erase(first.find("\"scene\":0,"), 10);
  CHECK(parse_exactly(first)->object == "a");
  std::string none = text;
  none.replace(none.find("\"scene\":0"), 9, "\"scene\":2");
  CHECK_THAT(gltf_complaint(none),
             EndsWith("scene is 2, but the file's scenes are numbered from 0 to 1"));
}

TEST_CASE("an instanced mesh of a glTF is an object in each of its nodes", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::string nodes =
      R"({"name":"left","mesh":0},{"name":"right","mesh":0,"translation":[5,0,0]})";
  const std::string text = gltf.text(meshes, nodes, "0,1");
  CHECK_THAT(gltf_complaint(text), contains_text("2 objects"));
  CHECK_THAT(gltf_complaint(text, "weave"), contains_text("2 objects named \"weave\""));
  CHECK(parse_exactly(text, "right")->positions.col(0) ==
        (parse_exactly(text, "left")->positions.col(0).array() + 5).matrix());
}

TEST_CASE("a glTF mesh's primitives become one", "[mesh][read_gltf]") {
  Gltf gltf;
  Mesh other = small_sheet(true);
  other.positions.array() += 8;
  const std::string first = gltf.primitive(small_sheet(true));
  const std::string both = first + "," + gltf.primitive(other);
  const Mesh merged = parse_exactly(gltf.text(gltf_mesh(both), cloth_node)).value();
  CHECK(merged.vertex_count() == 18);
  CHECK(merged.positions.bottomRows(9) == other.positions);
  CHECK(merged.corner_vertices.at(24) == other.corner_vertices[0] + 9);
  CHECK(merged.corner_uvs == merged.corner_vertices);
  CHECK(parse_exactly(gltf.text(gltf_mesh(both), cloth_node), "weave")->vertex_count() == 18);

  // With the same vertices: these are read once, and a grid is found.
  const Mesh shared = parse_exactly(gltf.text(gltf_mesh(first + "," + first), cloth_node)).value();
  CHECK(shared.vertex_count() == 9);
  CHECK(shared.face_sizes.size() == 16);
  CHECK(find_grid(shared));
}

TEST_CASE("materials of a glTF keep their names", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string plain = gltf.primitive(small_sheet(true));
  const auto with = [&](int material) {
    std::string text = plain;
    return text.insert(1, fmt::format("\"material\":{},", material));
  };
  std::string text = gltf.text(
      gltf_mesh(with(1) + "," + plain + "," + with(2) + "," + with(0) + "," + with(1)), cloth_node);
  text.insert(1, R"("materials":[{"name":"silk"},{"name":"wool"},{}],)");
  const FaceNames materials = parse_exactly(text)->materials;
  CHECK(materials.names == std::vector<std::string>{"wool", "silk"});
  REQUIRE(materials.of_faces.size() == 40);
  for (std::size_t k = 0; k < 40; ++k)
    CHECK(materials.of_faces[k] == std::array{0, -1, -1, 1, 0}[k / 8]);
  CHECK_THAT(gltf_complaint(gltf.text(gltf_mesh(with(0)), cloth_node)),
             EndsWith("primitives[0].material is 0, but the file has no materials"));
}

TEST_CASE("a glTF without normals is flat, and with them smooth where they agree",
          "[mesh][read_gltf]") {
  CHECK(is_flat(parse_exactly(square(6).text()).value()));
  GltfParts parts = square(6);
  parts.primitives = R"({"attributes":{"POSITION":0,"NORMAL":0},"mode":6})";
  CHECK_FALSE(is_flat(parse_exactly(parts.text()).value()));
}

TEST_CASE("a glTF's set of (u,v) is taken by its number", "[mesh][read_gltf]") {
  Gltf gltf;
  const Mesh triangles = small_sheet(true);
  std::vector<std::array<double, 2>> swapped = triangles.uvs;
  for (auto& [u, v] : swapped) std::swap(u, v);
  const std::string text = gltf.text(gltf_mesh(gltf.primitive(triangles, {swapped})), cloth_node);
  CHECK(parse_exactly(text)->uvs == triangles.uvs);
  CHECK(parse_exactly(text, "", 1)->uvs == swapped);
  CHECK_THAT(
      gltf_complaint(text, "", 2),
      EndsWith("a.gltf: error: the object has 2 UV sets, so there is no set 2 (counted from 0)"));
  std::string without = text;
  without.replace(without.find("TEXCOORD_0"), 10, "TEXCOORD_2");
  CHECK_THAT(gltf_complaint(without), EndsWith("the object has UV sets, but not set 0"));
}

TEST_CASE("a glTF without (u,v) is read, and is no grid", "[mesh][read_gltf]") {
  Gltf gltf;
  Mesh sheet = small_sheet(true);
  sheet.uvs.clear();
  const std::string text = gltf.text(gltf_mesh(gltf.primitive(sheet)), cloth_node);
  CHECK(parse_exactly(text)->corner_uvs == std::vector<int>(24, -1));
  CHECK_FALSE(find_grid(parse_exactly(text).value()));
  CHECK_THAT(gltf_complaint(text, "", 1), contains_text("the object has 0 UV sets"));
}

TEST_CASE("a deep chain of nodes in a glTF is walked", "[mesh][read_gltf]") {
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  constexpr int depth = 100000;
  std::string chain;
  for (int k = 1; k <= depth; ++k)
    chain += fmt::format(R"({{"children":[{}],"translation":[0,1,0]}},)", k);
  const Mesh mesh = parse_exactly(gltf.text(meshes, chain + cloth_node)).value();
  CHECK(mesh.positions.col(1) == (small_sheet(true).positions.col(1).array() + depth).matrix());
}

TEST_CASE("skins, morph targets and animation of a glTF are passed over", "[mesh][read_gltf]") {
  Gltf gltf;
  std::string primitive = gltf.primitive(small_sheet(true));
  primitive.insert(1, R"("targets":[{"POSITION":99}],)");
  primitive.insert(primitive.find("\"POSITION\":0"), R"("JOINTS_0":77,"WEIGHTS_0":78,)");
  std::string text =
      gltf.text(gltf_mesh(primitive), R"({"name":"cloth","mesh":0,"skin":5,"weights":[1,2]})");
  text.insert(1, R"("skins":[{"joints":[9,9,9],"inverseBindMatrices":66}],"animations":[{}],)");
  check_equal(parse_exactly(text).value(), small_sheet(true));
}

TEST_CASE("a glTF that cannot be opened is unreadable", "[mesh][read_gltf]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.file("folder.gltf"));
  for (const std::string name : {"none.gltf", "none.glb", "folder.gltf"}) {
    const auto missing = read_mesh(folder.file(name));
    REQUIRE_FALSE(missing);
    CHECK(missing.error().code == ErrorCode::Unreadable);
  }
  const auto other = OpenFile::open(folder.write("a.gltf", "rubbish")).value();
  CHECK(gltf_references(other, {}).empty());
}
