#include "pliant/sampling/rest_shape.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "pliant/body/driven_body.hpp"
#include "pliant/body/grid_body.hpp"
#include "pliant/body/triangle_body.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/mesh/written/binding.hpp"
#include "pliant/mesh/written/nurbs_surface.hpp"
#include "pliant/mesh/written/subdivide.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/sampling/memory.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/scene/checks/check.hpp"

namespace pliant {
namespace {

// Whether it is a sheet that no triangles are made of: a grid, or driven.
bool is_plain_sheet(const Surface& surface) {
  return std::holds_alternative<GridSheet>(surface.shape) &&
         (surface.reading.uv != UvReading::Surface || surface.is_driven());
}

// The memory for making a shape, as far as it is known in advance.
struct BytesToMake {
  const Surface& surface;

  std::size_t operator()(const GridSheet& sheet) const {
    const auto vertex_count = static_cast<std::size_t>(sheet.columns) * sheet.rows;
    return bytes_of(sheet) + bytes_to_run(vertex_count) +
           (is_plain_sheet(surface) ? 0 : bytes_as_surface(sheet));
  }
  std::size_t operator()(const MeshFile&) const { return 0; }  // known when it is open
  std::size_t operator()(const Mesh& mesh) const { return bytes_of(mesh); }
  std::size_t operator()(const NurbsNet& net) const {
    const WrittenSize size = check_net(net).value();
    return bytes_of(size) + bytes_to_run(static_cast<std::size_t>(size.vertices) +
                                         static_cast<std::size_t>(net.points.rows()));
  }
};

// Resizes a surface's share of the memory.
Result<void> take(std::size_t bytes, const std::string& surface, const SceneOrigin& origin,
                  MemoryShare& memory) {
  if (memory.try_resize(bytes)) return {};
  return fail(origin.located(
      {.code = ErrorCode::OutOfMemory,
       .message = fmt::format("surface \"{}\" {}", surface, memory.complaint(bytes))},
      origin.at(surface)));
}

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

// A sheet is its grid, whatever its size: its vertices are the nodes, in their order.
GridMapping mapping_of(const GridSheet& sheet, const Mesh& mesh) {
  GridMapping mapping{
      .grid = {sheet.columns, sheet.rows, 1.0 / (sheet.columns - 1), 1.0 / (sheet.rows - 1)},
      .vertex_nodes = std::vector<int>(static_cast<std::size_t>(mesh.vertex_count())),
      .rest = mesh.positions};
  std::iota(mapping.vertex_nodes.begin(), mapping.vertex_nodes.end(), 0);
  return mapping;
}

Result<RestShape> on_surface(const Surface& surface, Mesh mesh, const StopRequest& should_stop) {
  MeshReading reading = surface.reading;
  // So the numbers of the sheet's grid carry over.
  if (const auto* const sheet = std::get_if<GridSheet>(&surface.shape); sheet && !reading.unit)
    reading.unit = {sheet->width, sheet->depth};
  auto triangles = make_surface(mesh, reading, should_stop);
  if (!triangles) return fail(triangles.error());
  RestShape shape{.name = surface.name,
                  .mesh = std::move(mesh),
                  .vertex_nodes = triangles->vertex_nodes,
                  .rest = triangles->rest};
  shape.surface = std::make_shared<const TriangleSurface>(*std::move(triangles));
  return shape;
}

// Reads the mesh in the way that the scene asks for, or that suits it. docs/meshes.md.
Result<RestShape> read_nodes(const Surface& surface, Mesh mesh, const StopRequest& should_stop) {
  const MeshReading& reading = surface.reading;
  if (reading.asks_for_surface()) return on_surface(surface, std::move(mesh), should_stop);
  if (const auto* const sheet = std::get_if<GridSheet>(&surface.shape)) {
    GridMapping mapping = mapping_of(*sheet, mesh);
    return on_grid(surface, std::move(mesh), std::move(mapping));
  }
  const auto* const file = std::get_if<MeshFile>(&surface.shape);
  auto grid = find_grid(mesh, reading.wrap,
                        reading.uv == UvReading::Grid ? Seams::Open : Seams::Refused, should_stop);
  if (grid) return on_grid(surface, std::move(mesh), *std::move(grid));
  if (grid.error().code == ErrorCode::Interrupted) return fail(grid.error());
  const std::string reason = grid.error().message;
  if (reading.uv == UvReading::Grid || reading.wrap != Wrap::None) {
    const std::string_view other =
        reason.ends_with(": a seam") ? "wrap=\"u\" or \"v\" closes a grid there, and " : "";
    return invalid(
        fmt::format("the mesh is no even grid: {}; {}uv=\"surface\" reads any mesh "
                    "(docs/meshes.md)",
                    reason, other));
  }
  auto shape = on_surface(surface, std::move(mesh), should_stop);
  if (!shape) return shape;
  shape->note = fmt::format(
      "{}: the mesh{} is read as a surface, as most models are: it bends on its own faces, "
      "whatever "
      "its UVs, which form no even grid ({}); nothing is wrong, and uv=\"surface\" ends this note",
      surface.name, file ? " " + file->path : "", reason);
  return shape;
}

// Makes the shape of one surface, and reserves its memory.
class ShapeMaker {
 public:
  ShapeMaker(const Surface& surface, const SceneOrigin& origin, const RunContext& context)
      : surface_(surface), origin_(origin), context_(context), memory_(context.memory) {}

