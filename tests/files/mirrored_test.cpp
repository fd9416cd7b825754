#include <fstream>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "files/animated_meshes.hpp"
#include "pliant/files/read_mesh.hpp"
#include "support/area_vectors.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

/// A sheet in relief, so that its faces look in different directions.
Mesh relief() {
  Mesh mesh = dressed_sheet();
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k)
    mesh.positions(k, 1) = 0.2 * std::sin(static_cast<double>(3 * k));
  return mesh;
}

/// Whose scale has the given signs, one for each frame.
Transform placed(int sign) {
  return make_transform({1, 2, 3}, {20, 30, 40}, {1.5 * sign, 2, 0.5}, RotateOrder::Xyz);
}

/// Writes the mesh at frames 1, 2, … in the world.
void write_signs(const std::filesystem::path& file, const Mesh& mesh,
                 const std::vector<int>& signs) {
  const auto pose = [&](int sign) {
    return SurfacePose{.positions = to_world(placed(sign), mesh.positions),
                       .is_mirrored = placed(sign).is_mirrored()};
  };
  const SurfacePose first = pose(signs.front());
  auto writer = make_writer({.file = file,
                             .surfaces = {{.name = "sheet",
                                           .mesh = &mesh,
                                           .rest = first.positions,
                                           .is_mirrored = first.is_mirrored}},
                             .first_frame = 1,
                             .last_frame = static_cast<int>(signs.size())})
                    .value();
  for (std::size_t k = 0; k < signs.size(); ++k)
    REQUIRE(writer->write(static_cast<int>(k) + 1, std::vector{pose(signs[k])}));
  REQUIRE(writer->finish());
}

std::string bytes_in(const std::filesystem::path& file) {
  std::ostringstream bytes;
  bytes << std::ifstream(file).rdbuf();
  return bytes.str();
}

/// Where the triangles of each face look together: a glTF has no other faces.
Field by_faces(const Mesh& mesh, const Field& areas) {
  if (areas.rows() == static_cast<Eigen::Index>(mesh.face_sizes.size())) return areas;
  REQUIRE(areas.rows() == 2 * static_cast<Eigen::Index>(mesh.face_sizes.size()));
  Field sums(areas.rows() / 2, 3);
  for (Eigen::Index k = 0; k < sums.rows(); ++k)
    sums.row(k) = areas.row(2 * k) + areas.row(2 * k + 1);
  return sums;
}

}  // namespace

TEST_CASE("turned faces look the other way, from the same first corner on", "[output][mirrored]") {
  const Mesh mesh = relief();
  Mesh turned = mesh;
  turn_faces(turned);
  CHECK((area_vectors(turned) + area_vectors(mesh)).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(check_mesh(turned));
  std::size_t first = 0;
  for (const int size : mesh.face_sizes) {
    for (int k = 0; k < size; ++k) {
      const std::size_t from = first + static_cast<std::size_t>((size - k) % size);
      const std::size_t to = first + static_cast<std::size_t>(k);
      CHECK(turned.corner_vertices[to] == mesh.corner_vertices[from]);
      CHECK(turned.corner_uvs[to] == mesh.corner_uvs[from]);
      CHECK(turned.corner_normals[to] == mesh.corner_normals[from]);
    }
    first += static_cast<std::size_t>(size);
  }
  turn_faces(turned);
  CHECK(turned.corner_vertices == mesh.corner_vertices);
  CHECK(turned.corner_uvs == mesh.corner_uvs);
}

TEST_CASE("each file of a sequence has faces that look as its own frame says",
          "[output][mirrored]") {
  const ScratchFolder folder;
  const Mesh mesh = relief();
  const std::vector<int> signs = {1, -1, -1, 1};
  const std::string ending = GENERATE(".obj", ".ply");
  write_signs(folder.file("a.#" + ending), mesh, signs);
  for (std::size_t k = 0; k < signs.size(); ++k) {
    CAPTURE(ending, k);
    const auto file = folder.file("a." + std::to_string(k + 1) + ending);
    const Mesh written = read_mesh(file).value();
    const Field expected = moved_areas(area_vectors(mesh), placed(signs[k]).linear);
    CHECK((area_vectors(written) - expected).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(written.corner_vertices.front() == mesh.corner_vertices.front());
    // Every corner keeps the (u,v) of its vertex in its face.
    Mesh turned = mesh;
    if (signs[k] < 0) turn_faces(turned);
    CHECK(written.corner_vertices == turned.corner_vertices);
    for (std::size_t corner = 0; corner < turned.corner_uvs.size(); ++corner) {
      const auto& [u, v] = written.uvs[static_cast<std::size_t>(written.corner_uvs[corner])];
      const auto& uv = mesh.uvs[static_cast<std::size_t>(turned.corner_uvs[corner])];
      CHECK(static_cast<float>(u) == static_cast<float>(uv[0]));  // a list of a PLY is float
      CHECK(static_cast<float>(v) == static_cast<float>(uv[1]));
    }
  }
}

TEST_CASE("the normals of an OBJ file look as its faces do", "[output][mirrored]") {
  const ScratchFolder folder;
  const Mesh mesh = relief();
  const int sign = GENERATE(1, -1);
  write_signs(folder.file("a.obj"), mesh, {sign});
  std::vector<Eigen::RowVector3d> normals;
  std::istringstream lines(bytes_in(folder.file("a.0001.obj")));
  const Field areas = moved_areas(area_vectors(mesh), placed(sign).linear);
  Eigen::Index face = 0;
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "vn") {
      Eigen::RowVector3d normal;
      words >> normal[0] >> normal[1] >> normal[2];
      normals.push_back(normal);
    }
    if (word != "f") continue;
    while (words >> word) {
      const std::size_t normal = std::stoul(word.substr(word.rfind('/') + 1));
      CHECK(normals.at(normal - 1).dot(areas.row(face)) > 0);
    }
    ++face;
  }
  CHECK(face == areas.rows());
}

