#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "pliant/core/result.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/mesh/triangles/triangulate.hpp"
#include "pliant/mesh/written/subdivide.hpp"

namespace pliant::fuzzing {

/// Ends the program if it is not so, and says where; libFuzzer then keeps the input.
inline void require(bool is_so, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (is_so) return;
  std::fprintf(stderr, "%s:%d: this is not so\n", file, line);
  std::abort();
}

inline std::string_view text_of(const std::uint8_t* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// The parts of a text with `between` between them; at least one.
inline std::vector<std::string_view> parts_between(std::string_view text,
                                                   std::string_view between) {
  std::vector<std::string_view> parts;
  for (std::size_t end; (end = text.find(between)) != std::string_view::npos;) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + between.size());
  }
  parts.push_back(text);
  return parts;
}

/// A file with these bytes that is on no disk.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
    require(file_ >= 0);
    while (!bytes.empty()) {
      const auto written = write(file_, bytes.data(), bytes.size());
      require(written > 0);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(file_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// At most `most` problems, each a line that says something.
inline void check_error(const Error& error, std::size_t most = 1) {
  require(error.others.size() < most);
  for (const std::string& line : to_lines(error)) {
    require(line.size() > std::string_view("error: ").size() && line.size() < 4000);
    require(line == printable(line));
  }
}

/// What a valid mesh becomes: triangles; a surface, a grid or an error; a finer mesh of a cage.
inline void check_readings(const Mesh& mesh) {
  const auto corners = mesh.corner_vertices.size();
  const auto triangles = triangulate(mesh);
  require(triangles.size() == corners - 2 * mesh.face_sizes.size());
  for (const auto& triangle : triangles) {
    for (const int corner : triangle)
      require(corner >= 0 && static_cast<std::size_t>(corner) < corners);
  }
  for (const Wrap wrap : {Wrap::None, Wrap::U, Wrap::UV}) {
    const auto grid = find_grid(mesh, wrap);
    if (!grid) {
      check_error(grid.error());
      continue;
    }
    require(grid->rest.allFinite() && grid->rest.rows() == grid->grid.node_count());
    require(std::ranges::all_of(
        grid->vertex_nodes, [&](int node) { return node >= 0 && node < grid->grid.node_count(); }));
  }
  for (const bool is_joined : {true, false}) {
    MeshReading reading;
    if (!is_joined) reading.weld = 0;
    const auto surface = make_surface(mesh, reading);
    if (!surface) {
      check_error(surface.error());
      continue;
    }
    require(surface->rest.allFinite() && surface->face_count() > 0);
    require(surface->vertex_nodes.size() == static_cast<std::size_t>(mesh.vertex_count()));
    for (const SubdivisionScheme scheme :
         {SubdivisionScheme::CatmullClark, SubdivisionScheme::Loop}) {
      const auto finer = subdivide(mesh, *surface, {.levels = 1, .scheme = scheme});
      if (!finer) {
        check_error(finer.error());
        continue;
      }
      require(check_mesh(finer->mesh).has_value());
      require(finer->weights.vertex_count() == finer->mesh.vertex_count());
    }
  }
}

/// The result of a reader: a mesh that every room can use, or at most `most` problems.
inline void check_read(const Result<Mesh>& mesh, std::size_t most = 1) {
  if (!mesh) return check_error(mesh.error(), most);
  require(check_mesh(*mesh).has_value());
  require(mesh->positions.allFinite());
  // A glTF of a few bytes may have a million elements.
  if (mesh->vertex_count() < 2000 && mesh->corner_vertices.size() < 2000) check_readings(*mesh);
}

}  // namespace pliant::fuzzing