  Result<ReservedShape> make() {
    const auto* const net = std::get_if<NurbsNet>(&surface_.shape);
    auto shape = net ? make_net(*net) : make_of_mesh();
    if (!shape) return fail(shape.error());
    return ReservedShape{*std::move(shape), std::move(memory_)};
  }

  // Only reserves what the grid of a sheet or a net needs, which then can be made.
  Result<CheckedShape> check() {
    if (surface_.maps.empty() && surface_.holds.empty() &&
        (is_plain_sheet(surface_) || std::holds_alternative<NurbsNet>(surface_.shape))) {
      if (auto taken = take_bytes(std::visit(BytesToMake{surface_}, surface_.shape)); !taken)
        return fail(taken.error());
      return CheckedShape{std::move(memory_)};
    }
    auto made = make();
    if (!made) return fail(made.error());
    return CheckedShape{std::move(made->memory), std::move(made->shape.note),
                        left_out_text(surface_.name, made->shape.mesh.left_out)};
  }

 private:
  Result<RestShape> make_net(const NurbsNet& net) {
    if (auto taken = take_bytes(BytesToMake{surface_}(net)); !taken) return fail(taken.error());
    auto made = make_nurbs(net, context_.should_stop);
    if (!made) return fail(made.error());
    if (surface_.is_driven()) return mesh_only(std::move(made->mesh));
    std::vector<int> vertex_nodes = no_nodes(made->mesh);
    RestShape shape{.name = surface_.name,
                    .mesh = std::move(made->mesh),
                    .vertex_nodes = std::move(vertex_nodes),
                    .rest = net.points,
                    .grid = made->grid};
    shape.weights = std::make_shared<const VertexWeights>(std::move(made->weights));
    if (auto added = add_maps(shape); !added) return fail(added.error());
    if (auto added = add_holds(shape); !added) return fail(added.error());
    return shape;
  }

  Result<RestShape> make_of_mesh() {
    auto mesh = make_mesh_of_shape();
    if (!mesh) return fail(mesh.error());
    const std::size_t bytes = bytes_of(*mesh) +
                              bytes_to_run(static_cast<std::size_t>(mesh->vertex_count())) +
                              (is_plain_sheet(surface_) ? 0 : bytes_as_surface(*mesh));
    if (auto taken = take_bytes(bytes); !taken) return fail(taken.error());
    if (surface_.is_driven() && !surface_.subdivision) return mesh_only(*std::move(mesh));
    auto shape = read_nodes(surface_, *std::move(mesh), context_.should_stop);
    if (!shape) {
      const bool is_closed = origin_.gives(surface_.name, "wrap");
      return fail(about_mesh(shape.error(), is_closed ? "wrap" : "file"));
    }
    if (auto sound = check_as_surface(*shape); !sound) return fail(sound.error());
    if (auto added = add_maps(*shape); !added) return fail(added.error());
    if (auto added = add_holds(*shape); !added) return fail(added.error());
    if (!surface_.subdivision) return shape;
    return subdivided(*std::move(shape), memory_.bytes());
  }

