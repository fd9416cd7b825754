#include "pliant/files/obj/read_obj.hpp"

#include <random>
#include <string>

#include <fmt/format.h>

#include "pliant/files/file_object.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using pliant::testing::ScratchFolder;

namespace {

const std::string obj_quad = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

std::string obj_complaint(const std::string& text, const std::string& object = {}) {
  const auto mesh = parse_obj(text, "m.obj", object);
  return mesh ? "none" : to_lines(mesh.error()).front();
}

}  // namespace

TEST_CASE("numbers of an OBJ file are read exactly", "[mesh][read_obj]") {
  std::mt19937_64 random(9);
  std::string text = obj_quad + "f 1/1 2/2 3/3 4/4\n";
  std::vector<double> written;
  for (int k = 0; k < 3000; ++k) written.push_back(static_cast<double>(random() % 1000000) / 1024);
  for (int k = 0; k < 3000; k += 3) {
    text +=
        fmt::format("v {} {:.17g} {:e}\n", written[k], written[k + 1], std::round(written[k + 2]));
    written[k + 2] = std::round(written[k + 2]);
  }
  const Mesh mesh = parse_obj(text, "m.obj").value();
  for (int k = 0; k < 3000; ++k) CHECK(mesh.positions(4 + k / 3, k % 3) == written[k]);
}

TEST_CASE("quads stay quads and vertices keep their order", "[mesh][read_obj]") {
  const Mesh mesh = parse_obj(obj_quad + "f 3/3 4/4 1/1 2/2\nf 1/1 2/2 3/3\n", "m.obj").value();
  CHECK(mesh.face_sizes == std::vector{4, 3});
  CHECK(mesh.corner_vertices == std::vector{2, 3, 0, 1, 0, 1, 2});
  CHECK(mesh.corner_uvs == std::vector{2, 3, 0, 1, 0, 1, 2});
  CHECK(mesh.positions.row(2) == Eigen::RowVector3d(1, 0, 1));
}

TEST_CASE("every form of corner is read", "[mesh][read_obj]") {
  const Mesh mesh = parse_obj(obj_quad +
                                  "vn 0 1 0\nf 1 2 3\nf 1/1/1 2/2/1 3/3/1\nf 1//1 2//1 3//1\n"
                                  "f -4/-4 -3/-3 -2/-2\n",
                              "m.obj")
                        .value();
  CHECK(mesh.corner_vertices == std::vector{0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2});
  CHECK(mesh.corner_uvs == std::vector{-1, -1, -1, 0, 1, 2, -1, -1, -1, 0, 1, 2});
}

TEST_CASE("comments, blanks, line ends and continued lines are no matter", "[mesh][read_obj]") {
  const std::string text =
      "# a comment\r\nmtllib a.mtl\r\n\tv  0 0\t0 # here\r\nv 1 0 0 1\r\nv 1 0 1 .5 .5 .5\r\n"
      "vt 0 0 0\r\nvt 1\r\nvt 1 1\r\ng group\r\ns 1\r\nusemtl m\r\nf 1/1 \\\r\n 2/2 \\\r\n3/3";
  const Mesh mesh = parse_obj(text, "m.obj").value();
  CHECK(mesh.vertex_count() == 3);
  CHECK(mesh.uvs == std::vector<std::array<double, 2>>{{0, 0}, {1, 0}, {1, 1}});
  CHECK(mesh.corner_uvs == std::vector{0, 1, 2});
}

TEST_CASE("an object is taken by name, with its own vertices", "[mesh][read_obj]") {
  const std::string text =
      "o first\n" + obj_quad + "f 1/1 2/2 3/3\no second\nv 5 0 0\nf 4/4 3/3 5/1\no empty\n";
  CHECK_THAT(obj_complaint(text), Contains("2 objects") && Contains("\"first\", \"second\""));
  CHECK_THAT(obj_complaint(text, "third"), Contains("no object \"third\""));
  CHECK_THAT(obj_complaint(text, "empty"), Contains("no object \"empty\""));
  const Mesh second = parse_obj(text, "m.obj", "second").value();
  CHECK(second.vertex_count() == 3);
  CHECK(second.positions.row(0) == Eigen::RowVector3d(1, 0, 1));  // vertices 3, 4, 5, in that order
  CHECK(second.positions.row(2) == Eigen::RowVector3d(5, 0, 0));
  CHECK(second.corner_vertices == std::vector{1, 0, 2});
  CHECK(parse_obj("o only\n" + obj_quad + "f 1/1 2/2 3/3\n", "m.obj").value().vertex_count() == 4);
}

