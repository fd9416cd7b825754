#include "pliant/files/ply/read_ply.hpp"

#include <bit>
#include <random>

#include "files/mesh_files.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::StartsWith;

namespace {

std::string header(const std::string& elements, const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\ncomment by hand\n" + elements + "end_header\n";
}

const std::string four_vertices =
    "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n";
const std::string with_uvs = four_vertices + "property float s\nproperty float t\n";
const std::string one_face = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string points = "0 0 0\n1 0 0\n1 0 1\n0 0 1\n";
const std::string points_with_uvs = "0 0 0 0 0\n1 0 0 1 0\n1 0 1 1 1\n0 0 1 0 1\n";
const std::string ply_quad = header(with_uvs + one_face) + points_with_uvs + "4 0 1 2 3\n";

std::string ply_complaint(const std::string& bytes, const std::string& object = {}) {
  const auto mesh = parse_ply(bytes, "m.ply", object);
  return mesh ? "none" : to_lines(mesh.error()).front();
}

std::string big_endian(std::uint64_t number, int size) {
  std::string bytes = little_endian(number, size);
  return {bytes.rbegin(), bytes.rend()};
}

/// A sheet with a number of every type besides those that are read.
std::string binary(const Mesh& mesh, bool is_big) {
  const auto number = [&](std::uint64_t bits, int size) {
    return is_big ? big_endian(bits, size) : little_endian(bits, size);
  };
  const auto real = [&](double value) { return number(std::bit_cast<std::uint64_t>(value), 8); };
  std::string bytes = fmt::format(
      "ply\r\nformat {} 1.0\r\nobj_info none\r\nelement vertex {}\r\nproperty char a\r\n"
      "property double x\r\nproperty ushort b\r\nproperty double y\r\nproperty double z\r\n"
      "property list uint8 int16 c\r\nproperty double u\r\nproperty double v\r\n"
      "element edge 1\r\nproperty int vertex1\r\nproperty uint vertex2\r\n"
      "element face {}\r\nproperty float32 d\r\nproperty list ushort uint vertex_index\r\n"
      "end_header\r\n",
      is_big ? "binary_big_endian" : "binary_little_endian", mesh.vertex_count(),
      mesh.face_sizes.size());
  for (int k = 0; k < mesh.vertex_count(); ++k) {
    bytes += number(200, 1) + real(mesh.positions(k, 0)) + number(60000, 2);
    bytes += real(mesh.positions(k, 1)) + real(mesh.positions(k, 2));
    bytes += number(2, 1) + number(7, 2) + number(8, 2);
    bytes += real(mesh.uvs[k][0]) + real(mesh.uvs[k][1]);
  }
  bytes += number(0, 4) + number(1, 4);
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    bytes += number(std::bit_cast<std::uint32_t>(1.5f), 4) + number(size, 2);
    for (int k = 0; k < size; ++k, ++corner) bytes += number(mesh.corner_vertices[corner], 4);
  }
  return bytes;
}

}  // namespace

TEST_CASE("a PLY file is read exactly, in each encoding", "[mesh][read_ply]") {
  Mesh sheet = small_sheet(GENERATE(false, true));
  sheet.positions = Field::Random(9, 3);
  for (auto& [u, v] : sheet.uvs) u += 0.1;
  std::string text = header(
      fmt::format("element vertex 9\nproperty double x\nproperty double y\nproperty double z\n"
                  "property double texture_u\nproperty double texture_v\nelement face {}\n"
                  "property list uchar int vertex_indices\n",
                  sheet.face_sizes.size()));
  for (int k = 0; k < 9; ++k) {
    text += fmt::format("{} {} {} {} {}\n", sheet.positions(k, 0), sheet.positions(k, 1),
                        sheet.positions(k, 2), sheet.uvs[k][0], sheet.uvs[k][1]);
  }
  std::size_t corner = 0;
  for (const int size : sheet.face_sizes) {
    text += fmt::format("{}", size);
    for (int k = 0; k < size; ++k) text += fmt::format(" {}", sheet.corner_vertices[corner++]);
    text += '\n';
  }
  for (const std::string& bytes : {text, binary(sheet, false), binary(sheet, true)}) {
    const Mesh mesh = parse_ply(bytes, "m.ply").value();
    CHECK(mesh.positions == sheet.positions);
    CHECK(mesh.uvs == sheet.uvs);
    CHECK(mesh.face_sizes == sheet.face_sizes);
    CHECK(mesh.corner_vertices == sheet.corner_vertices);
    CHECK(mesh.corner_uvs == sheet.corner_uvs);
  }
}

