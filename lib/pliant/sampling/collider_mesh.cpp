#include "pliant/sampling/collider_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/hash.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/sampling/memory.hpp"
#include "pliant/sampling/read_files.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/checks/check.hpp"

namespace pliant {
namespace {

// The poses of a moving mesh that a run keeps: of the last frames; of the last steps of a surface.
constexpr std::size_t most_poses = 3, poses_of_surface = 10;

// Reads the mesh of one collider, and tells problems at its line.
class ColliderMeshReader {
 public:
  ColliderMeshReader(const Collider& collider, const Scene& scene, const RunContext& context,
                     MemoryShare& memory)
      : name_(collider.name),
        title_(fmt::format("collider \"{}\"", collider.name)),
        closed_(std::get<ClosedMesh>(collider.shape)),
        origin_(scene.origin),
        context_(context),
        memory_(memory) {}

  Result<Mesh> read() {
    if (closed_.made) return copy(*closed_.made);
    const MeshFile& file = closed_.mesh;
    const auto opened = OpenFile::open(file.path, origin_.root);
    if (!opened) return fail(at_scene(opened.error()));
    std::size_t ahead = bytes_to_read(*opened);
    if (auto taken = take(ahead); !taken) return fail(taken.error());
    ahead += bytes_to_read_references(*opened, file.root, context_.should_stop);
    if (auto taken = take(ahead); !taken) return fail(taken.error());
    auto mesh = read_mesh(*opened, file.object, file.uv_set, file.root, context_, {});
    if (!mesh) return fail(at_scene(mesh.error()));
    return mesh;
  }

  Result<TriangleSurface> make_triangles(const Mesh& mesh) {
    // A corner while nodes, edges and triangles are found; a vertex in the tree for welding.
    constexpr std::size_t of_corner = 140, of_vertex = 100;
    const std::size_t bytes = bytes_of(mesh) + of_corner * mesh.corner_vertices.size() +
                              of_vertex * static_cast<std::size_t>(mesh.vertex_count());
    if (auto taken = take(bytes); !taken) return fail(taken.error());
    auto surface = make_surface(mesh, {}, context_.should_stop);
    if (!surface) return fail(about_mesh(surface.error()));
    return surface;
  }

  Error open(const Mesh& mesh, const TriangleSurface& surface, const OpenEdge& edge) const {
    const auto vertex = [&](int node) {
      const auto found = std::ranges::find(surface.vertex_nodes, node);
      return mesh.number_of(static_cast<int>(found - surface.vertex_nodes.begin()));
    };
    const std::string sides = edge.sides == 1 ? "has one face"
                              : edge.sides == 2
                                  ? "has two faces that run through it in the same direction"
                                  : fmt::format("has {} faces", edge.sides);
    return about_mesh({.code = ErrorCode::InvalidInput,
                       .message = fmt::format(
                           "the edge between vertices {} and {} {}, but a collider is closed: each "
                           "edge has two faces, which run through it in opposite directions",
                           vertex(edge.from), vertex(edge.to), sides)});
  }

  Result<void> take(std::size_t bytes) {
    if (memory_.try_resize(bytes)) return {};
    return fail(origin_.located({.code = ErrorCode::OutOfMemory,
                                 .message = fmt::format("{} {}", title_, memory_.complaint(bytes))},
                                origin_.at(name_)));
  }

  Error about_mesh(Error error) const {
    if (error.code == ErrorCode::Interrupted) return error;
    const std::string mesh = closed_.made ? "" : ", mesh " + closed_.mesh.path;
    error.message = fmt::format("{}{}: {}", title_, mesh, error.message);
    return at_scene(std::move(error));
  }

  const std::string& title() const { return title_; }

 private:
  Result<Mesh> copy(const Mesh& made) {
    if (auto taken = take(bytes_of(made)); !taken) return fail(taken.error());
    if (auto checked = check_mesh(made, context_.should_stop); !checked)
      return fail(about_mesh(checked.error()));
    return made;
  }

  // An error in the file's contents already names the file.
  Error at_scene(Error error) const {
    if (error.code == ErrorCode::Unreadable)
      return origin_.located({.code = error.code, .message = unreadable_mesh(error, title_)},
                             origin_.at(name_, "file"));
    if (!error.file.empty() || error.code == ErrorCode::Interrupted) return error;
    return origin_.located(std::move(error), origin_.at(name_, "file"));
  }