  Result<Mesh> make_mesh_of_shape() {
    if (const auto* const file = std::get_if<MeshFile>(&surface_.shape)) return read(*file);
    if (auto taken = take_bytes(std::visit(BytesToMake{surface_}, surface_.shape)); !taken)
      return fail(taken.error());
    if (const auto* const sheet = std::get_if<GridSheet>(&surface_.shape))
      return make_mesh(*sheet, context_.should_stop);
    const Mesh& own = std::get<Mesh>(surface_.shape);
    if (auto checked = check_mesh(own, context_.should_stop); !checked)
      return fail(at_scene(checked.error()));
    return own;
  }

  Result<Mesh> read(const MeshFile& file) {
    const auto opened = OpenFile::open(file.path, origin_.root);
    if (!opened) return fail(at_scene(opened.error()));
    std::size_t ahead = bytes_to_read(*opened);
    if (auto taken = take_bytes(ahead); !taken) return fail(taken.error());
    ahead += bytes_to_read_references(*opened, file.root, context_.should_stop);
    if (auto taken = take_bytes(ahead); !taken) return fail(taken.error());
    const std::vector<std::string> attributes = attributes_of_maps(surface_);
    const auto read_with = [&](std::span<const std::string> names) {
      return read_mesh(*opened, file.object, file.uv_set, file.root, context_, names);
    };
    auto mesh = read_with(attributes);
    if (mesh) return mesh;
    // Whether it is about an attribute, and about which one, is known by reading the mesh without.
    if (mesh.error().code == ErrorCode::InvalidInput && !attributes.empty() && read_with({})) {
      for (const std::string& attribute : attributes) {
        if (const auto alone = read_with({&attribute, 1}); !alone)
          return fail(about_attribute(surface_, origin_, alone.error(), attribute));
      }
    }
    return fail(at_scene(mesh.error()));
  }

  Result<RestShape> subdivided(RestShape shape, std::size_t bytes) {
    if (shape.grid) {
      auto triangles =
          surface_of_nodes(shape.mesh, shape.vertex_nodes, shape.rest, context_.should_stop);
      if (!triangles) return fail(about_mesh(triangles.error()));
      shape.cage = std::make_shared<const TriangleSurface>(*std::move(triangles));
    }
    const TriangleSurface& cage = shape.cage ? *shape.cage : *shape.surface;
    const auto size = check_subdivision(shape.mesh, cage, *surface_.subdivision);
    if (!size) return fail(about_mesh(size.error()));
    bytes += bytes_of(*size) + bytes_to_run(static_cast<std::size_t>(size->vertices));
    if (auto taken = take_bytes(bytes); !taken) return fail(taken.error());
    auto made = subdivide(shape.mesh, cage, *surface_.subdivision, context_.should_stop);
    if (!made) return fail(about_mesh(made.error()));
    made->mesh.left_out = std::move(shape.mesh.left_out);
    if (surface_.is_driven()) return mesh_only(std::move(made->mesh));
    shape.mesh = std::move(made->mesh);
    shape.vertex_nodes = no_nodes(shape.mesh);
    shape.weights = std::make_shared<const VertexWeights>(std::move(made->weights));
    return shape;
  }

  // Of a driven surface.
  RestShape mesh_only(Mesh mesh) const {
    std::vector<int> vertex_nodes = no_nodes(mesh);
    return {.name = surface_.name,
            .mesh = std::move(mesh),
            .vertex_nodes = std::move(vertex_nodes),
            .rest = Field(0, 3)};
  }

  static std::vector<int> no_nodes(const Mesh& mesh) {
    return std::vector<int>(static_cast<std::size_t>(mesh.vertex_count()), -1);
  }

  // The memory of the files is kept: a map is small.
  Result<void> add_maps(RestShape& shape) {
    if (surface_.maps.empty() || surface_.is_driven()) return {};
    auto factors = read_maps(
        surface_, shape, origin_,
        [&](std::size_t bytes) { return take_bytes(memory_.bytes() + bytes); },
        context_.should_stop);
    if (!factors) return fail(factors.error());
    // By a ratio each node is damped by its own density.
    if (surface_.material.damping_ratio) factors->damping = factors->density;
    shape.factors = std::make_shared<const NodeFactors>(*std::move(factors));
    return {};
  }

