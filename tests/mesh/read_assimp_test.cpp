#include "pliant/mesh/read_assimp.hpp"

#include <algorithm>
#include <functional>
#include <random>

#include <Eigen/Geometry>

#include "mesh/mesh_files.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/read_obj.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

// Coordinates in single precision: 2^-24 of numbers up to 8.
constexpr double float_error = 1e-6;

std::string complaint(const std::filesystem::path& file, const std::string& object = {},
                      int uv_set = 0) {
  const auto mesh = read_assimp(file, object, uv_set);
  if (mesh) return "none";
  CHECK(to_lines(mesh.error()).size() == 1);
  CHECK(to_lines(mesh.error()).front().find('\n') == std::string::npos);
  return to_lines(mesh.error()).front();
}

const std::string cloth_node = R"({"name":"cloth","mesh":0})";

std::string gltf_mesh(const std::string& primitives, const std::string& name = "weave") {
  return fmt::format("{{\"name\":\"{}\",\"primitives\":[{}]}}", name, primitives);
}

std::string collada_node(const std::string& name, const std::string& content) {
  return fmt::format("<node id=\"{0}-id\" name=\"{0}\">{1}</node>\n", name, content);
}

const std::string instance = "<instance_geometry url=\"#g\"/>";

/// A Collada file of the sheet of quads.
std::string sheet_collada(const std::string& nodes, const std::string& asset = "") {
  const Mesh sheet = small_sheet(false);
  return collada(sheet, collada_faces(sheet, 0, 4, false), nodes, asset);
}

/// The sheet as FBX and Collada give it: a vertex for each corner.
Mesh by_corner(const Mesh& mesh) {
  Mesh corners;
  corners.face_sizes = mesh.face_sizes;
  corners.positions.resize(static_cast<Eigen::Index>(mesh.corner_vertices.size()), 3);
  for (std::size_t k = 0; k < mesh.corner_vertices.size(); ++k) {
    corners.positions.row(static_cast<Eigen::Index>(k)) =
        mesh.positions.row(mesh.corner_vertices[k]);
    corners.uvs.push_back(mesh.uvs[static_cast<std::size_t>(mesh.corner_uvs[k])]);
    corners.corner_vertices.push_back(static_cast<int>(k));
  }
  corners.corner_uvs = corners.corner_vertices;
  return corners;
}

void check_equal(const Mesh& mesh, const Mesh& expected) {
  CHECK(mesh.positions == expected.positions);
  CHECK(mesh.uvs == expected.uvs);
  CHECK(mesh.face_sizes == expected.face_sizes);
  CHECK(mesh.corner_vertices == expected.corner_vertices);
  CHECK(mesh.corner_uvs == expected.corner_uvs);
}

}  // namespace

TEST_CASE("a glTF mesh keeps its vertices, their order and (u,v)", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(true);
  sheet.positions.row(0).swap(sheet.positions.row(7));  // any order
  std::swap(sheet.uvs[0], sheet.uvs[7]);
  for (int& vertex : sheet.corner_vertices) vertex = vertex == 0 ? 7 : vertex == 7 ? 0 : vertex;
  sheet.corner_uvs = sheet.corner_vertices;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  check_equal(read_assimp(folder.write("a.gltf", gltf.text(meshes, cloth_node))).value(), sheet);
  check_equal(read_assimp(folder.write("a.GLB", gltf.glb(meshes, cloth_node))).value(), sheet);
}

TEST_CASE("a glTF finds its buffer beside it", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  folder.write("my numbers.bin", gltf.bytes());
  for (const std::string uri : {"my numbers.bin", "my%20numbers.bin"}) {
    const auto file = folder.write("a.gltf", gltf.text(meshes, cloth_node, "0", uri));
    check_equal(read_assimp(file).value(), small_sheet(true));
  }
  const auto file = folder.write("b.gltf", gltf.text(meshes, cloth_node, "0", "none.bin"));
  CHECK_THAT(complaint(file),
             contains_text("b.gltf: error: the file refers to ") &&
                 EndsWith("none.bin: cannot read the file: No such file or directory"));
  folder.write("short.bin", gltf.bytes().substr(0, 40));
  CHECK_THAT(complaint(folder.write("c.gltf", gltf.text(meshes, cloth_node, "0", "short.bin"))),
             contains_text("c.gltf: error: the file cannot be read: "));
  CHECK_THAT(complaint(folder.write("d.gltf", gltf.text(meshes, cloth_node, "0", "."))),
             contains_text("d.gltf: error: the file "));
}