TEST_CASE("numbers of single precision keep their value", "[mesh][read_ply]") {
  std::string bytes =
      header("element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + one_face,
             "binary_little_endian");
  for (int k = 0; k < 9; ++k)
    bytes += little_endian(std::bit_cast<std::uint32_t>(-0.1f * static_cast<float>(k)), 4);
  bytes += little_endian(3, 1) + little_endian(0, 4) + little_endian(1, 4) + little_endian(2, 4);
  const Mesh mesh = parse_ply(bytes, "m.ply").value();
  for (int k = 0; k < 9; ++k) CHECK(mesh.positions(k / 3, k % 3) == -0.1f * static_cast<float>(k));
  CHECK(mesh.corner_uvs == std::vector{-1, -1, -1});
}

TEST_CASE("(u,v) of corners go before those of vertices", "[mesh][read_ply]") {
  const std::string faces =
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float "
      "texcoord\n";
  const std::string text =
      header(with_uvs + faces) + points_with_uvs + "3 0 1 2 6 5 5 6 5 6 6\n3 0 2 3 0\n";
  const Mesh mesh = parse_ply(text, "m.ply").value();
  CHECK(mesh.corner_uvs == std::vector{4, 5, 6, 0, 2, 3});
  CHECK(mesh.uvs.at(5) == std::array{6.0, 5.0});
  CHECK(parse_ply(header(four_vertices + faces) + points + "3 0 1 2 0\n3 0 2 3 6 5 5 6 5 6 6\n",
                  "m.ply")
            ->corner_uvs == std::vector{-1, -1, -1, 0, 1, 2});
}

TEST_CASE("numbered (u,v) and normals go before all others", "[mesh][read_ply]") {
  const std::string numbered =
      "element texcoord 2\nproperty double u\nproperty double v\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar int texcoord_indices\n"
      "property list uchar int normal_indices\nproperty list uchar float texcoord\n";
  const std::string uvs = "7 8\n9 10\n", unread = " 6 5 5 5 5 5 5\n";
  const auto read = [&](const std::string& faces, const std::string& more = "",
                        const std::string& strips = "") {
    return parse_ply(header(with_uvs + numbered + strips) + points_with_uvs + uvs + faces + more,
                     "m.ply")
        .value();
  };
  const Mesh mesh = read("3 0 1 2 3 1 0 -1 3 4 4 2" + unread + "3 0 2 3 3 1 1 1 3 4 9 2" + unread);
  CHECK(mesh.uvs == std::vector<std::array<double, 2>>{{7, 8}, {9, 10}});
  CHECK(mesh.corner_uvs == std::vector{1, 0, -1, 1, 1, 1});
  CHECK(mesh.corner_normals == std::vector{0, 0, 1, 0, 2, 1});
  CHECK(mesh.left_out.empty());
  // Without a list corners have no (u,v), and share the normals of their vertices.
  const Mesh bad = read("3 0 1 2 3 2 0 -2 3 4 nan 2" + unread + "3 0 2 3 2 1 1 1 4" + unread);
  CHECK(bad.corner_uvs == std::vector{-1, 0, -1, -1, -1, -1});
  CHECK(bad.corner_normals == std::vector{0, 1, 2, 3, 4, 5});
  CHECK_THAT(bad.left_out,
             contains_text("2 numbers of texture coordinates that are out of range") &&
                 contains_text("1 list of texture coordinates that does not suit its face") &&
                 contains_text("1 list of normals that does not suit its face"));
  const Mesh both = read("3 0 1 2 3 1 0 1 3 4 4 2" + unread + "3 0 2 3 0 0" + unread, "4 0 1 2 3\n",
                         "element tristrips 1\nproperty list uchar int vertex_indices\n");
  CHECK(both.corner_uvs.size() == 12);
  CHECK(both.corner_normals.size() == 12);
  CHECK(check_mesh(both));
  // One without the other is nothing.
  const std::string half =
      "element texcoord 1\nproperty list uchar double u\nproperty double v\n"
      "element face 1\nproperty list uchar int vertex_indices\n"
      "property list uchar int texcoord_indices\n";
  CHECK(parse_ply(header(with_uvs + half) + points_with_uvs + "1 7 8\n3 0 1 2 3 0 0 0\n", "m.ply")
            ->corner_uvs == std::vector{0, 1, 2});
}