  Result<void> add_holds(RestShape& shape) {
    if (surface_.holds.empty() || surface_.is_driven()) return {};
    auto held = read_holds(
        surface_, shape, origin_,
        [&](std::size_t bytes) { return take_bytes(memory_.bytes() + bytes); },
        context_.should_stop);
    if (!held) return fail(held.error());
    shape.held = std::make_shared<const NodeMarks>(*std::move(held));
    return {};
  }

  // What a surface of triangles cannot do.
  Result<void> check_as_surface(const RestShape& shape) const {
    if (shape.grid || surface_.is_driven()) return {};
    const auto refuse = [&](const char* attribute, std::string_view reason) {
      const bool is_sheet = std::holds_alternative<GridSheet>(surface_.shape);
      return fail(origin_.located(
          {.code = ErrorCode::InvalidInput,
           .message = fmt::format("{}: {}, but the {} is read as a surface{}", title_of(surface_),
                                  reason, is_sheet ? "sheet" : "mesh",
                                  shape.note.empty() ? "" : ", since it is no even grid")},
          origin_.at(surface_.name, attribute)));
    };
    const SolverSettings& solver = surface_.solver;
    if (solver.reference != Reference::Rest) {
      return refuse("reference",
                    "reference=\"none\" needs a grid, whose sides determine the shape at rest");
    }
    if (!solver.edges.are_clamped() || origin_.gives(surface_.name, "edges")) {
      return refuse("edges",
                    "edges are those of a grid, and border=\"free\" or \"pinned\" those "
                    "of a surface");
    }
    return {};
  }

  Result<void> take_bytes(std::size_t bytes) {
    return take(bytes, surface_.name, origin_, memory_);
  }

  // An unreadable file is reported as a problem of the scene; an error in its contents already
  // names the file.
  Error at_scene(Error error, const std::string& attribute = "file") const {
    if (error.code == ErrorCode::Unreadable)
      return origin_.located(
          {.code = error.code,
           .message = unreadable_mesh(error, fmt::format("surface \"{}\"", surface_.name))},
          origin_.at(surface_.name, "file"));
    if (!error.file.empty() || error.code == ErrorCode::Interrupted) return error;
    return origin_.located(std::move(error), origin_.at(surface_.name, attribute));
  }
  Error about_mesh(Error error, const std::string& attribute = "file") const {
    if (error.code == ErrorCode::Interrupted) return error;
    error.message = fmt::format("{}: {}", title_of(surface_), error.message);
    return at_scene(std::move(error), attribute);
  }

  const Surface& surface_;
  const SceneOrigin& origin_;
  const RunContext& context_;
  MemoryShare memory_;
};

// The mesh whose vertices move as nodes, of a net its control points, and the node of each.
std::pair<Mesh, std::vector<int>> mesh_of_nodes(const Surface& surface, const RestShape& shape) {
  const auto* const net = std::get_if<NurbsNet>(&surface.shape);
  if (!net) return {shape.mesh, shape.vertex_nodes};
  std::vector<int> nodes(static_cast<std::size_t>(shape.rest.rows()));
  std::iota(nodes.begin(), nodes.end(), 0);
  return {control_mesh(*net), std::move(nodes)};
}

}  // namespace

Field RestShape::to_vertices(const Field& nodes, Field reuse) const {
  return *to_vertices(nodes, std::move(reuse), {});
}

Result<Field> RestShape::to_vertices(const Field& nodes, Field reuse,
                                     const StopRequest& should_stop) const {
  if (weights) return weights->apply(nodes, std::move(reuse), should_stop);
  reuse.resize(static_cast<Eigen::Index>(vertex_nodes.size()), 3);
  for (int component = 0; component < 3; ++component) {
    if (is_stopped(should_stop)) return interrupted();
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
  for (const int piece : pieces_of(surface)) summary.pieces = std::max(summary.pieces, piece + 1);
  return summary;
}

std::optional<CacheSummary> cache_summary_of(const RestShape& shape) {
  if (!shape.animation) return {};
  const AnimatedShape& animation = *shape.animation;
  return CacheSummary{animation.sample_count(), animation.first_frame(), animation.last_frame()};
}

const std::vector<int>& RestShape::cache_nodes() const {
  if (!weights) return vertex_nodes;
  return cage ? cage->vertex_nodes : surface->vertex_nodes;
}

Result<std::unique_ptr<Body>> make_body(const RestShape& shape, const BodySettings& settings,
                                        SolverChoice solver, RunContext context) {
  if (shape.rest.rows() == 0) return std::make_unique<DrivenBody>(settings);
  if (shape.surface) {
    return std::make_unique<TriangleBody>(shape.surface, shape.tree, settings, solver,
                                          std::move(context), shape.factors, shape.held);
  }
  return std::make_unique<GridBody>(*shape.grid, shape.rest, settings, solver, std::move(context),
                                    shape.factors, shape.held, shape.faces);
}

Result<ReservedShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  auto made = ShapeMaker(surface, origin, context).make();
  if (!made || !made->shape.surface) return made;
  auto tree = PointTree::make(made->shape.surface->rest, context.should_stop);
  if (!tree) return fail(tree.error());
  made->shape.tree = std::make_shared<const PointTree>(*std::move(tree));
  return made;
}

Result<CheckedShape> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  return ShapeMaker(surface, origin, context).check();
}

