#include "pliant/files/write_mesh.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "files/animated_meshes.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/files/read_mesh.hpp"
#include "pliant/mesh/triangles/equal_numbers.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// Meshes of all kinds of faces, (u,v), normals and attributes, with numbers of all sizes.
class RandomMesh {
 public:
  explicit RandomMesh(unsigned seed) : random_(seed) {}

  Mesh make() {
    Mesh mesh;
    mesh.positions.resize(below(30) + 1, 3);
    for (double& number : mesh.positions.reshaped()) number = this->number();
    const int face_count = below(20) + 1;
    for (int face = 0; face < face_count; ++face) {
      const int size = below(30) == 0 ? 200 + below(300) : 3 + below(4);
      mesh.face_sizes.push_back(size);
      for (int k = 0; k < size; ++k) mesh.corner_vertices.push_back(below(mesh.vertex_count()));
    }
    add_uvs(mesh);
    add_normals(mesh);
    for (int k = below(3); k > 0; --k) {
      mesh.attributes.push_back({"soft" + std::to_string(k), {}});
      for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex)
        mesh.attributes.back().values.push_back(number());
    }
    return mesh;
  }

  FaceNames names(const Mesh& mesh) {
    FaceNames names{{"Skin red", "Steel", "never used"}, {}};
    for (std::size_t k = 0; k < mesh.face_sizes.size(); ++k) names.of_faces.push_back(below(3) - 1);
    return names;
  }

 private:
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

  // Any finite bits, and numbers that are met often.
  double number() {
    if (below(3) == 0) return std::vector{0.0, -0.0, 1.0, 0.1, -0.375, 5e-324, 1e300}[below(7)];
    for (;;) {
      const double any = std::bit_cast<double>(std::uint64_t{random_()} << 32U | random_());
      if (std::isfinite(any)) return any;
    }
  }

  void add_uvs(Mesh& mesh) {
    const int kind = below(4);
    const std::size_t corners = mesh.corner_vertices.size();
    mesh.corner_uvs.assign(corners, -1);
    std::size_t count = 0;
    if (kind == 1) {
      mesh.corner_uvs = mesh.corner_vertices;
      count = static_cast<std::size_t>(mesh.vertex_count());
    } else if (kind == 2) {
      std::iota(mesh.corner_uvs.begin(), mesh.corner_uvs.end(), 0);
      count = corners;
    } else if (kind == 3) {
      count = static_cast<std::size_t>(below(40) + 1);
      for (int& uv : mesh.corner_uvs) uv = below(static_cast<int>(count) + 1) - 1;
    }
    for (std::size_t k = 0; k < count; ++k) mesh.uvs.push_back({number(), number()});
  }

  void add_normals(Mesh& mesh) {
    const int kind = below(3);
    if (kind == 0) return;
    std::vector<int> shared = mesh.corner_vertices;
    if (kind == 2)
      for (int& normal : shared) normal = 2 * normal + below(2);
    StopPoll poll({});
    mesh.corner_normals = numbers_of_equal(shared, poll);
  }

  std::mt19937 random_;
};

Mesh read_back(const Mesh& mesh, const std::filesystem::path& file) {
  std::vector<std::string> names;
  for (const VertexAttribute& attribute : mesh.attributes) names.push_back(attribute.name);
  return read_mesh(file, {}, 0, names).value();
}

std::uint64_t bits(double number) { return std::bit_cast<std::uint64_t>(number); }

// But for what tells of its file.
void check_same(const Mesh& mesh, Mesh back) {
  back.first_index = mesh.first_index;
  back.object = mesh.object;
  CHECK(back == mesh);
  for (Eigen::Index k = 0; k < mesh.positions.size(); ++k)
    if (bits(back.positions.data()[k]) != bits(mesh.positions.data()[k])) FAIL("other bits");
}

std::string refusal(const Mesh& mesh, const std::filesystem::path& file) {
  const auto written = write_mesh(mesh, file);
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::InvalidInput);
  CHECK(written.error().file == file.string());
  CHECK(to_lines(written.error()).size() == 1);
  CHECK_FALSE(std::filesystem::exists(file));
  return written.error().message;
}

}  // namespace