TEST_CASE("faces may come first, and lines among them are passed over", "[mesh][read_ply]") {
  const Mesh mesh =
      parse_ply(header("element face 3\nproperty list uchar int vertex_indices\n" + with_uvs) +
                    "2 0 1\n4 0 1 2 3\n1 0\n" + points_with_uvs,
                "m.ply")
          .value();
  CHECK(mesh.face_sizes == std::vector{4});
  CHECK(mesh.corner_vertices == std::vector{0, 1, 2, 3});
  CHECK(mesh.corner_uvs == std::vector{0, 1, 2, 3});
}

TEST_CASE("a bad PLY file says what is wrong, and where", "[mesh][read_ply]") {
  struct Case {
    std::string bytes, expected;
  };
  const std::string both = header(four_vertices + one_face);
  const std::string binary_header = header(four_vertices + one_face, "binary_little_endian");
  const std::vector<Case> cases = {
      {"", "m.ply: error: the file is not PLY"},
      {"v 0 0 0\n", "m.ply: error: the file is not PLY"},
      {"ply\n", "m.ply: error: the file is not PLY"},
      {"ply\nformat ascii 1.0\nelement vertex 4\n",
       "m.ply: error: the file is truncated: it ends within its header"},
      {"ply\nend_header\n", "m.ply:2: error: the header names no format"},
      {"ply\nformat ascii 2.0\n", "m.ply:2: error: the format must be ascii"},
      {"ply\nformat text 1.0\n", "m.ply:2: error: the format must be ascii"},
      {header("element vertex -1\n"), "m.ply:4: error: the number of elements \"-1\" is not"},
      {header("element vertex 4000000000\n"), "m.ply:4: error: the number of elements \"4000000"},
      {header("property float x\n"),
       "m.ply:4: error: the header has a line that begins with \"property\""},
      {header("what is this\n"), "m.ply:4: error: the header has a line that begins with \"what\""},
      {header("element vertex 4\nproperty real x\n"), "m.ply:5: error: a property must have the"},
      {header("element face 4\nproperty list float int vertex_indices\n"),
       "m.ply:5: error: a property must have the form"},
      {header("element thing 4\n") + "0", "m.ply: error: the element \"thing\" has no properties"},
      {header("element vertex 1\nproperty float x\nproperty float y\n") + "0 0\n",
       "m.ply: error: the vertices have no x, y and z"},
      {header(
           "element vertex 1\nproperty float x\nproperty float y\nproperty list uchar float z\n"),
       "m.ply: error: a coordinate of the vertices is a list"},
      {header(four_vertices + "element face 1\nproperty int vertex_indices\n") + points + "1\n",
       "m.ply: error: the faces have no list vertex_indices"},
      {both + "0 0 0\n1 0 0\n1 0\n",
       "m.ply:14: error: the file is truncated: it ends within \"vertex\" 2 of 4, counted from 0"},
      {both + points + "4 0 1 2\n",
       "m.ply:16: error: the file is truncated: it ends within \"face\" 0 of 1, counted from 0"},
      {both + points + "200 0 1 2\n",
       "m.ply:15: error: the file is truncated: it ends within \"face\" 0 of 1, counted from 0"},
      {both + "0 0 nan\n" + points, "m.ply:11: error: \"vertex\" 0: \"z\" is not a finite number"},
      {both + "0 1,5 0\n" + points, "m.ply:11: error: \"vertex\" 0: \"y\" is not a finite number"},
      {both + points + "4 0 1 2 x\n",
       "m.ply:15: error: \"face\" 0: \"vertex_indices\" is not a finite number"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 2\n",
       "m.ply:4: error: the element \"vertex\" is given twice"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty double x\n",
       "m.ply:5: error: the property \"x\" is given twice"},
      {both + points + "-4 0 1 2\n",
       "m.ply:15: error: \"face\" 0: \"vertex_indices\" is not a finite number"},
      {both + points + "4 0 1 2 4\n",
       "m.ply: error: corner 3 of face 0 refers to vertex 4, but the file has 4"},
      {both + points + "3 0 -1 2\n",
       "m.ply: error: corner 1 of face 0 refers to an invalid vertex number"},
      {both + points + "3 0 1.5 2\n",
       "m.ply: error: corner 1 of face 0 refers to an invalid vertex number"},
      {both + points + "2 0 1\n", "m.ply: error: the file has no faces"},
      {header(four_vertices) + points, "m.ply: error: the file has no faces"},
      {binary_header + std::string(90, '\0'),
       "m.ply: error: the file is truncated: it ends within \"vertex\" 3 of 4, counted from 0"},
      {binary_header + std::string(96, '\xff'),
       "m.ply: error: \"vertex\" 0: \"x\" is not a finite number"},
      {binary_header + std::string(96, '\0') + "\xff",
       "m.ply: error: the file is truncated: it ends within \"face\""}};
  for (const Case& c : cases) {
    CAPTURE(c.bytes);
    CHECK_THAT(ply_complaint(c.bytes), StartsWith(c.expected));
  }
}