TEST_CASE("a bad OBJ file says what is wrong in which line", "[mesh][read_obj]") {
  struct Case {
    std::string text, expected;
  };
  const Case c = GENERATE(
      Case{"v 0 0 nan\n", "m.obj:1: error: vertex has the coordinate \"nan\""},
      Case{"v 0 0 inf\n", "m.obj:1: error: vertex has the coordinate \"inf\""},
      Case{"\nv 0 1,5 0\n", "m.obj:2: error: vertex has the coordinate \"1,5\""},
      Case{"v 0 0 1e999\n", "m.obj:1: error: vertex has the coordinate \"1e999\""},
      Case{"v 0 0\n", "m.obj:1: error: vertex has 2 numbers, but needs 3"},
      Case{obj_quad + "f 1 2\n", "m.obj: error: the file has no faces (f)"},
      Case{obj_quad + "f 1/1 2/2 x/3\n", "m.obj:9: error: face corner \"x/3\" is not of the form"},
      Case{obj_quad + "f 1/1 2/2 3/y\n", "m.obj:9: error: face corner \"3/y\""},
      Case{obj_quad + "f 1/1/1 2/2/1 3/3/z\n", "m.obj:9: error: face corner \"3/3/z\""},
      Case{obj_quad + "f 1/1 2/2 5/3\n",
           "m.obj:9: error: corner 3 of the face refers to vertex 5, but the file has 4"},
      Case{obj_quad + "f /1 2/2 3/3\n", "m.obj:9: error: face corner \"/1\""},
      Case{obj_quad + "f 1/1/1/1 2/2 3/3\n", "m.obj:9: error: face corner \"1/1/1/1\""},
      Case{obj_quad + "f 0/1 2/2 3/3\n",
           "m.obj:9: error: corner 1 of the face refers to a vertex before the file's first"},
      Case{obj_quad + "f -9/1 2/2 3/3\n",
           "m.obj:9: error: corner 1 of the face refers to a vertex before the file's first"},
      Case{obj_quad + "f 99999999999/1 2/2 3/3\n", "m.obj:9: error: face corner \"99999999999/1\""},
      Case{obj_quad, "m.obj: error: the file has no faces (f)"},
      Case{"", "m.obj: error: the file has no"},
      Case{"\x7f"
           "ELF\x02\x01",
           "m.obj:1: error: the file is not OBJ"});
  CHECK_THAT(obj_complaint(c.text), StartsWith(c.expected));
}

TEST_CASE("a vertex that cannot be read does not move the others", "[mesh][read_obj]") {
  const auto mesh = parse_obj("v 0 0 nan\nv 1\n" + obj_quad + "f 3/1 4/2 5/3 6/4\n", "m.obj");
  REQUIRE_FALSE(mesh);
  CHECK(to_lines(mesh.error()).size() == 2);
}

TEST_CASE("the objects of an OBJ file are listed as they are read and chosen", "[mesh][read_obj]") {
  const ScratchFolder folder;
  const std::string text = obj_quad +
                           "f 1 2 3\no b\nf 1 2 3 4\nf 1 2 3\no empty\no b\nv 5 0 0\nf 5 1 2\n"
                           "o a/z\nf 3 4 5\n";
  const auto file = folder.write("a.obj", text);
  const auto objects = obj_objects(file).value();
  struct Listed {
    std::string name, choice;
    std::uint64_t vertices, faces;
  };
  const std::vector<Listed> expected = {
      {"", "#1", 3, 1}, {"b", "b#1", 4, 2}, {"b", "b#2", 3, 1}, {"a/z", "a/z", 3, 1}};
  REQUIRE(objects.size() == expected.size());
  for (std::size_t k = 0; k < objects.size(); ++k) {
    CHECK(objects[k].name == expected[k].name);
    CHECK(objects[k].choice == expected[k].choice);
    CHECK(objects[k].vertices == expected[k].vertices);
    CHECK(objects[k].faces == expected[k].faces);
    const Mesh mesh = read_obj(file, objects[k].choice).value();
    CHECK(mesh.object == expected[k].name);
    CHECK(static_cast<std::uint64_t>(mesh.vertex_count()) == expected[k].vertices);
    CHECK(mesh.face_sizes.size() == expected[k].faces);
  }
  CHECK_THAT(obj_complaint(text), Contains("4 objects") && Contains("\"#1\", \"b#1\", \"b#2\""));
  CHECK_THAT(obj_complaint(text, "b"), Contains("2 objects named \"b\"") && Contains("\"b#1\""));
  CHECK_THAT(obj_complaint(text, "b#3"), Contains("no object \"b#3\""));
  // The only one has all vertices of its file.
  CHECK(obj_objects(folder.write("b.obj", obj_quad + "f 1 2 3\n"))->front().vertices == 4);
}

