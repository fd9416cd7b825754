// Readers of meshes and maps end soon after they are asked to.

#include <algorithm>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "files/gltf/gltf_files.hpp"
#include "pliant/files/npy/npy_grid.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/png/read_png.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/normals.hpp"
#include "pliant/mesh/triangles/weld.hpp"
#include "support/catch.hpp"
#include "support/png.hpp"
#include "support/stopping.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A reader must ask at least once for so many bytes: some hundredths of a second.
constexpr int bytes_between = 1 << 19;

template <class Read>
void stop_reading(const std::string& file, const Read& read) {
  check_stops([&](const StopRequest& should_stop) { return read(file, should_stop); },
              std::max(1, static_cast<int>(file.size()) / bytes_between));
}

constexpr int vertices = 60'000;

std::string obj_of_strips() {
  std::string text = "o a\n";
  for (int k = 0; k < vertices; ++k)
    text += fmt::format("v {} {} 0.5\nvt 0.5 {}\n", k / 2, k % 2, k);
  for (int k = 0; k + 2 < vertices; ++k)
    text += fmt::format("s {}\nf {} {} {}\n", k % 7, k + 1, k + 2, k + 3);
  return text;
}

std::string ply_header(std::string_view format, int faces, std::string_view count) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face {}\nproperty list {} int vertex_indices\nend_header\n",
      format, vertices, faces, count);
}

std::string floats_of_vertices() {
  std::string bytes;
  for (int k = 0; k < vertices; ++k)
    bytes += floats({static_cast<float>(k / 2), static_cast<float>(k % 2), 0});
  return bytes;
}

}  // namespace

TEST_CASE("reading an OBJ ends when asked, within its lines too", "[mesh][read_obj][stop]") {
  const auto parse = [](const std::string& text, const StopRequest& should_stop) {
    return parse_obj(text, "m.obj", "a", should_stop);
  };
  stop_reading(obj_of_strips(), parse);
  std::string one_face = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int k = 0; k < 200'000; ++k) one_face += fmt::format(" {}", k % 3 + 1);
  stop_reading(one_face, parse);
  stop_reading("o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\np" + std::string(1 << 21, '\t') +
                   one_face.substr(one_face.find(" 1")),
               parse);
}

TEST_CASE("reading a PLY ends when asked, in its header and its blanks too",
          "[mesh][read_ply][stop]") {
  const auto parse = [](const std::string& bytes, const StopRequest& should_stop) {
    return parse_ply(bytes, "m.ply", {}, {}, should_stop);
  };
  std::string text = ply_header("ascii", vertices - 2, "uchar");
  for (int k = 0; k < vertices; ++k) text += fmt::format("{} {} 0\n", k / 2, k % 2);
  for (int k = 0; k + 2 < vertices; ++k) text += fmt::format("3 {} {} {}\n", k, k + 1, k + 2);
  stop_reading(text, parse);
  stop_reading(text + std::string(1 << 21, ' '), parse);
  std::string binary = ply_header("binary_little_endian", 1, "uint") + floats_of_vertices() +
                       little_endian(vertices, 4);
  for (int k = 0; k < vertices; ++k) binary += little_endian(static_cast<std::uint64_t>(k), 4);
  stop_reading(binary, parse);
  std::string header = "ply\nformat ascii 1.0\n";
  for (int k = 0; k < 40'000; ++k)
    header += fmt::format("element e{} 0\nproperty int a\ncomment nothing\n", k);
  stop_reading(header + text.substr(text.find("element")), parse);
}

TEST_CASE("reading a glTF ends when asked, for many elements and for much data",
          "[mesh][read_gltf][stop]") {
  const auto parse = [](const std::string& bytes, const StopRequest& should_stop) {
    return parse_gltf(bytes, "m.gltf", {}, {}, 0, {}, should_stop);
  };
  GltfParts strip{
      .accessors = fmt::format(
          R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}})", vertices),
      .views = fmt::format(R"({{"buffer":0,"byteLength":{}}})", 12 * vertices),
      .primitives = R"({"attributes":{"POSITION":0},"mode":5})",
      .bytes = floats_of_vertices()};
  stop_reading(strip.text(), parse);
  GltfParts many = strip;
  for (int k = 0; k < 3000; ++k)
    many.nodes += fmt::format(R"(,{{"name":"n{}","translation":[0,{},1]}})", k, k);
  stop_reading(many.text(), parse);
}

TEST_CASE("reading a map ends when asked", "[mesh][read_png][npy_grid][stop]") {
  PngMaker picture{.width = 1000, .height = 1000, .values = std::vector<int>(1'000'000)};
  stop_reading(picture.bytes(), [](const std::string& bytes, const StopRequest& should_stop) {
    return parse_png(bytes, "m.png", should_stop);
  });
  // Chunks are read before any row.
  PngMaker chunks{.width = 3, .height = 3, .values = std::vector<int>(9)};
  for (int k = 0; k < 5000; ++k) chunks.more += PngMaker::chunk("tEXt", "a");
  stop_reading(chunks.bytes(), [](const std::string& bytes, const StopRequest& should_stop) {
    return parse_png(bytes, "m.png", should_stop);
  });
  const std::string head = "{'descr': '<f8', 'fortran_order': False, 'shape': (400, 500), }";
  const std::string numbers = "\x93NUMPY\x01" + std::string(1, '\0') +
                              little_endian(head.size(), 2) + head + std::string(1'600'000, '\0');
  stop_reading(numbers, [](const std::string& bytes, const StopRequest& should_stop) {
    return parse_npy_grid(bytes, "m.npy", 500, 400, should_stop);
  });
}

TEST_CASE("checking, shading and welding a mesh end when asked", "[mesh][stop]") {
  const Mesh sheet = make_mesh({.columns = 300, .rows = 300});
  check_stops([&](const StopRequest& should_stop) { return check_mesh(sheet, should_stop); }, 2);
  Shading shading;
  shading.smoothing.assign(sheet.face_sizes.size(), 1);
  shading.smoothing.front() = Shading::flat;
  check_stops(
      [&](const StopRequest& should_stop) { return shared_normals(sheet, shading, should_stop); },
      10);
  check_stops(
      [&](const StopRequest& should_stop) { return welded(sheet.positions, 0.01, should_stop); },
      10);
}