TEST_CASE("a message about a PLY file is short, however long its names are", "[mesh][read_ply]") {
  const std::string name(3000, '\xff');
  const std::string start = "element " + name + " 1\nproperty float x\n";
  for (const std::string& rest : {start + "end_header\nx\n", start + "end_header\n", start + start,
                                  "element " + name + " 1\nend_header\n",
                                  start + "property float " + name + "\nend_header\n0 x\n",
                                  "element vertex 1\nproperty " + name + " x\n", name + "\n"}) {
    const std::string complaint = ply_complaint("ply\nformat ascii 1.0\n" + rest);
    CAPTURE(complaint);
    CHECK(complaint != "none");
    CHECK(complaint.size() < 500);
  }
}

TEST_CASE("what other programs pass over in a PLY file is left out and counted",
          "[mesh][read_ply]") {
  const std::string both = header(four_vertices + one_face);
  const Mesh expected = parse_ply(both + points + "4 0 1 2 3\n", "m.ply").value();
  CHECK(expected.left_out.empty());
  const auto read = [&](const std::string& bytes) {
    Mesh mesh = parse_ply(bytes, "m.ply").value();
    CHECK(mesh.positions == expected.positions);
    CHECK(mesh.face_sizes == expected.face_sizes);
    CHECK(mesh.corner_vertices == expected.corner_vertices);
    return mesh;
  };
  CHECK(read(both + points + "4 0 1 2 3\nmore\n").left_out == "4 bytes after its last element");
  const std::string three =
      header(four_vertices + "element face 3\nproperty list uchar int vertex_indices\n");
  CHECK(read(three + points + "2 0 1\n4 0 1 2 3\n1 0\n").left_out ==
        "2 faces of fewer than three corners");
  const std::string edges = "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
  CHECK(
      read(header(four_vertices + one_face + edges) + points + "4 0 1 2 3\n0 1\n1 2\n").left_out ==
      "2 edges");
  const Mesh other =
      read(header(four_vertices + one_face + "property list uchar float texcoord\n") + points +
           "4 0 1 2 3 4 0 0 1 1\n");
  CHECK(other.left_out == "1 list of texture coordinates that does not suit its face");
  CHECK(other.corner_uvs == std::vector{-1, -1, -1, -1});
}