TEST_CASE("each face of an OBJ file is told by its own first wrong corner", "[mesh][read_obj]") {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\n";
  struct Face {
    std::string text;
    int wrong;  // the corner; 0: none
  };
  const std::vector<Face> faces = {{"f 1 2 9", 3}, {"f 1 3 4", 0}, {"f 9 8 1", 1},
                                   {"f 1 4 2", 0}, {"f 0 1 2", 1}, {"f 1 2 3 4 -9", 5},
                                   {"f 2 3 1", 0}, {"f 2 8 3", 2}};
  std::string text = vertices;
  std::vector<std::string> wanted;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    text += faces[k].text + '\n';
    if (faces[k].wrong > 0)
      wanted.push_back(fmt::format("m.obj:{}: error: corner {} of", k + 5, faces[k].wrong));
  }
  const std::vector<std::string> told = to_lines(parse_obj(text, "m.obj").error());
  REQUIRE(told.size() == wanted.size());
  for (std::size_t k = 0; k < told.size(); ++k) CHECK_THAT(told[k], StartsWith(wanted[k]));
}

TEST_CASE("names in an OBJ file go to the end of their lines", "[mesh][read_obj]") {
  const std::string text =
      "# o no\no Part#2\nv 0 0 0\nv 1 0 0 # a comment\nv 0 0 1\nusemtl red #5\ng a # b\nf 1 3 2#\n"
      "o Part#1\nv 0 9 0\nv 1 9 0\nv 0 9 1\nf 4 6 5\n";
  const Mesh second = parse_obj(text, "m.obj", "Part#2").value();
  CHECK(second.positions(0, 1) == 0);
  CHECK(second.materials.names == std::vector<std::string>{"red #5"});
  CHECK(second.groups.names == std::vector<std::string>{"a # b"});
  CHECK(parse_obj(text, "m.obj", "Part#1").value().positions(0, 1) == 9);
}

TEST_CASE("what chooses an object chooses that one", "[mesh][read_obj]") {
  const std::vector<std::string> names = {"A",   "A#2", "A",     "#2",  "A", "#1",
                                          "A#1", "A#3", "$roof", "#01", ""};
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += fmt::format("o {0}\nv 0 {1} 0\nv 1 {1} 0\nv 0 {1} 1\nf {2} {3} {4}\n", names[k], k,
                        3 * k + 1, 3 * k + 2, 3 * k + 3);
  }
  const ScratchFolder folder;
  const std::vector<FileObject> objects = obj_objects(folder.write("m.obj", text)).value();
  REQUIRE(objects.size() == names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    CAPTURE(k, objects[k].choice);
    CHECK(objects[k].name == names[k]);
    CHECK(objects[k].choice.find('$') == std::string::npos);  // a scene would replace it
    CHECK(parse_obj(text, "m.obj", objects[k].choice).value().positions(0, 1) == double(k));
  }
}

