#include <cstring>
#include <sstream>

#include "pliant/files/formats.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

/// A PLY file as these tests expect it, parsed without pliant's own reader.
struct PlyFile {
  std::vector<std::string> header;            // lines without `comment`
  std::vector<std::vector<double>> vertices;  // the numbers of each
  std::vector<std::vector<int>> faces;
  bool ends_there = false;

  explicit PlyFile(const std::filesystem::path& file) {
    std::istringstream stream(read_file(file).value());
    int vertex_count = 0, face_count = 0, width = 0;
    std::size_t count_size = 1;
    for (std::string line; std::getline(stream, line) && line != "end_header";) {
      if (!line.starts_with("comment")) header.push_back(line);
      (void)std::sscanf(line.c_str(), "element vertex %d", &vertex_count);
      (void)std::sscanf(line.c_str(), "element face %d", &face_count);
      width += line.starts_with("property double");
      if (line.starts_with("property list uint ")) count_size = 4;
    }
    const auto take = [&](auto number, std::size_t size) {  // on a little-endian machine
      stream.read(reinterpret_cast<char*>(&number), static_cast<std::streamsize>(size));
      return number;
    };
    for (int k = 0; k < vertex_count; ++k) {
      vertices.emplace_back();
      for (int n = 0; n < width; ++n) vertices.back().push_back(take(0.0, sizeof(double)));
    }
    for (int k = 0; k < face_count; ++k) {
      faces.emplace_back();
      const unsigned size = take(0u, count_size);
      for (unsigned n = 0; n < size; ++n) faces.back().push_back(take(0, sizeof(int)));
    }
    ends_there = stream.good() && stream.peek() == EOF;
  }
};

PlyFile written(const ScratchFolder& folder, const Mesh& mesh) {
  auto writer = make_ply_writer({folder.file("m.ply"), &mesh, 1, 1}).value();
  REQUIRE(writer->write(1, {mesh.positions}));
  REQUIRE(writer->finish());
  return PlyFile(folder.file("m.0001.ply"));
}

}  // namespace

TEST_CASE("a PLY sequence holds the same doubles, (u,v) and faces", "[output][ply]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({.columns = 5, .rows = 4, .triangles = GENERATE(false, true)});
  auto writer = make_ply_writer({folder.file("a.ply"), &mesh, 1, 3}).value();
  for (int frame = 1; frame <= 3; ++frame) {
    const Field positions = Field::Random(20, 3) * 1e-3;
    REQUIRE(writer->write(frame, {positions}));
    const PlyFile file(folder.file("a.000" + std::to_string(frame) + ".ply"));
    CHECK(file.header ==
          std::vector<std::string>{"ply", "format binary_little_endian 1.0", "element vertex 20",
                                   "property double x", "property double y", "property double z",
                                   "property double s", "property double t",
                                   "element face " + std::to_string(mesh.face_sizes.size()),
                                   "property list uchar int vertex_indices"});
    for (int k = 0; k < 20; ++k) {
      const auto& uv = mesh.uvs[k];  // those of a sheet are in the order of its vertices
      CHECK(file.vertices[k] ==
            std::vector{positions(k, 0), positions(k, 1), positions(k, 2), uv[0], uv[1]});
    }
    std::vector<int> sizes, corners;
    for (const auto& face : file.faces) {
      sizes.push_back(static_cast<int>(face.size()));
      corners.insert(corners.end(), face.begin(), face.end());
    }
    CHECK(sizes == mesh.face_sizes);
    CHECK(corners == mesh.corner_vertices);
    CHECK(file.ends_there);
  }
  REQUIRE(writer->finish());
  CHECK(folder.entry_count() == 3);
}

TEST_CASE("what a PLY sequence holds is what is read back", "[output][ply]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({.columns = 5, .rows = 4, .triangles = GENERATE(false, true)});
  mesh.positions = Field::Random(20, 3);
  written(folder, mesh);
  const Mesh back = read_ply(folder.file("m.0001.ply")).value();
  CHECK(back.positions == mesh.positions);
  CHECK(back.uvs == mesh.uvs);
  CHECK(back.face_sizes == mesh.face_sizes);
  CHECK(back.corner_vertices == mesh.corner_vertices);
  CHECK(back.corner_uvs == mesh.corner_uvs);
}

TEST_CASE("a vertex's equal (u,v) are one, and others leave all of them out", "[output][ply]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({});
  const auto width = [&] { return written(folder, mesh).vertices.front().size(); };
  mesh.uvs.push_back(mesh.uvs[static_cast<std::size_t>(mesh.corner_uvs[1])]);
  mesh.corner_uvs[1] = static_cast<int>(mesh.uvs.size()) - 1;
  CHECK(width() == 5);
  SECTION("two that differ") { mesh.uvs.back()[0] += 0.5; }
  SECTION("a corner without") { mesh.corner_uvs[1] = -1; }
  SECTION("a vertex without a face") {
    mesh.positions.conservativeResize(10, 3);
    mesh.positions.row(9).setZero();
  }
  CHECK(width() == 3);
}

TEST_CASE("a face of more than 255 corners gets a wider count", "[output][ply]") {
  const ScratchFolder folder;
  const int corners = GENERATE(255, 256, 300);
  Mesh mesh;
  mesh.positions = Field::Random(corners, 3);
  mesh.face_sizes = {corners, 3};
  for (int k = 0; k < corners; ++k) mesh.corner_vertices.push_back(k);
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), {2, 1, 0});
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  const PlyFile file = written(folder, mesh);
  CHECK(file.header.back() == (corners > 255 ? "property list uint int vertex_indices"
                                             : "property list uchar int vertex_indices"));
  CHECK(file.faces[0].size() == static_cast<std::size_t>(corners));
  CHECK(file.faces[1] == std::vector{2, 1, 0});
  CHECK(file.ends_there);
  CHECK(read_ply(folder.file("m.0001.ply"))->corner_vertices == mesh.corner_vertices);
}

TEST_CASE("the same mesh gives the same bytes", "[output][ply]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  written(folder, mesh);
  const std::string once = read_file(folder.file("m.0001.ply")).value();
  written(folder, mesh);
  CHECK(read_file(folder.file("m.0001.ply")).value() == once);
}
