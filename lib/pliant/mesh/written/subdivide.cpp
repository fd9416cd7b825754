#include "pliant/mesh/written/subdivide.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "pliant/mesh/written/opensubdiv_refiner.hpp"

// The only file that depends on PLIANT_WITH_OPENSUBDIV; tests/without_opensubdiv replaces it.

namespace pliant {
namespace {

// The most neighbours of one kind that OpenSubdiv counts: Vtr::internal::VALENCE_LIMIT.
constexpr std::int64_t most_neighbours = 65535;

// The edges at each node.
std::vector<int> edge_counts(const TriangleSurface& surface) {
  std::vector<int> counts(static_cast<std::size_t>(surface.node_count()), 0);
  std::vector<bool> is_counted(static_cast<std::size_t>(surface.edge_count()), false);
  for (int face = 0; face < surface.face_count(); ++face) {
    const auto nodes = surface.nodes_of(face), edges = surface.edges_of(face);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (is_counted[edges[k]]) continue;
      is_counted[edges[k]] = true;
      ++counts[nodes[k]];
      ++counts[nodes[(k + 1) % nodes.size()]];
    }
  }
  return counts;
}

// The number of a face of the surface in its file.
std::size_t number_of_face(const Mesh& mesh, const TriangleSurface& surface, int face) {
  std::size_t found = 0;
  for (int end = mesh.face_sizes[0]; end <= surface.mesh_corners[surface.face_starts[face]];
       end += mesh.face_sizes[++found]) {
  }
  return found + mesh.first_index;
}

Result<void> check_faces(const Mesh& mesh, const TriangleSurface& surface,
                         SubdivisionScheme scheme) {
  for (int face = 0; face < surface.face_count(); ++face) {
    const int size = surface.size_of(face);
    if (scheme == SubdivisionScheme::Loop && size != 3) {
      return invalid(
          fmt::format("face {} has {} corners, but the scheme \"loop\" takes triangles "
                      "only; \"catmullClark\" takes all faces",
                      number_of_face(mesh, surface, face), size));
    }
    if (size > most_neighbours) {
      return invalid(fmt::format("face {} has {} corners, but {} is the most in a cage",
                                 number_of_face(mesh, surface, face), size, most_neighbours));
    }
  }
  return {};
}

Result<void> check_nodes(const Mesh& mesh, const TriangleSurface& surface,
                         const std::vector<int>& edges_at) {
  std::int64_t most = 0;
  int where = 0;
  for (int node = 0; node < surface.node_count(); ++node) {
    const auto faces = static_cast<std::int64_t>(surface.faces_of(node).size());
    const std::int64_t neighbours = std::max(faces, std::int64_t{edges_at[node]});
    if (neighbours > most) most = neighbours, where = node;
  }
  // No edge has more faces than its ends.
  if (most <= most_neighbours) return {};
  const auto vertex = std::ranges::find(surface.vertex_nodes, where);
  return invalid(fmt::format("vertex {} has {} faces or edges, but {} is the most in a cage",
                             mesh.number_of(int(vertex - surface.vertex_nodes.begin())), most,
                             most_neighbours));
}

// The vertices of a refined face that lie on none of its edges, and the faces that it becomes.
WrittenSize within_face(std::int64_t corners, const Subdivision& subdivision) {
  const std::int64_t parts = std::int64_t{1} << subdivision.levels;  // of an edge
  if (subdivision.levels == 0) return {.vertices = 0, .faces = 1};
  if (subdivision.scheme == SubdivisionScheme::Loop)
    return {.vertices = (parts - 1) * (parts - 2) / 2, .faces = parts * parts};
  // A quad at each corner, divided by half the parts; they share the face's centre.
  const std::int64_t half = parts / 2;
  return {.vertices = corners * (half - 1) * half + 1, .faces = corners * half * half};
}

WrittenSize size_of(const TriangleSurface& surface, const Subdivision& subdivision,
                    const std::vector<int>& edges_at) {
  // A vertex of a face, at any level, depends on the nodes of the faces around that face, at most.
  // The faces around a node have it, the other ends of its edges, and their remaining corners.
  std::vector<std::int64_t> nodes_around(static_cast<std::size_t>(surface.node_count()));
  for (int node = 0; node < surface.node_count(); ++node) {
    nodes_around[node] = 1 + edges_at[node];
    for (const int face : surface.faces_of(node)) nodes_around[node] += surface.size_of(face) - 3;
  }
  std::vector<bool> is_edge_counted(static_cast<std::size_t>(surface.edge_count()), false);
  std::vector<bool> is_node_counted(static_cast<std::size_t>(surface.node_count()), false);
  WrittenSize size;
  for (int face = 0; face < surface.face_count(); ++face) {
    const std::int64_t corners = surface.size_of(face);
    WrittenSize here = within_face(corners, subdivision);
    std::int64_t around = corners;
    for (const int node : surface.nodes_of(face)) {
      around += nodes_around[node] - corners;
      if (!is_node_counted[node]) here.vertices += 1;
      is_node_counted[node] = true;
    }
    for (const int edge : surface.edges_of(face)) {
      if (!is_edge_counted[edge]) here.vertices += (1 << subdivision.levels) - 1;
      is_edge_counted[edge] = true;
    }
    around = subdivision.levels == 0 ? 1 : std::min(around, std::int64_t{surface.node_count()});
    size.vertices += here.vertices;
    size.faces += here.faces;
    // Far beyond the limit, counting could overflow.
    size.weights = std::min(size.weights + here.vertices * around, 10 * WrittenSize::most_weights);
  }
  return size;
}

}  // namespace