TEST_CASE("what other programs pass over in an OBJ file is left out and counted",
          "[mesh][read_obj]") {
  const std::string sound = "f 1/1 2/2 3/3 4/4\n";
  const Mesh expected = parse_obj(obj_quad + sound, "m.obj").value();
  CHECK(expected.left_out.empty());
  struct Case {
    std::string text, left_out;
  };
  const std::string one =
      "texture or normal number of a face corner that is missing or out of range";
  const std::string many =
      "texture or normal numbers of face corners that are missing or out of range";
  // Ahead of the sound face, whose numbers they must not change.
  for (const Case& c :
       {Case{"f 1 2\n", "1 face of fewer than three corners"},
        Case{"f 1\nf\n", "2 faces of fewer than three corners"}, Case{"l 1 2 3\n", "1 line"},
        Case{"p 1 2 3\n", "3 points"},
        Case{"f 9 9\nl 1 2\np 1\n", "1 face of fewer than three corners, 1 line and 1 point"}}) {
    const Mesh mesh = parse_obj(obj_quad + c.text + sound, "m.obj").value();
    CAPTURE(c.text);
    CHECK(mesh.corner_vertices == expected.corner_vertices);
    CHECK(mesh.corner_uvs == expected.corner_uvs);
    CHECK(mesh.positions == expected.positions);
    CHECK(mesh.left_out == c.left_out);
  }
  // Corners without their (u,v).
  for (const Case& c :
       {Case{"f 1/ 2/2 3/3 4/4\n", "1 " + one}, Case{"f 1// 2/2 3/3 4/4\n", "1 " + one},
        Case{"f 1/0 2/2 3/3 4/4\n", "1 " + one}, Case{"f 1/5 2/2 3/3 4/4\n", "1 " + one},
        Case{"f 1/-9 2/2 3/3 4/4\n", "1 " + one}, Case{"f 1/0/0 2/2 3/3 4/4\n", "2 " + many}}) {
    const Mesh mesh = parse_obj(obj_quad + c.text, "m.obj").value();
    CAPTURE(c.text);
    CHECK(mesh.corner_vertices == expected.corner_vertices);
    CHECK(mesh.corner_uvs == std::vector{-1, 1, 2, 3});
    CHECK(mesh.left_out == c.left_out);
  }
  // Numbers that no corner needs.
  const std::string faces = "f 2/2/1 3/3 4/4 5/5\n";
  for (const Case& c :
       {Case{"v 0 0 0 red 0 0\nvt 0 0\n", "1 vertex colour or further number that cannot be read"},
        Case{"v 0 0 0 1 1 1 1 1\nvt 0 0\n",
             "1 vertex colour or further number that cannot be read"},
        Case{"v 0 0 0\nvt 0 0 0 0\n",
             "1 further number of a texture vertex that cannot be read"}}) {
    const Mesh mesh = parse_obj(c.text + obj_quad + "vn 0 1 0\n" + faces, "m.obj").value();
    CAPTURE(c.text);
    CHECK(mesh.corner_vertices == std::vector{1, 2, 3, 4});
    CHECK(mesh.corner_uvs == std::vector{1, 2, 3, 4});
    CHECK(mesh.left_out == c.left_out);
  }
  for (const std::string text : {"vt\n", "vt nan 0\n", "vt 0 x\n"}) {
    const Mesh mesh = parse_obj("v 0 0 0\n" + text + obj_quad + "f 1/1 3/3 4/4\n", "m.obj").value();
    CAPTURE(text);
    CHECK(mesh.corner_uvs == std::vector{-1, 2, 3});
    CHECK(mesh.left_out == "1 texture vertex (vt) that is not a number");
    CHECK(check_mesh(mesh));
  }
}

TEST_CASE("a byte order mark is no part of the first statement", "[mesh][read_obj]") {
  CHECK(parse_obj("\xEF\xBB\xBF" + obj_quad + "f 1/1 2/2 3/3\n", "m.obj").value().vertex_count() ==
        4);
}

TEST_CASE("a file that is no OBJ is refused without quoting it", "[mesh][read_obj]") {
  for (const std::string text : {"\n# a\nroot:secret:0\nsecret\n", "\n\n{\"secret\":1}",
                                 "\n\n\x7f"
                                 "ELF secret\nv x"}) {
    const auto mesh = parse_obj(text, "m.obj");
    REQUIRE_FALSE(mesh);
    CHECK(to_lines(mesh.error()) ==
          std::vector<std::string>{
              "m.obj:3: error: the file is not OBJ: no OBJ statement begins like this line"});
  }
  CHECK(parse_obj("mtllib a.mtl\nsomething else\n" + obj_quad + "f 1 2 3\n", "m.obj"));
}

TEST_CASE("all problems of an OBJ file come in one run, up to a limit", "[mesh][read_obj]") {
  const auto two = parse_obj(obj_quad + "v x 0 0\nf 1/1 2/2 x\nf 1/1 2/2 7/3\n", "m.obj");
  REQUIRE_FALSE(two);
  CHECK(to_lines(two.error()).size() == 3);
  std::string many;
  for (int k = 0; k < 1000; ++k) many += "v x\n";
  CHECK(to_lines(parse_obj(many, "m.obj").error()).size() == 20);
}