TEST_CASE("Collada and FBX keep quads, with a vertex for each corner", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  check_equal(
      read_assimp(folder.write("a.dae", sheet_collada(collada_node("n", instance)))).value(),
      by_corner(sheet));
  Mesh moved = by_corner(sheet);
  moved.positions = (2 * moved.positions).rowwise() + Eigen::RowVector3d(1, 2, 3);
  check_equal(read_assimp(folder.write("a.fbx", fbx_text(sheet))).value(), moved);
  for (const int version : {7400, 7500}) {
    const auto file = folder.write("b.fbx", fbx_binary(sheet, {.version = version}));
    check_equal(read_assimp(file).value(), moved);
  }
}

TEST_CASE("(u,v) point the same way in every format", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(true);
  for (auto& [u, v] : sheet.uvs) v = v * 0.5;  // not its own mirror image
  std::string obj;
  for (int k = 0; k < 9; ++k) {
    obj += fmt::format("v {} {} {}\nvt {} {}\n", sheet.positions(k, 0), sheet.positions(k, 1),
                       sheet.positions(k, 2), sheet.uvs[k][0], sheet.uvs[k][1]);
  }
  for (std::size_t k = 0; k < sheet.corner_vertices.size(); k += 3) {
    obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", sheet.corner_vertices[k] + 1,
                       sheet.corner_vertices[k + 1] + 1, sheet.corner_vertices[k + 2] + 1);
  }
  Gltf gltf;
  const std::string primitive = gltf.primitive(sheet);
  const std::string text =
      collada(sheet, collada_faces(sheet, 0, 8, false), collada_node("n", instance));
  const GridMapping of_obj = find_grid(parse_obj(obj, "a.obj").value()).value();
  for (const auto& file : {folder.write("a.gltf", gltf.text(gltf_mesh(primitive), cloth_node)),
                           folder.write("a.dae", text)}) {
    const GridMapping mapping = find_grid(read_assimp(file).value()).value();
    CHECK(mapping.grid == of_obj.grid);
    CHECK(mapping.rest == of_obj.rest);
  }
}

TEST_CASE("the transforms of a node and of all above it apply", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(true);
  const double half = std::sqrt(0.5);
  const auto moved = [&](const Vector3d& scale) -> Field {
    const Eigen::Affine3d transform = Eigen::Translation3d(1, -2, 3) *
                                      Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitY()) *
                                      Eigen::Scaling(scale) * Eigen::Translation3d(0.5, 0, 0);
    return (transform * sheet.positions.transpose()).transpose();
  };
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const auto scale = GENERATE(std::array{2, 3, 4}, std::array{-2, 3, 4});  // the second mirrors
  const std::string nodes = fmt::format(
      R"({{"name":"parent","children":[1],"translation":[1,-2,3],"rotation":[0,{0:.17},0,{0:.17}],)"
      R"("scale":[{1},{2},{3}]}},{{"name":"cloth","mesh":0,"translation":[0.5,0,0]}})",
      half, scale[0], scale[1], scale[2]);
  const Mesh mesh = read_assimp(folder.write("a.gltf", gltf.text(meshes, nodes))).value();
  CHECK((mesh.positions - moved({scale[0] * 1.0, scale[1] * 1.0, scale[2] * 1.0}))
            .cwiseAbs()
            .maxCoeff() < 8 * float_error);
  CHECK(mesh.corner_vertices == sheet.corner_vertices);  // a mirror turns no face round
}

TEST_CASE("without a transform positions keep their bits", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(true);
  for (double& number : sheet.positions.reshaped()) number = static_cast<float>(number / 3);
  sheet.positions(0, 1) = -0.0;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const Mesh mesh = read_assimp(folder.write("a.gltf", gltf.text(meshes, cloth_node))).value();
  CHECK(mesh.positions == sheet.positions);
  CHECK(std::signbit(mesh.positions(0, 1)));
}

TEST_CASE("Collada's unit and up axis are applied", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const std::string asset = "<unit name=\"cm\" meter=\"0.01\"/><up_axis>Z_UP</up_axis>";
  const auto file = folder.write("a.dae", sheet_collada(collada_node("n", instance), asset));
  const Field positions = read_assimp(file)->positions;
  const Field sheet = by_corner(small_sheet(false)).positions;
  Field expected(sheet.rows(), 3);
  expected << 0.01 * sheet.col(0), 0.01 * sheet.col(2), -0.01 * sheet.col(1);
  CHECK((positions - expected).cwiseAbs().maxCoeff() < float_error);
}