bool has_opensubdiv() {
#ifdef PLIANT_WITH_OPENSUBDIV
  return true;
#else
  return false;
#endif
}

Result<WrittenSize> check_subdivision(const Mesh& mesh, const TriangleSurface& surface,
                                      const Subdivision& subdivision) {
  if (!has_opensubdiv()) {
    return invalid(
        "this build has no OpenSubdiv; -DPLIANT_WITH_OPENSUBDIV=ON builds with it, and Debian has "
        "it as libosd-dev");
  }
  if (subdivision.levels < 0 || subdivision.levels > Subdivision::most_levels) {
    return invalid(fmt::format("levels is {}, but must be from 0 to {}", subdivision.levels,
                               Subdivision::most_levels));
  }
  if (auto checked = check_faces(mesh, surface, subdivision.scheme); !checked)
    return fail(checked.error());
  const std::vector<int> edges_at = edge_counts(surface);
  if (auto checked = check_nodes(mesh, surface, edges_at); !checked) return fail(checked.error());
  const WrittenSize size = size_of(surface, subdivision, edges_at);
  if (size.vertices > WrittenSize::most_vertices || size.faces > WrittenSize::most_faces) {
    return invalid(
        fmt::format("levels is {}: the cage would become {} vertices and {} faces, but "
                    "{} and {} are the most",
                    subdivision.levels, size.vertices, size.faces, WrittenSize::most_vertices,
                    WrittenSize::most_faces));
  }
  if (size.weights > WrittenSize::most_weights) {
    return invalid(
        fmt::format("levels is {}: the {} vertices of the cage would depend on too many "
                    "of its nodes, since some have many faces",
                    subdivision.levels, size.vertices));
  }
  return size;
}

Result<SubdividedMesh> subdivide(const Mesh& mesh, const TriangleSurface& surface,
                                 const Subdivision& subdivision,
                                 [[maybe_unused]] const StopRequest& should_stop) {
  if (auto checked = check_subdivision(mesh, surface, subdivision); !checked)
    return fail(checked.error());
#ifdef PLIANT_WITH_OPENSUBDIV
  return refined_by_opensubdiv(mesh, surface, subdivision, should_stop);
#else
  return {};
#endif
}

}  // namespace pliant