TEST_CASE("a file with the same faces at all frames turns them as its first one says",
          "[output][mirrored]") {
  const ScratchFolder folder;
  const Mesh mesh = relief();
  const std::vector<int> signs = GENERATE(std::vector<int>{1, 1}, std::vector<int>{-1, -1},
                                          std::vector<int>{1, -1}, std::vector<int>{-1, 1});
  const Matrix3d linear = placed(signs.front()).linear;
  const Field expected = moved_areas(area_vectors(mesh), linear);
  CAPTURE(signs);
  for (const std::string ending : {".glb", ".gltf", ".pc2", ".mdd"}) {
    CAPTURE(ending);
    const auto file = folder.file("a" + ending);
    write_signs(file, mesh, signs);
    const bool is_cache = ending == ".pc2" || ending == ".mdd";
    const Mesh written = read_mesh(is_cache ? folder.file("a.obj") : file).value();
    if (is_cache) {
      CHECK((area_vectors(written) - expected).cwiseAbs().maxCoeff() < 1e-12);
    } else {
      // Its triangles are sorted by material: the whole.
      const Field areas = area_vectors(written);
      CHECK((areas.colwise().sum() - expected.colwise().sum()).cwiseAbs().maxCoeff() < 1e-5);
    }
  }
  write_signs(folder.file("a.usda"), mesh, signs);
  const std::string text = bytes_in(folder.file("a.usda"));
  std::smatch found;
  REQUIRE(std::regex_search(text, found, std::regex(R"(faceVertexIndices = \[([^\]]*)\])")));
  Mesh turned = mesh;
  if (signs.front() < 0) turn_faces(turned);
  CHECK(found[1] == fmt::format("{}", fmt::join(turned.corner_vertices, ", ")));
  CHECK(text.find("orientation = \"rightHanded\"") != std::string::npos);
}

TEST_CASE("a surface that is placed keeps its faces: who shows it turns them",
          "[output][mirrored]") {
  const ScratchFolder folder;
  Mesh mesh = relief();
  mesh.materials = {};
  auto writer = make_writer({.file = folder.file("a.glb"),
                             .surfaces = {{.name = "sheet", .mesh = &mesh, .rest = mesh.positions}},
                             .first_frame = 1,
                             .last_frame = 1,
                             .is_placed = true})
                    .value();
  const Placement mirrored{.scale = {-1, 1, 1}};
  REQUIRE(writer->write(1, std::vector{SurfacePose{mesh.positions, mirrored}}));
  REQUIRE(writer->finish());
  // Our own reader applies the node's scale, and so turns them.
  const Mesh written = read_mesh(folder.file("a.glb")).value();
  const Field expected = moved_areas(area_vectors(mesh), make_transform(mirrored).linear);
  CHECK((by_faces(mesh, area_vectors(written)) - expected).cwiseAbs().maxCoeff() < 1e-6);
}