TEST_CASE("any mesh with attributes comes back from a .ply to the bit", "[mesh][write]") {
  const ScratchFolder folder;
  RandomMesh random(1);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    const Mesh mesh = random.make();
    REQUIRE(write_mesh(mesh, folder.file("a.ply")));
    check_same(mesh, read_back(mesh, folder.file("a.ply")));
  }
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("any mesh comes back from an .obj to the bit, or is refused by its normals",
          "[mesh][write]") {
  const ScratchFolder folder;
  RandomMesh random(2);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    Mesh mesh = random.make();
    mesh.attributes.clear();
    const auto written = write_mesh(mesh, folder.file("a.obj"));
    if (!written) {
      CHECK_FALSE(mesh.corner_normals.empty());
      CHECK_THAT(written.error().message, Contains("normals") && !Contains("vertices"));
      ++refused;
      continue;
    }
    check_same(mesh, read_back(mesh, folder.file("a.obj")));
  }
  CHECK(refused < 200);
}

TEST_CASE("names of faces come back from an .obj", "[mesh][write]") {
  const ScratchFolder folder;
  RandomMesh random(3);
  for (int round = 0; round < 100; ++round) {
    Mesh mesh = random.make();
    mesh.attributes.clear();
    mesh.corner_normals.clear();
    mesh.materials = random.names(mesh);
    mesh.groups = random.names(mesh);
    REQUIRE(write_mesh(mesh, folder.file("a.obj")));
    const Mesh back = read_back(mesh, folder.file("a.obj"));
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
      const auto name = [&](const FaceNames& names) {
        const int index = names.of_faces.empty() ? -1 : names.of_faces[face];
        return index < 0 ? "" : names.names[static_cast<std::size_t>(index)];
      };
      CHECK(name(back.materials) == name(mesh.materials));
      CHECK(name(back.groups) == name(mesh.groups));
    }
  }
  Mesh dressed = dressed_sheet();
  dressed.positions(5, 1) = 0.3;  // so that the faces around the flat one have other normals
  REQUIRE(write_mesh(dressed, folder.file("b.obj")));
  CHECK(read_back(dressed, folder.file("b.obj")).object == "Sheet");
}

TEST_CASE("a mesh that a format cannot keep is refused by what would be lost", "[mesh][write]") {
  const ScratchFolder folder;
  const Mesh sheet = make_mesh({.columns = 4, .rows = 3});
  Mesh mesh = sheet;
  mesh.attributes = {{"soft", std::vector<double>(12, 0.5)}};
  CHECK_THAT(refusal(mesh, folder.file("a.obj")),
             Contains("the format .obj cannot keep these of the mesh as they are: attributes"));
  mesh.materials = {{"Steel"}, std::vector<int>(6, 0)};
  mesh.groups = {{"left"}, {0, -1, -1, -1, -1, -1}};
  CHECK_THAT(refusal(mesh, folder.file("a.ply")), Contains("as they are: materials, groups"));
  mesh = sheet;
  mesh.materials = {{"Steel #2"}, std::vector<int>(6, 0)};
  CHECK_THAT(refusal(mesh, folder.file("a.obj")), Contains("materials"));
  // Flat, so that all directions are the same.
  mesh = sheet;
  mesh.corner_normals = mesh.corner_vertices;
  mesh.corner_normals.back() = 12;
  mesh.corner_normals = shared_normals(mesh, {{}, {}, {1, 1, 1, 2, 2, 2}}).value();
  CHECK_THAT(refusal(mesh, folder.file("a.obj")), Contains("as they are: normals"));
  CHECK(write_mesh(mesh, folder.file("a.ply")));
  std::filesystem::remove(folder.file("a.ply"));
  for (const std::string name : {"", "two words", "x", "nz", "s", "texture_v", "line\n"}) {
    CAPTURE(name);
    mesh = sheet;
    mesh.attributes = {{name, std::vector<double>(12, 0.5)}};
    CHECK_THAT(refusal(mesh, folder.file("a.ply")), Contains("an attribute has the name"));
  }
  mesh.attributes = {{"a", std::vector<double>(12, 0.5)}, {"a", std::vector<double>(12, 1)}};
  CHECK_THAT(refusal(mesh, folder.file("a.ply")), Contains("two attributes have the name \"a\""));
  CHECK_THAT(refusal(sheet, folder.file("a.glb")), Contains("is written as .obj or .ply"));
  mesh = sheet;
  mesh.positions(3, 1) = std::nan("");
  CHECK_THAT(refusal(mesh, folder.file("a.obj")), Contains("vertex 3"));
  CHECK(folder.entry_count() == 0);
  const auto nowhere = write_mesh(sheet, folder.file("none/a.obj"));
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::Unwritable);
  CHECK(write_mesh(sheet, folder.file("a.obj"), [] { return true; }).error().code ==
        ErrorCode::Interrupted);
  CHECK(folder.entry_count() == 0);
}