TEST_CASE("an object is a node with faces, taken by its name", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  Mesh other = small_sheet(true);
  other.positions.array() += 8;
  const std::string first = gltf_mesh(gltf.primitive(small_sheet(true)), "weave");
  const std::string second = gltf_mesh(gltf.primitive(other), "knit");
  const std::string nodes =
      R"({"name":"empty","children":[1,2]},{"name":"left","mesh":0},{"name":"right","mesh":1})";
  const auto file = folder.write("a.gltf", gltf.text(first + "," + second, nodes));
  check_equal(read_assimp(file, "left").value(), small_sheet(true));
  CHECK(read_assimp(file, "right")->positions == other.positions);
  CHECK(read_assimp(file, "knit")->positions == other.positions);  // the mesh's own name
  CHECK_THAT(complaint(file),
             EndsWith("a.gltf: error: the file holds 2 objects; name one with object: \"left\", "
                      "\"right\""));
  CHECK_THAT(complaint(file, "empty"),
             EndsWith("the file holds no object \"empty\"; it holds: \"left\", \"right\""));
}

TEST_CASE("an instanced mesh is an object in each of its nodes", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::string nodes =
      R"({"name":"left","mesh":0},{"name":"right","mesh":0,"translation":[5,0,0]})";
  const auto file = folder.write("a.gltf", gltf.text(meshes, nodes, "0,1"));
  CHECK_THAT(complaint(file), contains_text("2 objects"));
  CHECK_THAT(complaint(file, "weave"), contains_text("2 objects of the name \"weave\""));
  CHECK(read_assimp(file, "right")->positions.col(0) ==
        (read_assimp(file, "left")->positions.col(0).array() + 5).matrix());
}

TEST_CASE("a list of many objects is cut", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  std::string nodes = R"({"name":"n0","mesh":0})", roots = "0";
  for (int k = 1; k < 30; ++k) {
    nodes += fmt::format(R"(,{{"name":"n{}","mesh":0}})", k);
    roots += fmt::format(",{}", k);
  }
  CHECK_THAT(complaint(folder.write("a.gltf", gltf.text(meshes, nodes, roots))),
             EndsWith("\"n9\", … (30 in all)"));
}

TEST_CASE("a node's meshes of several materials become one", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const std::string faces = collada_faces(sheet, 0, 1, false) + collada_faces(sheet, 1, 4, false);
  const auto file = folder.write("a.dae", collada(sheet, faces, collada_node("n", instance)));
  check_equal(read_assimp(file).value(), by_corner(sheet));
  CHECK(find_grid(read_assimp(file).value()));

  Gltf gltf;
  Mesh other = small_sheet(true);
  other.positions.array() += 8;
  const std::string both = gltf.primitive(small_sheet(true)) + "," + gltf.primitive(other);
  const Mesh merged =
      read_assimp(folder.write("a.gltf", gltf.text(gltf_mesh(both), cloth_node))).value();
  CHECK(merged.vertex_count() == 18);
  CHECK(merged.positions.bottomRows(9) == other.positions);
  CHECK(merged.corner_vertices.at(24) == other.corner_vertices[0] + 9);
  CHECK(merged.corner_uvs == merged.corner_vertices);
}

TEST_CASE("the set of (u,v) is taken by its number", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const auto file = folder.write(
      "a.dae", collada(sheet, collada_faces(sheet, 0, 4, true), collada_node("n", instance)));
  const Mesh first = read_assimp(file).value();
  const Mesh second = read_assimp(file, "", 1).value();
  CHECK(first.uvs == by_corner(sheet).uvs);
  for (std::size_t k = 0; k < first.uvs.size(); ++k)
    CHECK(second.uvs[k] == std::array{first.uvs[k][1], first.uvs[k][0]});
  CHECK_THAT(complaint(file, "", 2),
             EndsWith("a.dae: error: the object has 2 UV sets, so there is no set 2 (they count "
                      "from 0)"));
  CHECK(read_assimp(folder.write("a.fbx", fbx_text(sheet)), "", 1)->uvs == by_corner(sheet).uvs);
  Gltf gltf;
  const Mesh triangles = small_sheet(true);
  std::vector<std::array<double, 2>> swapped = triangles.uvs;
  for (auto& [u, v] : swapped) std::swap(u, v);
  const std::string meshes = gltf_mesh(gltf.primitive(triangles, {swapped}));
  CHECK(read_assimp(folder.write("a.gltf", gltf.text(meshes, cloth_node)), "", 1)->uvs == swapped);
}

