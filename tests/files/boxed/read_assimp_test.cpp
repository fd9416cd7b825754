#include "pliant/files/boxed/read_assimp.hpp"

#include <algorithm>
#include <atomic>
#include <random>
#include <sstream>
#include <thread>

#include <Eigen/Geometry>

#include "files/mesh_files.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "support/area_vectors.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
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

std::string collada_node(const std::string& name, const std::string& content) {
  return fmt::format("<node id=\"{0}-id\" name=\"{0}\">{1}</node>\n", name, content);
}

const std::string instance = "<instance_geometry url=\"#g\"/>";

/// A Collada file of the sheet of quads.
std::string sheet_collada(const std::string& nodes, const std::string& asset = "") {
  const Mesh sheet = small_sheet(false);
  return collada(sheet, collada_faces(sheet, 0, 4, false), nodes, asset);
}

/// The sheet as FBX and Collada store it: a vertex for each corner.
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

/// A Collada file of the sheet of quads, with one text replaced.
std::string changed_collada(const std::string& from, const std::string& to) {
  std::string text = sheet_collada(collada_node("n", instance));
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("Collada and FBX keep quads, with a vertex for each corner",
          "[mesh][read_assimp][threads][boxed]") {
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

TEST_CASE("(u,v) point the same way as in OBJ", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(true);
  for (auto& [u, v] : sheet.uvs) v = v * 0.5;  // not symmetric in v
  const GridMapping of_obj = find_grid(parse_obj(obj_text(sheet), "a.obj").value()).value();
  const auto file = folder.write(
      "a.dae", collada(sheet, collada_faces(sheet, 0, 8, false), collada_node("n", instance)));
  const GridMapping mapping = find_grid(read_assimp(file).value()).value();
  CHECK(mapping.grid == of_obj.grid);
  CHECK(mapping.rest == of_obj.rest);
}

TEST_CASE("the transforms of a node and of all above it apply",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = by_corner(small_sheet(false));
  const auto scale = GENERATE(std::array{2, 3, 4}, std::array{-2, 3, 4});  // the second mirrors
  const Eigen::Affine3d transform =
      Eigen::Translation3d(1, -2, 3) * Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitY()) *
      Eigen::Scaling(Vector3d(scale[0], scale[1], scale[2])) * Eigen::Translation3d(0.5, 0, 0);
  const std::string nodes = collada_node(
      "parent", fmt::format("<translate>1 -2 3</translate><rotate>0 1 0 90</rotate>"
                            "<scale>{} {} {}</scale>",
                            scale[0], scale[1], scale[2]) +
                    collada_node("cloth", "<translate>0.5 0 0</translate>" + instance));
  const Mesh mesh = read_assimp(folder.write("a.dae", sheet_collada(nodes))).value();
  const Field expected = (transform * sheet.positions.transpose()).transpose();
  CHECK((mesh.positions - expected).cwiseAbs().maxCoeff() < 8 * float_error);
  Mesh turned = sheet;
  if (scale[0] < 0) turn_faces(turned);
  CHECK(mesh.corner_vertices == turned.corner_vertices);
}

TEST_CASE("without a transform positions keep their bits", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(false);
  sheet.positions.array() /= 1024;
  sheet.positions(0, 1) = -0.0;
  const std::string text =
      collada(sheet, collada_faces(sheet, 0, 4, false), collada_node("n", instance));
  const Mesh mesh = read_assimp(folder.write("a.dae", text)).value();
  CHECK(mesh.positions == by_corner(sheet).positions);
  const auto corner = std::find(sheet.corner_vertices.begin(), sheet.corner_vertices.end(), 0);
  CHECK(std::signbit(mesh.positions(corner - sheet.corner_vertices.begin(), 1)));
}

TEST_CASE("Collada's unit and up axis are applied", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const std::string asset = "<unit name=\"cm\" meter=\"0.01\"/><up_axis>Z_UP</up_axis>";
  const auto file = folder.write("a.dae", sheet_collada(collada_node("n", instance), asset));
  const Field positions = read_assimp(file)->positions;
  const Field sheet = by_corner(small_sheet(false)).positions;
  Field expected(sheet.rows(), 3);
  expected << 0.01 * sheet.col(0), 0.01 * sheet.col(2), -0.01 * sheet.col(1);
  CHECK((positions - expected).cwiseAbs().maxCoeff() < float_error);
}

TEST_CASE("an object is a node with faces, taken by its name",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const std::string right = collada_node("right", "<translate>5 0 0</translate>" + instance);
  const std::string nodes = collada_node("empty", collada_node("left", instance) + right);
  const auto file = folder.write("a.dae", sheet_collada(nodes));
  const Mesh left = read_assimp(file, "left").value();
  check_equal(left, by_corner(small_sheet(false)));
  CHECK(left.object == "left");
  CHECK(read_assimp(file, "right")->positions.col(0) ==
        (left.positions.col(0).array() + 5).matrix());
  CHECK_THAT(complaint(file),
             contains_text("a.dae: error: the file has 2 objects; choose one with the "
                           "attribute object: \"left\", \"right\""));
  CHECK_THAT(complaint(file, "empty"),
             contains_text("the file has no object \"empty\"; it has: \"left\", \"right\""));
  CHECK_THAT(complaint(file, "cloth"), contains_text("2 objects named \"cloth\""));
  const auto single = folder.write("b.dae", sheet_collada(collada_node("left", instance)));
  CHECK(read_assimp(single, "cloth")->positions == left.positions);  // the mesh's own name
}

TEST_CASE("faces keep their outer sides where FBX and Collada reflect them",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = by_corner(small_sheet(false));
  for (const std::string scale : {"-2 2 2", "2 -2 2", "-2 -2 -2", "-2 2 -2", "2 2 2"}) {
    std::istringstream words(scale);
    Vector3d numbers;
    words >> numbers[0] >> numbers[1] >> numbers[2];
    std::string fbx = fbx_text(small_sheet(false));
    const std::string own = "\"A\", 2, 2, 2";
    REQUIRE(fbx.find(own) != std::string::npos);
    fbx.replace(fbx.find(own), own.size(),
                fmt::format("\"A\", {}, {}, {}", numbers[0], numbers[1], numbers[2]));
    const auto scaled =
        collada_node("p", fmt::format("<scale>{}</scale>{}", scale, collada_node("n", instance)));
    const Matrix3d linear = numbers.asDiagonal();
    Mesh expected = sheet;
    if (linear.determinant() < 0) turn_faces(expected);
    for (const auto& file :
         {folder.write("a.fbx", fbx), folder.write("a.dae", sheet_collada(scaled))}) {
      CAPTURE(scale, file.string());
      const Mesh read = read_assimp(file).value();
      CHECK(read.corner_vertices == expected.corner_vertices);
      CHECK(read.corner_uvs == expected.corner_uvs);
      const Field moved = moved_areas(area_vectors(sheet), linear);
      CHECK((area_vectors(read) - moved).cwiseAbs().maxCoeff() < 1e-5);
    }
  }
}

TEST_CASE("the objects of FBX and Collada are listed as they are read and chosen",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const std::string nodes = collada_node("one", instance) + collada_node("two", instance) +
                            collada_node("one", "<translate>5 0 0</translate>" + instance);
  const auto file = folder.write("a.dae", sheet_collada(nodes));
  const auto objects = assimp_objects(file).value();
  REQUIRE(objects.size() == 3);
  const std::vector<std::string> choices = {"one#1", "two", "one#2"};
  for (std::size_t k = 0; k < objects.size(); ++k) {
    CHECK(objects[k].name == (k == 1 ? "two" : "one"));
    CHECK(objects[k].choice == choices[k]);
    const Mesh mesh = read_assimp(file, choices[k]).value();
    CHECK(static_cast<std::uint64_t>(mesh.vertex_count()) == objects[k].vertices);
    CHECK(mesh.face_sizes.size() == objects[k].faces);
    CHECK(mesh.positions.col(0).minCoeff() ==
          small_sheet(false).positions.col(0).minCoeff() + (k == 2 ? 5 : 0));
    CHECK(read_assimp(file, fmt::format("#{}", k + 1))->positions == mesh.positions);
  }
  CHECK_THAT(complaint(file, "one"), contains_text("2 objects named \"one\""));
  CHECK_THAT(complaint(file, "#4"), contains_text("no object \"#4\""));
}

TEST_CASE("a list of many objects is cut", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  std::string nodes;
  for (int k = 0; k < 30; ++k) nodes += collada_node(fmt::format("n{}", k), instance);
  CHECK_THAT(complaint(folder.write("a.dae", sheet_collada(nodes))),
             contains_text("\"n9\", … (30 in all); "));
}

TEST_CASE("a node's meshes of several materials become one",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const std::string faces = collada_faces(sheet, 0, 1, false) + collada_faces(sheet, 1, 4, false);
  const auto file = folder.write("a.dae", collada(sheet, faces, collada_node("n", instance)));
  check_equal(read_assimp(file).value(), by_corner(sheet));
  CHECK(find_grid(read_assimp(file).value()));
}

TEST_CASE("the set of (u,v) is taken by its number", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const auto file = folder.write(
      "a.dae", collada(sheet, collada_faces(sheet, 0, 4, true), collada_node("n", instance)));
  const Mesh first = read_assimp(file).value();
  const Mesh second = read_assimp(file, "", 1).value();
  CHECK(first.uvs == by_corner(sheet).uvs);
  for (std::size_t k = 0; k < first.uvs.size(); ++k)
    CHECK(second.uvs[k] == std::array{first.uvs[k][1], first.uvs[k][0]});
  CHECK_THAT(
      complaint(file, "", 2),
      EndsWith("a.dae: error: the object has 2 UV sets, so there is no set 2 (counted from 0)"));
  CHECK(read_assimp(folder.write("a.fbx", fbx_text(sheet)), "", 1)->uvs == by_corner(sheet).uvs);
}

TEST_CASE("a mesh without (u,v) is read, and is no grid", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const auto file = folder.write(
      "a.dae",
      changed_collada("<input semantic=\"TEXCOORD\" source=\"#t\" offset=\"1\" set=\"0\"/>",
                      "<input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/>"));
  CHECK(read_assimp(file)->corner_uvs == std::vector<int>(16, -1));
  CHECK_THAT(find_grid(read_assimp(file).value()).error().message, contains_text("no (u,v)"));
  CHECK_THAT(complaint(file, "", 1), contains_text("the object has 0 UV sets"));
}

TEST_CASE("points and lines are passed over, and are not enough",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const std::string lines =
      "<lines count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
      "<p>0 1 1 2</p></lines>\n";
  const std::string node = collada_node("n", instance);
  const auto both = collada(sheet, lines + collada_faces(sheet, 0, 4, false) + lines, node);
  check_equal(read_assimp(folder.write("a.dae", both)).value(), by_corner(sheet));
  CHECK_THAT(complaint(folder.write("b.dae", collada(sheet, lines, node))),
             EndsWith("b.dae: error: the file has no faces"));
}

TEST_CASE("coordinates that are not finite are refused", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(false);
  sheet.positions(4, 1) = NAN;
  const auto file = folder.write("a.fbx", fbx_binary(sheet));
  CHECK_THAT(complaint(file), contains_text("a.fbx: error: ") && contains_text("not finite"));
}

TEST_CASE("what has no place in a mesh of FBX or Collada is left out and counted",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  Mesh sheet = small_sheet(false);
  sheet.uvs[4][0] = NAN;  // of four corners
  const Mesh mesh = read_assimp(folder.write("a.fbx", fbx_binary(sheet))).value();
  CHECK(mesh.left_out == "4 (u,v) that are not pairs of numbers");
  CHECK(std::count(mesh.corner_uvs.begin(), mesh.corner_uvs.end(), -1) == 4);
  const std::string lines =
      "<lines count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
      "<p>0 1 1 2</p></lines>\n";
  sheet = small_sheet(false);
  const auto both =
      collada(sheet, lines + collada_faces(sheet, 0, 4, false), collada_node("n", instance));
  CHECK(read_assimp(folder.write("a.dae", both))->left_out ==
        "2 faces of fewer than three corners");
}

TEST_CASE("a transform that is not affine is refused", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const std::string node =
      collada_node("n", "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0.5 0 0 1</matrix>" + instance);
  CHECK_THAT(complaint(folder.write("a.dae", sheet_collada(node))),
             EndsWith("the object's transform is not affine: its last row is 0.5 0 0 1, not 0 0 0 "
                      "1"));
}

TEST_CASE("a file that cannot be opened is unreadable", "[mesh][read_assimp]") {
  const ScratchFolder folder;
  for (const std::string ending : {"fbx", "dae"}) {
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

TEST_CASE("a broken file is one line with the reason", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  struct Case {
    std::string name, text, expected;
  };
  const std::vector<Case> cases = {
      {"a.fbx", "", "a.fbx: error: the file is not FBX"},
      {"a.fbx", "Kaydara FBX Binary  ", "a.fbx: error: the "},
      {"a.fbx", "; FBX 7.4.0\nObjects: {", "a.fbx: error: the file cannot be read: "},
      {"a.dae", "", "a.dae: error: the file is not Collada"},
      {"a.dae", "<COLLADA/>", "a.dae: error: the file "},
      {"a.dae", "<scene>", "a.dae: error: the file is not Collada"},
      {"a.dae", changed_collada("<p>0 ", "<p>99 "), "a.dae: error: the file cannot be read: "}};
  for (const Case& c : cases) {
    CAPTURE(c.text);
    CHECK_THAT(complaint(folder.write(c.name, c.text)), contains_text(c.expected));
  }
}

TEST_CASE("of a file that is something else nothing is told",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  for (const std::string ending : {"fbx", "dae"}) {
    for (const std::string text : {"root:x:0:0:root:/root:/bin/bash\n", "<secret>root</secret>"}) {
      const auto told = read_assimp(folder.write("a." + ending, text));
      REQUIRE_FALSE(told);
      CHECK_THAT(told.error().message, !contains_text("root") && !contains_text("secret"));
    }
  }
}

// The result of assimp 5.2 for each file does not matter: a crash, an error, even a mesh. It must
// not harm this process, must end, and must be reported in one line.
TEST_CASE("files made to break assimp break nothing of ours",
          "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const std::string node = collada_node("n", instance);
  const auto circle = [](const std::string& target) {
    return sheet_collada(
        "<node id=\"q\" name=\"n\"><instance_geometry url=\"#g\"/><node>"
        "<instance_node url=\"#" +
        target + "\"/></node></node>");
  };
  std::string copies = "<node id=\"q0\"><instance_geometry url=\"#g\"/></node>";
  for (int k = 1; k <= 40; ++k) {
    copies += fmt::format(
        "<node id=\"q{0}\"><instance_node url=\"#q{1}\"/><instance_node url=\"#q{1}\"/></node>", k,
        k - 1);
  }
  const std::string no_vertex =
      collada(sheet,
              "<triangles count=\"2\"><input semantic=\"TEXCOORD\" source=\"#t\" offset=\"0\"/>"
              "<p>0 1 2 0 2 3</p></triangles>",
              node);
  // A skin with fewer joints than its weights refer to, and with more counts than weights.
  std::string skin =
      sheet_collada(collada_node("n",
                                 "<instance_controller url=\"#c\"><skeleton>#j</skeleton>"
                                 "</instance_controller>") +
                    "<node id=\"j\" sid=\"J\" type=\"JOINT\"/>");
  skin.insert(skin.find("<library_visual"),
              "<library_controllers><controller id=\"c\"><skin source=\"#g\"><source id=\"jn\">"
              "<Name_array id=\"jna\" count=\"1\">J</Name_array><technique_common><accessor "
              "source=\"#jna\" count=\"9\" stride=\"1\"><param name=\"JOINT\" type=\"name\"/>"
              "</accessor></technique_common></source><source id=\"w\"><float_array id=\"wa\" "
              "count=\"1\">1</float_array><technique_common><accessor source=\"#wa\" count=\"99\" "
              "stride=\"1\"><param name=\"WEIGHT\" type=\"float\"/></accessor></technique_common>"
              "</source><joints><input semantic=\"JOINT\" source=\"#jn\"/><input "
              "semantic=\"INV_BIND_MATRIX\" source=\"#w\"/></joints><vertex_weights count=\"9\">"
              "<input semantic=\"JOINT\" source=\"#jn\" offset=\"0\"/><input semantic=\"WEIGHT\" "
              "source=\"#w\" offset=\"1\"/><vcount>1 1 1 1 1 1 1 1 99</vcount><v>0 0 7 5 8 9999 3 "
              "3 0 123456789</v></vertex_weights></skin></controller></library_controllers>\n");
  FbxMore many;
  many.links.assign(20000, {21, 20});
  FbxMore chain;
  for (int k = 0; k < 5000; ++k) {
    chain.models.push_back(100 + k);
    chain.links.push_back({100 + k, k == 0 ? 20 : 99 + k});
  }
  const std::vector<std::pair<std::string, std::string>> files = {
      {"no_vertex.dae", no_vertex},
      {"skin.dae", skin},
      {"long.dae", changed_collada("count=\"9\" stride=\"3\"", "count=\"90000\" stride=\"3\"")},
      {"huge.dae",
       changed_collada("count=\"9\" stride=\"3\"", "count=\"4294967295\" stride=\"4294967295\"")},
      {"stride.dae", changed_collada("stride=\"3\"", "stride=\"0\"")},
      {"params.dae", changed_collada("count=\"9\" stride=\"3\"", "count=\"9\" stride=\"1\"")},
      {"short.dae", changed_collada("count=\"27\"", "count=\"26\"")},
      {"none.dae", changed_collada("#pa", "#none")},
      {"index.dae", changed_collada("<p>0 ", "<p>] ")},
      {"deep.dae", repeated("<node>", 100000) + "<COLLADA/>"},
      {"nodes.dae", sheet_collada(repeated("<node>", 100000))},
      {"circle.dae", circle("q")},
      {"scene.dae", circle("s")},
      {"nameless.dae", circle("")},
      {"copies.dae", sheet_collada(copies)},
      {"deep.fbx", "; FBX\n" + repeated("a: {\n", 300000)},
      {"self.fbx", fbx_text(sheet, {.links = {{20, 20}}})},
      {"self7400.fbx", fbx_binary(sheet, {.links = {{21, 21}}, .gap = 8})},
      {"self7500.fbx", fbx_binary(sheet, {.links = {{20, 21}}, .version = 7500})},
      {"chain.fbx", fbx_binary(sheet, chain)},
      {"many.fbx", fbx_text(sheet, many)},
      {"unnumbered.fbx", fbx_binary(sheet, {.has_layer_number = false})}};
  for (const auto& [name, text] : files) {
    CAPTURE(name);
    const auto mesh = read_assimp(folder.write(name, text));
    if (mesh) {
      CHECK(check_mesh(*mesh));
      CHECK(read_assimp(folder.file(name))->positions == mesh->positions);
    } else {
      CHECK(mesh.error().code == ErrorCode::InvalidInput);
      CHECK_THAT(to_lines(mesh.error()).front(), contains_text(name + ": error: the "));
      CHECK(to_lines(mesh.error()).front().find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("sound FBX files with odd links are read", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const std::vector<FbxMore> sound = {{.links = {{21, 10}, {0, 21}}},
                                      {.links = {{20, 21, "LookAtProperty"}}},
                                      {.gap = 8},
                                      {.models = {30, 31}, .links = {{30, 31}, {31, 30}}}};
  for (const FbxMore& more : sound) {
    for (const std::string& text : {fbx_text(sheet, more), fbx_binary(sheet, more)})
      CHECK(read_assimp(folder.write("a.fbx", text))->face_sizes == sheet.face_sizes);
  }
}

TEST_CASE("eight threads read at once", "[mesh][read_assimp][threads]") {
  const ScratchFolder folder;
  const Mesh sheet = small_sheet(false);
  const auto fbx = folder.write("a.fbx", fbx_binary(sheet));
  const auto dae = folder.write("a.dae", sheet_collada(collada_node("n", instance)));
  const Mesh of_fbx = read_assimp(fbx).value(), of_dae = read_assimp(dae).value();
  std::atomic<int> equal = 0;
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back([&, k] {
      for (int turn = 0; turn < 4; ++turn) {
        const bool is_fbx = (k + turn) % 2 == 0;
        const auto mesh = read_assimp(is_fbx ? fbx : dae);
        equal += mesh && mesh->positions == (is_fbx ? of_fbx : of_dae).positions;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(equal == 32);
}

TEST_CASE("no prefix or mutation of a mesh file does harm", "[mesh][read_assimp][threads][boxed]") {
  const ScratchFolder folder;
  const std::vector<std::pair<std::string, std::string>> files = {
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
    // A process for each: not all prefixes, but different ones for each file.
    constexpr std::size_t step = is_sanitized ? 291 : 29;
    for (std::size_t length = random() % step; length < whole.size(); length += step)
      check(whole.substr(0, length));
    for (int trial = 0; trial < rounds(100); ++trial) {
      std::string mutant = whole;
      for (int k = 0; k < 2; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
      check(mutant);
    }
  }
}