TEST_CASE("strips of a PLY file are triangles of one turn", "[mesh][read_ply]") {
  const std::string list = "element tristrips 1\nproperty list int int vertex_indices\n";
  const auto corners = [&](const std::string& strip) {
    const auto mesh = parse_ply(header(four_vertices + list) + points + strip, "m.ply");
    REQUIRE(mesh);
    CHECK(mesh->left_out.empty());
    CHECK(mesh->face_sizes == std::vector<int>(mesh->corner_vertices.size() / 3, 3));
    return mesh->corner_vertices;
  };
  CHECK(corners("4 0 1 2 3\n") == std::vector{0, 1, 2, 2, 1, 3});
  CHECK(corners("5 0 1 2 3 -1\n") == std::vector{0, 1, 2, 2, 1, 3});
  // A strip begins anew after -1, also with the first turn.
  CHECK(corners("8 0 1 2 3 -1 1 2 3\n") == std::vector{0, 1, 2, 2, 1, 3, 1, 2, 3});
  CHECK(corners("7 0 1 2 -1 1 2 3\n") == std::vector{0, 1, 2, 1, 2, 3});
  CHECK(corners("7 0 1 2 2 1 1 3\n") == std::vector{0, 1, 2});  // corners twice join strips
  CHECK(corners("9 -1 -1 0 1 -1 -1 1 2 3\n") == std::vector{1, 2, 3});
  for (const std::string strip : {"4 0 1 2 4\n", "4 0 1 -2 3\n"}) {
    CHECK_THAT(ply_complaint(header(four_vertices + list) + points + strip),
               contains_text("strip 0 refers to"));
  }
  CHECK_THAT(ply_complaint(header(four_vertices + list) + points + "2 0 1\n"),
             contains_text("the file has no faces"));
}

TEST_CASE("numbers that a mesh does not need may be anything", "[mesh][read_ply]") {
  const std::string more = four_vertices +
                           "property float quality\nproperty float s\n"
                           "property float t\n";
  const Mesh mesh = parse_ply(header(more + one_face) +
                                  "0 0 0 nan 0 0\n1 0 0 1 nan 0\n1 1 0 inf 1 1\n0 1 0 x 0 1\n"
                                  "4 0 1 2 3\n",
                              "m.ply")
                        .value();
  CHECK(mesh.corner_uvs == std::vector{0, -1, 2, 3});
  CHECK(mesh.left_out == "1 (u,v) that is not a pair of numbers");
  CHECK(check_mesh(mesh));
}

TEST_CASE("a PLY file's object has no name", "[mesh][read_ply]") {
  CHECK(ply_complaint(ply_quad, "#1") == "none");
  CHECK_THAT(ply_complaint(ply_quad, "#2"), contains_text("no object \"#2\""));
  CHECK(ply_complaint(ply_quad) == "none");
  CHECK_THAT(ply_complaint(ply_quad, "sheet"), contains_text("no object \"sheet\""));
}

TEST_CASE("no prefix of a PLY file is taken for the whole", "[mesh][read_ply]") {
  const Mesh sheet = small_sheet(false);
  for (const std::string& whole : {ply_quad, binary(sheet, false), binary(sheet, true)}) {
    REQUIRE(ply_complaint(whole) == "none");
    for (std::size_t length = 0; length + 2 < whole.size(); ++length) {
      // A buffer of exactly that length, so that the sanitizer detects any read beyond it.
      const std::vector<char> bytes(whole.begin(),
                                    whole.begin() + static_cast<std::ptrdiff_t>(length));
      CHECK_FALSE(parse_ply({bytes.data(), bytes.size()}, "m.ply"));
    }
  }
}

TEST_CASE("no mutation of a PLY file does harm", "[mesh][read_ply]") {
  std::mt19937 random(1);
  for (const std::string& whole : {ply_quad, binary(small_sheet(true), false)}) {
    for (int trial = 0; trial < 3000; ++trial) {
      std::string mutant = whole;
      for (int k = 0; k < 3; ++k) mutant[random() % mutant.size()] = static_cast<char>(random());
      const auto mesh = parse_ply(mutant, "m.ply");
      if (mesh) CHECK(check_mesh(*mesh));
    }
  }
}

TEST_CASE("a missing PLY file is unreadable", "[mesh][read_ply]") {
  const ScratchFolder folder;
  CHECK(read_ply(folder.file("none.ply")).error().code == ErrorCode::Unreadable);
}