TEST_CASE("a mesh without (u,v) is read, and is no grid", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  Mesh sheet = small_sheet(true);
  sheet.uvs.clear();
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  const auto file = folder.write("a.gltf", gltf.text(meshes, cloth_node));
  CHECK(read_assimp(file)->corner_uvs == std::vector<int>(24, -1));
  CHECK_THAT(find_grid(read_assimp(file).value()).error().message, contains_text("has no (u,v)"));
  CHECK_THAT(complaint(file, "", 1), contains_text("the object has 0 UV sets"));
}

TEST_CASE("points and lines are passed over, and are not enough", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string sheet = gltf.primitive(small_sheet(true));
  std::string lines = sheet, points = sheet;
  lines.insert(1, "\"mode\":1,");
  points.insert(1, "\"mode\":0,");
  const auto both = gltf.text(gltf_mesh(lines + "," + sheet + "," + points), cloth_node);
  check_equal(read_assimp(folder.write("a.gltf", both)).value(), small_sheet(true));
  for (const std::string& only : {lines, points}) {
    CHECK_THAT(complaint(folder.write("b.gltf", gltf.text(gltf_mesh(only), cloth_node))),
               EndsWith("b.gltf: error: the file holds no faces"));
  }
}

TEST_CASE("coordinates that are not finite are refused", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(true);
  SECTION("a position") { sheet.positions(4, 1) = NAN; }
  SECTION("a (u,v)") { sheet.uvs[4][0] = INFINITY; }
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(sheet));
  CHECK_THAT(
      complaint(folder.write("a.gltf", gltf.text(meshes, cloth_node))),
      contains_text("a.gltf: error: ") && contains_text(" 5 ") && contains_text("not finite"));
}

TEST_CASE("a transform that is not affine is refused", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::string node =
      R"({"name":"cloth","mesh":0,"matrix":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]})";
  CHECK_THAT(complaint(folder.write("a.gltf", gltf.text(meshes, node))),
             EndsWith("the object's transform is not affine: its last row is 0.5 0 0 1, not 0 0 0 "
                      "1"));
}

TEST_CASE("a file that cannot be opened is unreadable", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  for (const std::string ending : {"gltf", "glb", "fbx", "dae"}) {
    const auto missing = read_assimp(folder.file("none." + ending));
    REQUIRE_FALSE(missing);
    CHECK(missing.error().code == ErrorCode::Unreadable);
    CHECK_THAT(missing.error().message, contains_text("No such file"));
    std::filesystem::create_directory(folder.file("folder." + ending));
    const auto a_folder = read_assimp(folder.file("folder." + ending));
    REQUIRE_FALSE(a_folder);
    CHECK(a_folder.error().code == ErrorCode::Unreadable);
  }
}