Result<std::shared_ptr<const TriangleSurface>> triangles_of(const Surface& surface,
                                                            const RestShape& shape,
                                                            const StopRequest& should_stop) {
  if (shape.surface) return shape.surface;
  if (shape.cage) return shape.cage;
  auto [mesh, nodes] = mesh_of_nodes(surface, shape);
  auto made = surface_of_nodes(mesh, std::move(nodes), shape.rest, should_stop);
  if (!made) return fail(made.error());
  return std::make_shared<const TriangleSurface>(*std::move(made));
}

Result<void> find_faces(ReservedShape& made, const Surface& surface, const Scene& scene,
                        const StopRequest& should_stop) {
  RestShape& shape = made.shape;
  if (shape.surface) return {};
  if (shape.cage) {
    shape.faces = shape.cage;
    return {};
  }
  const auto [mesh, nodes] = mesh_of_nodes(surface, shape);
  const std::size_t bytes = made.memory.bytes() + bytes_of_faces(mesh);
  if (auto taken = take(bytes, surface.name, scene.origin, made.memory); !taken) return taken;
  auto faces = node_faces(mesh, nodes, static_cast<int>(shape.rest.rows()), should_stop);
  if (!faces) return fail(faces.error());
  shape.faces = std::make_shared<const NodeFaces>(*std::move(faces));
  return {};
}

Result<void> bind_to_driver(ReservedShape& driven, const Surface& own, const RestShape& driver,
                            const Surface& driving, const Scene& scene,
                            const StopRequest& should_stop) {
  RestShape& shape = driven.shape;
  const auto vertex_count = static_cast<std::size_t>(shape.mesh.vertex_count());
  const std::size_t bytes =
      driven.memory.bytes() + bytes_to_bind(vertex_count, driver.surface.get(), driver.mesh);
  if (auto taken = take(bytes, own.name, scene.origin, driven.memory); !taken) return taken;
  auto triangles = triangles_of(driving, driver, should_stop);
  if (triangles && driver.animation) {
    const auto nodes = driver.animation->nodes_at(scene.start);
    if (!nodes) return fail(nodes.error());
    triangles = std::make_shared<const TriangleSurface>(posed(**triangles, **nodes));
  }
  const auto refuse = [&](const Error& error) -> Result<void> {
    if (error.code == ErrorCode::Interrupted) return fail(error);
    return fail(scene.origin.located(
        {.message =
             fmt::format("{} cannot drive {}: {}", title_of(driving), own.name, error.message)},
        scene.origin.at(own.name, "drivenBy")));
  };
  if (!triangles) return refuse(triangles.error());
  auto binding =
      Binding::make(**triangles, driving.transform.at(scene.start),
                    to_world(own.transform.at(scene.start), shape.mesh.positions), should_stop);
  if (!binding) return refuse(binding.error());
  shape.binding = std::make_shared<const Binding>(*std::move(binding));
  return {};
}

std::string left_out_text(const std::string& surface, const std::string& left_out) {
  if (left_out.empty()) return {};
  return fmt::format("the mesh of \"{}\" has all of its file but {}", surface, left_out);
}

std::optional<SceneNote> note_on(const Surface& surface, const std::string& note,
                                 const SceneOrigin& origin) {
  if (note.empty()) return {};
  ScenePlace place = origin.place_of(surface.name, "file");
  return SceneNote{place, place.told(note), std::move(place.file)};
}

}  // namespace pliant
