#include "pliant/sampling/rest_shape.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "pliant/body/grid_body.hpp"
#include "pliant/body/surface_body.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/read_mesh.hpp"
#include "pliant/mesh/triangle_surface.hpp"
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

namespace {

// `surface "head", mesh head.obj`
std::string title_of(const Surface& surface) {
  const auto* file = std::get_if<MeshFile>(&surface.shape);
  return fmt::format("surface \"{}\"{}", surface.name, file ? ", mesh " + file->path : "");
}

RestShape on_grid(const Surface& surface, Mesh mesh, GridMapping mapping) {
  return {.name = surface.name,
          .mesh = std::move(mesh),
          .vertex_nodes = std::move(mapping.vertex_nodes),
          .rest = std::move(mapping.rest),
          .grid = mapping.grid};
}

Result<RestShape> on_surface(const Surface& surface, Mesh mesh) {
  auto triangles = make_surface(mesh, surface.reading);
  if (!triangles) return fail(triangles.error());
  RestShape shape{.name = surface.name,
                  .mesh = std::move(mesh),
                  .vertex_nodes = triangles->vertex_nodes,
                  .rest = triangles->rest};
  shape.surface = std::make_shared<const TriangleSurface>(*std::move(triangles));
  return shape;
}

// Reads the mesh in the way that the scene asks for, or that suits it. docs/meshes.md.
Result<RestShape> read_nodes(const Surface& surface, Mesh mesh) {
  const MeshReading& reading = surface.reading;
  if (reading.asks_for_surface()) return on_surface(surface, std::move(mesh));
  const auto* const file = std::get_if<MeshFile>(&surface.shape);
  const Wrap wrap = file ? file->wrap : Wrap::None;
  auto grid = find_grid(mesh, wrap);
  if (grid) return on_grid(surface, std::move(mesh), *std::move(grid));
  const std::string reason = grid.error().message;
  if (reading.uv == UvReading::Grid || wrap != Wrap::None) {
    const std::string_view other =
        reason.ends_with(": a seam") ? "wrap=\"u\" or \"v\" closes a grid there, and " : "";
    return invalid(
        fmt::format("the mesh is no even grid: {}; {}uv=\"surface\" reads any mesh "
                    "(docs/meshes.md)",
                    reason, other));
  }
  auto shape = on_surface(surface, std::move(mesh));
  if (!shape) return shape;
  shape->note = fmt::format("{}: the mesh{} is read as a surface, since it is no even grid: {}",
                            surface.name, file ? " " + file->path : "", reason);
  return shape;
}

// What a surface of triangles cannot do.
Result<void> check_as_surface(const Surface& surface, const RestShape& shape,
                              const SceneOrigin& origin) {
  if (shape.grid || surface.solver.reference == Reference::Rest) return {};
  return fail({.code = ErrorCode::InvalidInput,
               .message = fmt::format(
                   "{}: reference=\"none\" needs a grid, whose sides determine the shape at rest, "
                   "but the mesh is read as a surface{}",
                   title_of(surface), shape.note.empty() ? "" : ", since it is no even grid"),
               .file = origin.file,
               .line = origin.line_of(surface.name, "reference")});
}

}  // namespace

Field RestShape::to_vertices(const Field& nodes, Field reuse) const {
  reuse.resize(static_cast<Eigen::Index>(vertex_nodes.size()), 3);
  for (int component = 0; component < 3; ++component) {
    const double* const from = nodes.col(component).data();
    double* const to = reuse.col(component).data();
    if (grid && grid->is_open()) {
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

std::optional<SurfaceSummary> summary_of(const RestShape& shape) {
  if (!shape.surface) return {};
  const TriangleSurface& surface = *shape.surface;
  SurfaceSummary summary{
      .nodes = surface.node_count(), .faces = surface.face_count(), .unit = surface.unit};
  summary.border_edges =
      static_cast<int>(std::count(surface.edge_sides.begin(), surface.edge_sides.end(), 1));
  // Counts pieces by walking from each node not seen before.
  std::vector<bool> is_seen(static_cast<std::size_t>(surface.node_count()));
  std::vector<int> open;
  for (int first = 0; first < surface.node_count(); ++first) {
    if (is_seen[first]) continue;
    ++summary.pieces;
    is_seen[first] = true;
    open.push_back(first);
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      for (const int face : surface.faces_of(node)) {
        for (const int other : surface.nodes_of(face)) {
          if (is_seen[other]) continue;
          is_seen[other] = true;
          open.push_back(other);
        }
      }
    }
  }
  return summary;
}

std::unique_ptr<Body> make_body(const RestShape& shape, const BodySettings& settings,
                                SolverChoice solver, RunContext context) {
  if (shape.surface) {
    return std::make_unique<SurfaceBody>(shape.surface, settings, solver, std::move(context));
  }
  return std::make_unique<GridBody>(*shape.grid, shape.rest, settings, solver, std::move(context));
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
      bytes_of(*mesh) + bytes_to_run(static_cast<std::size_t>(mesh->vertex_count())) +
      (std::holds_alternative<GridSheet>(surface.shape) ? 0 : bytes_as_surface(*mesh));
  if (auto taken = take(bytes, surface, origin, memory); !taken) return fail(taken.error());
  auto shape = read_nodes(surface, *std::move(mesh));
  if (!shape) {
    Error error = shape.error();
    error.message = fmt::format("{}: {}", title_of(surface), error.message);
    return at_scene(std::move(error));
  }
  if (auto sound = check_as_surface(surface, *shape, origin); !sound) return fail(sound.error());
  return ReservedShape{*std::move(shape), std::move(memory)};
}

Result<CheckedShape> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  if (const auto* sheet = std::get_if<GridSheet>(&surface.shape)) {
    MemoryShare memory(context.memory);
    if (auto taken = take(BytesToMake{}(*sheet), surface, origin, memory); !taken)
      return fail(taken.error());
    return CheckedShape{std::move(memory)};
  }
  auto made = make_rest_shape(surface, origin, context);
  if (!made) return fail(made.error());
  return CheckedShape{std::move(made->memory), std::move(made->shape.note)};
}

std::optional<SceneNote> note_on(const Surface& surface, const std::string& note,
                                 const SceneOrigin& origin) {
  if (note.empty()) return {};
  return SceneNote{origin.line_of(surface.name, "file"), note};
}

}  // namespace pliant