TEST_CASE("a broken file is one line with the reason", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const std::string dae = sheet_collada(collada_node("n", instance));
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  struct Case {
    std::string name, text, expected;
  };
  const std::vector<Case> cases = {
      {"a.gltf", "", "a.gltf: error: the file cannot be read: "},
      {"a.gltf", "{\"asset\":\n{\"version\"", "a.gltf: error: the file cannot be read: "},
      {"a.gltf", "{}", "a.gltf: error: the file cannot be read: "},
      {"a.gltf", "ply\nformat ascii 1.0\n", "a.gltf: error: the file cannot be read: "},
      {"a.glb", "", "a.glb: error: the file is no glTF"},
      {"a.glb", "glTF" + little_endian(2, 4) + little_endian(400, 4),
       "a.glb: error: the file is cut short: it has 12 of 400 bytes"},
      {"a.glb",
       "glTF" + little_endian(2, 4) + little_endian(20, 4) + little_endian(1u << 30, 4) + "JSON",
       "a.glb: error: the chunk at byte 12 reaches past the end of the file"},
      {"a.fbx", "", "a.fbx: error: the file cannot be read: "},
      {"a.fbx", "Kaydara FBX Binary  ", "a.fbx: error: the file cannot be read: "},
      {"a.fbx", "Objects: {", "a.fbx: error: the file cannot be read: "},
      {"a.fbx", changed(fbx_text(small_sheet(false)), "Layer: 0 {", "Layer: {"),
       "a.fbx: error: Layer has no number"},
      {"a.fbx", changed(fbx_text(small_sheet(false)), "LayerElementUV: 0 {", "LayerElementUV: {"),
       "a.fbx: error: LayerElementUV has no number"},
      {"a.fbx", changed(fbx_text(small_sheet(false)), "Layer: 0 {", "Layer:\nx: {"),
       "a.fbx: error: Layer has no number"},
      {"a.fbx", fbx_binary(small_sheet(false), {.has_layer_number = false}),
       "a.fbx: error: Layer has no number"},
      {"a.dae", "", "a.dae: error: the file is no sound XML (XML_ERROR_EMPTY_DOCUMENT)"},
      {"a.dae", "<COLLADA/>", "a.dae: error: the file "},
      {"a.dae", "<scene>", "a.dae:1: error: the file is no sound XML"},
      {"a.dae", changed(dae, "count=\"27\"", "count=\"26\""),
       "a.dae:5: error: <accessor> reads 27 numbers of \"pa\", which has 26"},
      {"a.dae", changed(dae, "#pa", "#none"),
       "a.dae:5: error: <accessor> reads 27 numbers of \"none\", which has 0"},
      {"a.dae", changed(dae, "stride=\"3\"", "stride=\"x\""),
       "a.dae:5: error: <accessor> has a count, stride or offset that is no whole number"},
      {"a.dae", changed(dae, "count=\"9\" stride=\"3\"", "count=\"9\" stride=\"2\""),
       "a.dae:5: error: <accessor> has 3 parameters, but a stride of 2"},
      {"a.dae", changed(dae, "<p>0 ", "<p>] "),
       "a.dae:9: error: <p> holds something other than whole numbers"},
      {"a.dae", changed(dae, "<p>0 ", "<p>99 "), "a.dae: error: the file cannot be read: "}};
  for (const Case& c : cases) {
    CAPTURE(c.text);
    CHECK_THAT(complaint(folder.write(c.name, c.text)), contains_text(c.expected));
  }
}

TEST_CASE("parts within parts without end are refused", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const auto repeated = [](const std::string& text, int count) {
    std::string all;
    for (int k = 0; k < count; ++k) all += text;
    return all;
  };
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  std::string chain, doubling;
  for (int k = 1; k <= 3000; ++k) chain += fmt::format(R"({{"children":[{}]}},)", k);
  for (int k = 1; k <= 40; ++k) doubling += fmt::format(R"({{"children":[{0},{0}]}},)", k);
  const auto circle = [](const std::string& target) {
    return sheet_collada(
        "<node id=\"q\" name=\"n\"><instance_geometry url=\"#g\"/><node>"
        "<instance_node url=\"#" +
        target + "\"/></node></node>");
  };
  std::string of_library = circle("q");
  of_library.replace(of_library.rfind("#s"), 2, "#l");
  of_library.insert(
      of_library.find("<library_visual"),
      "<library_nodes><node id=\"l\"><instance_node url=\"#l\"/></node></library_nodes>");
  std::string copies = "<node id=\"q0\"><instance_geometry url=\"#g\"/></node>";
  for (int k = 1; k <= 40; ++k) {
    copies += fmt::format(
        "<node id=\"q{0}\"><instance_node url=\"#q{1}\"/><instance_node url=\"#q{1}\"/></node>", k,
        k - 1);
  }
  struct Case {
    std::string name, text, expected;
  };
  const std::vector<Case> cases = {
      {"a.gltf", repeated("[", 1000000), "nests its parts more than 200 deep"},
      {"b.gltf", gltf.text(meshes, chain + cloth_node), "more than 2000 nodes with children"},
      {"c.gltf", gltf.text(meshes, doubling + cloth_node), "node 1 of the file is a child twice"},
      {"a.glb", gltf.glb(meshes, doubling + cloth_node), "node 1 of the file is a child twice"},
      {"a.fbx", "; FBX\n" + repeated("a: {\n", 300000), "nests its parts more than 200 deep"},
      {"b.fbx", "; FBX \"\n" + repeated("a: {\n", 300000), "nests its parts more than 200 deep"},
      {"a.dae", repeated("<node>", 100000), "XML_ELEMENT_DEPTH_EXCEEDED"},
      {"b.dae", circle("q"), "nests its parts more than 200 deep"},
      {"b.dae", circle("n"), "nests its parts more than 200 deep"},      // by the name
      {"b.dae", circle(""), "nests its parts more than 200 deep"},       // the nameless node
      {"b.dae", circle("s"), "nests its parts more than 200 deep"},      // the scene
      {"b.dae", circle("Scene"), "nests its parts more than 200 deep"},  // the nameless scene
      {"b.dae", of_library, "nests its parts more than 200 deep"},
      {"c.dae", sheet_collada(copies), "instances make more than 1000000 nodes"}};
  for (const Case& c : cases) {
    CAPTURE(c.name);
    CHECK_THAT(complaint(folder.write(c.name, c.text)), contains_text(c.expected));
  }
}