  std::string name_, title_;
  const ClosedMesh& closed_;
  const SceneOrigin& origin_;
  const RunContext& context_;
  MemoryShare& memory_;
};

// All that the mesh of a collider is made from, besides its shape and files.
struct MeshValues {
  std::string name, root;
  bool is_scaled;  // by a channel that is animated
  std::size_t surfaces;
  double fps;
  int start, first, last;  // of the cache: only with one

  friend bool operator==(const MeshValues&, const MeshValues&) = default;
};

MeshValues values_of(const Collider& collider, const Scene& scene, std::size_t surfaces) {
  const FrameSpan used = sampled_frames(scene);
  const bool moves = !std::get<ClosedMesh>(collider.shape).cache.is_empty();
  return {.name = collider.name,
          .root = scene.origin.root,
          .is_scaled = collider.transform.scale.is_animated(),
          .surfaces = surfaces,
          .fps = moves ? scene.fps : 0,
          .start = moves ? scene.start : 0,
          .first = moves ? used.first : 0,
          .last = moves ? used.last : 0};
}

struct ColliderMeshItem final : Shelf::Item {
  MeshValues values = {};
  ClosedMesh closed = {};
  ReadFiles files;
  std::shared_ptr<const ColliderMesh> mesh;
  std::size_t bytes = 0;
};

std::size_t count_surfaces(const Collider& collider, const Scene& scene) {
  return static_cast<std::size_t>(
      std::ranges::count_if(scene.surfaces, [&](const Surface& surface) {
        return !surface.is_driven() &&
               (collider.targets.empty() ||
                std::ranges::find(collider.targets, surface.name) != collider.targets.end());
      }));
}

// `Mesh::corner_normals` of triangles whose edges are hard where they turn by more than 40 degrees.
std::vector<int> creased_normals(const PosedMesh& posed) {
  constexpr double crease_cosine = 0.766;
  const std::vector<SolidMesh::Corners>& triangles = posed.mesh().triangles();
  const auto area_vector = [&](const SolidMesh::Corners& corners) {
    const auto way_to = [&](int corner) -> Vector3d {
      return (posed.points().row(corners[corner]) - posed.points().row(corners[0])).transpose();
    };
    return cross_of(way_to(1), way_to(2));
  };
  std::vector<int> normals(3 * triangles.size());  // of a corner one that shares its normal
  std::iota(normals.begin(), normals.end(), 0);
  const auto first_of = [&](int corner) {
    while (normals[corner] != corner) corner = normals[corner] = normals[normals[corner]];
    return corner;
  };
  bool is_smooth = true;
  for (int k = 0; k < static_cast<int>(triangles.size()); ++k) {
    const Vector3d one = area_vector(triangles[k]);
    for (int corner = 0; corner < 3; ++corner) {
      const int other_side = posed.mesh().neighbour(k, corner);
      if (other_side < k) continue;
      const SolidMesh::Corners& others = triangles[other_side];
      const Vector3d other = area_vector(others);
      const bool is_hard = one.dot(other) < crease_cosine * one.norm() * other.norm();
      is_smooth = is_smooth && !is_hard;
      for (const int end : {corner, (corner + 1) % 3}) {
        const auto same = std::ranges::find(others, triangles[k][end]);
        const int shared = 3 * other_side + static_cast<int>(same - others.begin());
        // The lowest is the first of all that share.
        const auto [low, high] = std::minmax({first_of(3 * k + end), first_of(shared)});
        if (!is_hard) normals[high] = low;
      }
    }
  }
  if (is_smooth) return {};
  int count = 0;
  for (int corner = 0; corner < static_cast<int>(normals.size()); ++corner)
    normals[corner] = normals[corner] == corner ? count++ : normals[normals[corner]];
  return normals;
}

}  // namespace

Result<std::shared_ptr<const ColliderMesh>> find_collider_mesh(const Collider& collider,
                                                               const Scene& scene,
                                                               const RunContext& context,
                                                               MemoryShare& memory) {
  const std::size_t surfaces = count_surfaces(collider, scene);
  if (!context.shelf) return ColliderMesh::make(collider, scene, surfaces, context, memory);
  const MeshValues values = values_of(collider, scene, surfaces);
  const auto& closed = std::get<ClosedMesh>(collider.shape);
  const Hash key = hash_of(collider.name);
  const auto found = context.shelf->find<ColliderMeshItem>(key, [&](const ColliderMeshItem& one) {
    return one.values == values && one.closed == closed && one.files.are_unchanged();
  });
  // Making it tells what does not fit.
  if (found && memory.try_resize(found->bytes)) return found->mesh;
  ReadFiles files(inputs_of_collider(collider, scene.origin, context.should_stop));
  auto made = ColliderMesh::make(collider, scene, surfaces, context, memory);
  if (made && !found) {
    auto item = std::make_shared<ColliderMeshItem>();
    item->values = values;
    item->closed = closed;
    item->files = std::move(files);
    item->mesh = *made;
    item->bytes = memory.bytes();
    const std::size_t own = closed.made ? bytes_of(*closed.made) : 0;
    context.shelf->keep(key, std::move(item), memory.bytes() + own);
  }
  return made;
}

Result<std::shared_ptr<const ColliderMesh>> ColliderMesh::make(const Collider& collider,
                                                               const Scene& scene,
                                                               std::size_t surfaces,
                                                               const RunContext& context,
                                                               MemoryShare& memory) {
  ColliderMeshReader reader(collider, scene, context, memory);
  auto mesh = reader.read();
  if (!mesh) return fail(mesh.error());
  auto surface = reader.make_triangles(*mesh);
  if (!surface) return fail(surface.error());
  auto made = std::shared_ptr<ColliderMesh>(new ColliderMesh());
  StopPoll poll(context.should_stop);
  made->faces_ = FaceTriangles(*surface, poll);
  const Field points = made->faces_.with_centres(surface->rest, poll);
  if (poll.after(0)) return interrupted();
  if (const auto edge = SolidMesh::open_edge(made->faces_.triangles))
    return fail(reader.open(*mesh, *surface, *edge));

  const ShapeCache& cache = std::get<ClosedMesh>(collider.shape).cache;
  const bool moves = !cache.is_empty() || collider.transform.scale.is_animated();
  const std::size_t poses = 2 + (moves ? most_poses + poses_of_surface * surfaces : 0);
  const std::size_t kept = SolidMesh::bytes(made->faces_.triangles.size(),
                                            static_cast<std::size_t>(points.rows()), poses);
  if (auto taken = reader.take(std::max(kept, memory.bytes())); !taken) return fail(taken.error());
  auto solid = SolidMesh::make(made->faces_.triangles, points, context.should_stop);
  if (!solid) return fail(solid.error());
  made->at_rest_ = std::make_shared<const PosedMesh>(*std::move(solid), points);
  RestShape shape{.name = collider.name,
                  .mesh = {},
                  .vertex_nodes = std::move(surface->vertex_nodes),
                  .rest = std::move(surface->rest)};
  shape.mesh.first_index = mesh->first_index;
  *mesh = {};
  if (auto taken = reader.take(kept); !taken) return fail(taken.error());
  if (cache.is_empty()) return std::shared_ptr<const ColliderMesh>(std::move(made));
  const FrameSpan used = sampled_frames(scene);
  auto moved = animate(shape, memory,
                       {.title = reader.title(),
                        .name = collider.name,
                        .cache = cache,
                        .used = {used.first, used.last + 1}},
                       scene, context);
  if (!moved) return fail(moved.error());
  made->animation_ = std::move(shape.animation);
  return std::shared_ptr<const ColliderMesh>(std::move(made));
}

Mesh ColliderMesh::drawn() const {
  Mesh mesh;
  mesh.positions = at_rest_->points();
  for (const SolidMesh::Corners& corners : at_rest_->mesh().triangles()) {
    mesh.face_sizes.push_back(3);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  }
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  mesh.corner_normals = creased_normals(*at_rest_);
  return mesh;
}

Result<std::shared_ptr<const PosedMesh>> ColliderMesh::at(int frame) const {
  if (!animation_) return at_rest_;
  const auto nodes = animation_->nodes_at(frame);
  if (!nodes) return fail(nodes.error());
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(kept_, *nodes, &Kept::nodes);
  if (found != kept_.end()) {
    std::rotate(kept_.begin(), found, found + 1);
    return kept_.front().posed;
  }
  StopPoll never({});
  auto posed = std::make_shared<const PosedMesh>(at_rest_->shared_mesh(),
                                                 faces_.with_centres(**nodes, never));
  if (kept_.size() == most_poses) kept_.pop_back();
  kept_.insert(kept_.begin(), {*nodes, posed});
  return posed;
}

}  // namespace pliant
