#include "pliant/sampling/rest_shape.hpp"

#include <cstdint>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/read_mesh.hpp"
#include "pliant/sampling/memory.hpp"
#include "pliant/scene/check.hpp"

namespace pliant {
namespace {

struct MakeMesh {
  Result<Mesh> operator()(const GridSheet& sheet) const { return make_mesh(sheet); }
  Result<Mesh> operator()(const MeshFile& file) const {
    return read_mesh(file.path, file.object, file.uv_set, file.root, context);
  }
  Result<Mesh> operator()(const Mesh& mesh) const {
    if (auto checked = check_mesh(mesh); !checked) return fail(checked.error());
    return mesh;
  }

  const RunContext& context;
};

// The memory for making a shape, as far as it is known in advance.
struct BytesToMake {
  std::size_t operator()(const GridSheet& sheet) const {
    const auto vertex_count = static_cast<std::size_t>(sheet.columns) * sheet.rows;
    return bytes_of(sheet) + bytes_to_run(vertex_count);
  }
  std::size_t operator()(const MeshFile& file) const { return bytes_per_byte * size_of(file.path); }
  std::size_t operator()(const Mesh& mesh) const { return bytes_of(mesh); }

  // The files that a mesh file refers to; known only after reading the file, which needs memory
  // itself.
  static std::size_t of_references(const MeshFile& file) {
    std::size_t bytes = 0;
    for (const auto& reference : mesh_references(file.path, file.root)) bytes += size_of(reference);
    return bytes_per_byte * bytes;
  }

 private:
  // The file and its mesh; a reader may need the same amount twice more while reading.
  static constexpr std::size_t bytes_per_byte = 4;

  static std::size_t size_of(const std::filesystem::path& file) {
    std::error_code unknown;  // if the file does not exist, reading it reports that
    const std::uintmax_t bytes = std::filesystem::file_size(file, unknown);
    return unknown ? 0 : static_cast<std::size_t>(bytes);
  }
};

}  // namespace

namespace {

// Resizes a surface's share of the memory.
Result<void> take(std::size_t bytes, const Surface& surface, const SceneOrigin& origin,
                  MemoryShare& memory) {
  if (memory.try_resize(bytes)) return {};
  return fail({.code = ErrorCode::OutOfMemory,
               .message = fmt::format("surface \"{}\" {}", surface.name, memory.complaint(bytes)),
               .file = origin.file,
               .line = origin.line_of(surface.name)});
}

}  // namespace

Field RestShape::to_vertices(const Field& nodes, Field reuse) const {
  reuse.resize(static_cast<Eigen::Index>(vertex_nodes.size()), 3);
  for (int component = 0; component < 3; ++component) {
    const double* const from = nodes.col(component).data();
    double* const to = reuse.col(component).data();
    if (grid) {
      for (std::size_t vertex = 0; vertex < vertex_nodes.size(); ++vertex)
        to[vertex] = from[vertex_nodes[vertex]];
      continue;
    }
    const double* const at_rest = rest.col(component).data();
    const double* const vertices = mesh.positions.col(component).data();
    for (std::size_t vertex = 0; vertex < vertex_nodes.size(); ++vertex) {
      const int node = vertex_nodes[vertex];
      to[vertex] = vertices[vertex] + (node < 0 ? 0 : from[node] - at_rest[node]);
    }
  }
  return reuse;
}

Result<ReservedShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  const auto at_scene = [&](Error error) {
    // An unreadable file is reported as a problem of the scene; an error in its contents already
    // names the file.
    if (error.code == ErrorCode::Unreadable)
      return fail(unreadable_mesh(error, surface.name, origin));
    if (error.file.empty()) {
      error.file = origin.file;
      error.line = origin.line_of(surface.name, "file");
    }
    return fail(std::move(error));
  };
  if (const auto* file = std::get_if<MeshFile>(&surface.shape)) {
    if (auto readable = check_mesh_file(file->path); !readable) return at_scene(readable.error());
  }
  MemoryShare memory(context.memory);
  std::size_t ahead = std::visit(BytesToMake{}, surface.shape);
  if (auto taken = take(ahead, surface, origin, memory); !taken) return fail(taken.error());
  if (const auto* file = std::get_if<MeshFile>(&surface.shape)) {
    ahead += BytesToMake::of_references(*file);
    if (auto taken = take(ahead, surface, origin, memory); !taken) return fail(taken.error());
  }
  auto mesh = std::visit(MakeMesh{context}, surface.shape);
  if (!mesh) return at_scene(mesh.error());
  const std::size_t bytes =
      bytes_of(*mesh) + bytes_to_run(static_cast<std::size_t>(mesh->vertex_count()));
  if (auto taken = take(bytes, surface, origin, memory); !taken) return fail(taken.error());
  auto mapping = find_grid(*mesh);
  if (!mapping) {
    Error error = mapping.error();
    const auto* file = std::get_if<MeshFile>(&surface.shape);
    error.message = fmt::format("surface \"{}\"{}: {}", surface.name,
                                file ? ", mesh " + file->path : "", error.message);
    return at_scene(std::move(error));
  }
  return ReservedShape{{.name = surface.name,
                        .mesh = *std::move(mesh),
                        .vertex_nodes = std::move(mapping->vertex_nodes),
                        .rest = std::move(mapping->rest),
                        .grid = mapping->grid},
                       std::move(memory)};
}

Result<MemoryShare> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                     const RunContext& context) {
  if (const auto* sheet = std::get_if<GridSheet>(&surface.shape)) {
    MemoryShare memory(context.memory);
    if (auto taken = take(BytesToMake{}(*sheet), surface, origin, memory); !taken)
      return fail(taken.error());
    return memory;
  }
  auto made = make_rest_shape(surface, origin, context);
  if (!made) return fail(made.error());
  return std::move(made->memory);
}

}  // namespace pliant