TEST_CASE("FBX models within themselves or without end are refused", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const auto texts_of = [&](FbxMore more) {
    std::vector<std::string> texts = {fbx_text(sheet, more), fbx_binary(sheet, more)};
    more.version = 7500;
    texts.push_back(fbx_binary(sheet, more));
    return texts;
  };
  // Each model below the one before, the first below `parent`.
  const auto chain = [](int length) {
    FbxMore more;
    for (int k = 0; k < length; ++k) {
      more.models.push_back(100 + k);
      more.links.push_back({100 + k, k == 0 ? 20 : 99 + k});
    }
    return more;
  };
  FbxMore doubling = chain(40);
  const auto once = doubling.links;
  doubling.links.insert(doubling.links.end(), once.begin(), once.end());
  FbxMore many;
  many.links.assign(20000, {21, 20});
  struct Case {
    FbxMore more;
    std::string expected;
  };
  const std::vector<Case> cases = {
      {{.links = {{20, 20}}}, "nests its parts more than 200 deep"},
      {{.links = {{21, 21}}}, "nests its parts more than 200 deep"},
      {{.links = {{20, 21}}}, "nests its parts more than 200 deep"},
      {{.models = {30}, .links = {{30, 21}, {20, 30}}}, "nests its parts more than 200 deep"},
      {{.links = {{21, 21}}, .gap = 8}, "nests its parts more than 200 deep"},
      {chain(5000), "nests its parts more than 200 deep"},
      {doubling, "links make more than 10000 copies of its models"},
      {many, "links make more than 10000 copies of its models"}};
  for (const Case& c : cases) {
    for (const std::string& text : texts_of(c.more))
      CHECK_THAT(complaint(folder.write("a.fbx", text)), contains_text(c.expected));
  }
  // Links to a geometry or a property make no child, and a circle may be out of the root's reach.
  const std::vector<FbxMore> sound = {chain(150),
                                      {.links = {{21, 10}, {0, 21}}},
                                      {.links = {{20, 21, "LookAtProperty"}}},
                                      {.gap = 8},
                                      {.models = {30, 31}, .links = {{30, 31}, {31, 30}}}};
  for (const FbxMore& more : sound) {
    for (const std::string& text : texts_of(more))
      CHECK(read_assimp(folder.write("a.fbx", text))->face_sizes == sheet.face_sizes);
  }
}

TEST_CASE("no prefix or mutation of a mesh file does harm", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  Gltf gltf;
  const std::string meshes = gltf_mesh(gltf.primitive(small_sheet(true)));
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.gltf", gltf.text(meshes, cloth_node)},
      {"a.glb", gltf.glb(meshes, cloth_node)},
      {"a.dae", sheet_collada(collada_node("n", instance))},
      {"a.fbx", fbx_text(small_sheet(false))},
      {"b.fbx", fbx_binary(small_sheet(false))}};
  std::mt19937 random(1);
  for (const auto& [name, whole] : files) {
    const auto check = [&, &name = name](const std::string& text) {
      const auto mesh = read_assimp(folder.write(name, text));
      if (mesh) CHECK(check_mesh(*mesh));
      if (!mesh) CHECK(to_lines(mesh.error()).front().find('\n') == std::string::npos);
    };
    for (std::size_t length = 0; length < whole.size(); ++length) check(whole.substr(0, length));
    for (int trial = 0; trial < 300; ++trial) {
      std::string mutant = whole;
      for (int k = 0; k < 2; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
      check(mutant);
    }
  }
}