TEST_CASE("no prefix or mutation of an OBJ file does harm", "[mesh][read_obj]") {
  const std::string text =
      "o a\n" + obj_quad + "f 1/1 2/2 3/3 4/4\nf -4/-4 \\\n -3/-3 -2/-2\no b\nf 1 2 3\n";
  for (std::size_t length = 0; length <= text.size(); ++length) {
    // A buffer of exactly that length, so that the sanitizer detects any read beyond it.
    const std::vector<char> bytes(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
    (void)parse_obj({bytes.data(), bytes.size()}, "m.obj", "a");
  }
  std::mt19937 random(1);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string mutant = text;
    for (int k = 0; k < 3; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
    const auto mesh = parse_obj(mutant, "m.obj", "a");
    if (mesh) CHECK(check_mesh(*mesh));
  }
}

TEST_CASE("a missing OBJ file is unreadable", "[mesh][read_obj]") {
  const ScratchFolder folder;
  CHECK(read_obj(folder.file("none.obj")).error().code == ErrorCode::Unreadable);
}

TEST_CASE("materials and groups of an OBJ file stay with their faces", "[mesh][read_obj]") {
  const std::string faces =
      "f 1 2 3\nusemtl Skin red \ng left arm\nf 1 2 4\nusemtl Steel\nf 1 3 4\ng\nusemtl Skin red\n"
      "f 2 3 4\n";
  const Mesh mesh = parse_obj("o Body\n" + obj_quad + faces, "m.obj").value();
  CHECK(mesh.object == "Body");
  CHECK(mesh.materials == FaceNames{{"Skin red", "Steel"}, {-1, 0, 1, 0}});
  CHECK(mesh.groups == FaceNames{{"left arm"}, {-1, 0, 0, -1}});
  CHECK(parse_obj(obj_quad + "f 1 2 3\n", "m.obj")->materials == FaceNames{});
  const Mesh part =
      parse_obj(obj_quad + "o a\nusemtl A\nf 1 2 3\no b\nusemtl B\nf 2 3 4\n", "m.obj", "b")
          .value();
  CHECK(part.materials == FaceNames{{"B"}, {0}});
  CHECK(part.object == "b");
}

TEST_CASE("an OBJ file says what is smooth", "[mesh][read_obj]") {
  const auto normals = [](const std::string& text) {
    return parse_obj(obj_quad + text, "m.obj").value().corner_normals;
  };
  using Numbers = std::vector<int>;
  const std::string vn = "vn 0 1 0\nvn 1 0 0\nvn 0 1 0\n";
  CHECK(normals("f 1 2 3\nf 1 3 4\n").empty());
  CHECK(normals("s 1\nf 1 2 3\nf 1 3 4\n").empty());
  CHECK(normals("s off\nf 1 2 3\nf 1 3 4\n") == Numbers{0, 0, 0, 1, 1, 1});
  CHECK(normals("s 0\nf 1 2 3\ns 1\nf 1 3 4\n") == Numbers{0, 0, 0, 1, 2, 3});
  CHECK(normals("s 1\nf 1 2 3\ns 2\nf 1 3 4\n") == Numbers{0, 1, 2, 3, 4, 5});
  // By value: the first and the third are equal.
  CHECK(normals(vn + "f 1//1 2//1 3//1\nf 1//3 3//2 4//2\n") == Numbers{0, 1, 2, 0, 3, 4});
  CHECK(normals(vn + "s off\nf 1//1 2//1 3//1\n") == Numbers{0, 0, 0});
}

TEST_CASE("normals of an OBJ file that cannot be read are none", "[mesh][read_obj]") {
  for (const char* text : {"vn nan 0 0\nf 1//1 2//1 3//1\n", "vn 1\nf 1//1 2//1 3//1\n",
                           "f 1//9 2//9 3//-9\n", "vn 0 1 0\nf 1//0 2//0 3//0\n"}) {
    CHECK(parse_obj(obj_quad + text, "m.obj"));
  }
}

TEST_CASE("vertices of an OBJ keep the numbers that the file gives them", "[mesh][read_obj]") {
  const std::string two =
      obj_quad + "o a\nf 1/1 2/2 3/3\nv 7 0 0\nv 8 0 0\nv 9 0 1\no b\nf 5/1 6/2 7/3\n";
  const Mesh first = parse_obj(two, "m.obj", "a").value();
  CHECK(first.number_of(0) == 1);
  const Mesh second = parse_obj(two, "m.obj", "b").value();
  CHECK(second.number_of(0) == 5);
  CHECK(second.number_of(2) == 7);
}

TEST_CASE("a statement of an OBJ has a longest length", "[mesh][read_obj]") {
  const std::string longest(std::size_t{16} << 20, ' ');
  CHECK(obj_complaint(obj_quad + "f 1 2 3\n" + longest + "\n") == "none");
  CHECK(obj_complaint(obj_quad + "f 1 2 3\n" + longest + " \nf 1") ==
        "m.obj:10: error: the statement is longer than 16 MiB");
  CHECK(obj_complaint(obj_quad + "f 1 2 \\\n" + longest + "\n") ==
        "m.obj:9: error: the statement is longer than 16 MiB");
}
