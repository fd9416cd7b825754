#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

class AnimatedShape;
class Binding;
class Body;
class Carriers;
class ColliderMesh;
class PointTree;
struct NodeFactors;
struct NodeFaces;
struct TriangleSurface;
struct VertexWeights;

/// A surface before any force acts on it: its mesh, and the nodes that are simulated.
struct RestShape {
  std::string name;  ///< of the surface
  Mesh mesh;         ///< as it is written
  /// #vertices: the node of each; -1: it never moves, is driven, or is a weighted sum of nodes
  std::vector<int> vertex_nodes;
  Field rest;  ///< #nodes x 3: rest positions, object space [length]; none: it is driven

  /// The grid of the nodes; none: they are a surface of triangles.
  std::optional<Grid> grid = {};
  std::shared_ptr<const TriangleSurface> surface = {};  ///< null: a grid
  std::shared_ptr<const PointTree> tree = {};           ///< of the nodes of `surface`
  std::string note = {};  ///< a remark for the author on how the mesh was read; may be empty

  /// The faces of the nodes of a grid; null: no force uses their normals, or it is a surface.
  std::shared_ptr<const NodeFaces> faces = {};

  /// How what follows a surface is carried; null: nothing does. The same for all of a scene.
  std::shared_ptr<const Carriers> carriers = {};

  /// The meshes of the scene's colliders, one for each; null: there are no colliders. The same for
  /// all of a scene.
  std::shared_ptr<const std::vector<std::shared_ptr<const ColliderMesh>>> collider_meshes = {};

  /// The factors of the material's maps at the nodes; null: there is no map.
  std::shared_ptr<const NodeFactors> factors = {};

  /// 1 for each node that a <hold> holds (#nodes); null: none does.
  std::shared_ptr<const NodeMarks> held = {};

  /// Vertices of a net or a cage as weighted sums of nodes; null: each moves as its node.
  std::shared_ptr<const VertexWeights> weights = {};
  std::shared_ptr<const TriangleSurface> cage = {};  ///< the triangles of a cage that is a grid

  /// How its rest positions move; null: they do not. Then `mesh` and `rest` give faces, areas and
  /// directions only, and the state of its body holds displacements.
  std::shared_ptr<const AnimatedShape> animation = {};

  /// How a driven surface follows its driver; null: it is not driven, or not bound yet.
  std::shared_ptr<const Binding> binding = {};

  /// The vertices for positions of the nodes (#nodes x 3 -> #vertices x 3), in the memory of
  /// `reuse`. Vertices of one node keep their offsets from each other.
  Field to_vertices(const Field& nodes, Field reuse = {}) const;

  /// The same. Errors: Interrupted.
  Result<Field> to_vertices(const Field& nodes, Field reuse, const StopRequest& should_stop) const;

  /// The node of each vertex of the mesh that the scene names, of a subdivision that of its cage:
  /// the vertices of a cache. -1: it never moves by itself.
  const std::vector<int>& cache_nodes() const;
};

/// What a mesh that is read as a surface of triangles consists of.
struct SurfaceSummary {
  int nodes = 0;
  int faces = 0;                        ///< that take part
  int pieces = 0;                       ///< faces joined by shared corners
  int border_edges = 0;                 ///< edges of one face
  std::array<double, 2> unit = {1, 1};  ///< the lengths that count as 1 along u and v [length/uv]
};

/// Of a shape that is a surface; null: it is a grid, or driven.
std::optional<SurfaceSummary> summary_of(const RestShape& shape);

/// The samples of a cache that animates a shape.
struct CacheSummary {
  int samples = 0;
  double first = 0;  ///< [frame]
  double last = 0;   ///< [frame]
};

/// Null: the shape is not animated.
std::optional<CacheSummary> cache_summary_of(const RestShape& shape);

/// What a map makes of its channel.
struct MapSummary {
  MapChannel channel = MapChannel::Density;
  double least = 1;  ///< the smallest factor at a node [1]
  double most = 1;   ///< the largest
};

/// Those of a shape's maps, in the order of the channels.
std::vector<MapSummary> map_summaries_of(const RestShape& shape);

/// The body of a rest shape, at rest; that of a driven surface has no nodes. `solver` and `context`
/// are those of its plates. Errors: Interrupted.
Result<std::unique_ptr<Body>> make_body(const RestShape& shape, const BodySettings& settings,
                                        SolverChoice solver = SolverChoice::Auto,
                                        RunContext context = {});

/// A rest shape with the memory that it and its body need, reserved from the run's.
struct ReservedShape {
  RestShape shape;
  MemoryShare memory;
};

/// Makes or reads a surface's mesh, and finds its grid or reads it as a surface of triangles; makes
/// the vertices of a net, and refines a cage. Of a driven surface it makes the mesh only. Reserves
/// memory before a sheet or a net is made, after a file is read, and before a cage is refined.
/// Errors: those of `read_mesh` and `check_mesh`; those of `find_grid`, `make_surface` and
/// `subdivide`, with the surface's line in the scene; what a surface cannot do; OutOfMemory;
/// Interrupted.
Result<ReservedShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context = {});

/// The triangles of a surface's nodes, be they a grid: those that a driven surface follows. Errors:
/// those of `surface_of_nodes`.
Result<std::shared_ptr<const TriangleSurface>> triangles_of(const Surface& surface,
                                                            const RestShape& shape,
                                                            const StopRequest& should_stop = {});

/// Finds the faces of a grid's nodes, for forces along their normals, and reserves the memory for
/// them. Errors: OutOfMemory; Interrupted.
Result<void> find_faces(ReservedShape& made, const Surface& surface, const Scene& scene,
                        const StopRequest& should_stop = {});

/// Binds a driven surface to its driver, as both are placed at the scene's start, and reserves the
/// memory for it. Errors: the driver's triangles have no area; OutOfMemory; Interrupted.
Result<void> bind_to_driver(ReservedShape& driven, const Surface& own, const RestShape& driver,
                            const Surface& driving, const Scene& scene,
                            const StopRequest& should_stop = {});

/// What an author is told of a mesh with `Mesh::left_out`; empty: nothing.
std::string left_out_text(const std::string& surface, const std::string& left_out);

/// The memory that a rest shape would reserve, and the notes on it, which may be empty.
struct CheckedShape {
  MemoryShare memory;
  std::string note = {};
  std::string left_out = {};  ///< `left_out_text`
};

/// Checks that `make_rest_shape` would succeed, without making sheets.
Result<CheckedShape> check_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context);

/// Checks what a scene asks of a shape, before any frame: what `check_maps` does, and that
/// something holds a whole surface in its static frames. Requires: `check_channels` accepts the
/// scene.
std::vector<Error> check_against_shape(const Scene& scene, const Surface& surface,
                                       const RestShape& shape);

/// The pieces of a surface that nothing holds if all of it is solved: by node, counted from 0; -1:
/// it is held, or never moves.
std::vector<int> loose_pieces_of(const Surface& surface, const RestShape& shape);

/// The note on a surface's shape as one of the scene; none if it is empty.
std::optional<SceneNote> note_on(const Surface& surface, const std::string& note,
                                 const SceneOrigin& origin);

}  // namespace pliant
