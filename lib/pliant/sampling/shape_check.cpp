#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/checks/channel_check.hpp"

namespace pliant {
namespace {

// The first node of a piece without a border that holds it; none: all are held.
std::optional<int> loose_node(const TriangleSurface& surface, bool border_holds) {
  const std::vector<int> pieces = pieces_of(surface);
  std::vector<bool> is_held(pieces.size());  // by piece
  for (int face = 0; face < surface.face_count() && border_holds; ++face) {
    const bool has_border = std::ranges::any_of(
        surface.edges_of(face), [&](int edge) { return surface.edge_sides[edge] == 1; });
    if (has_border) is_held[pieces[surface.nodes_of(face).front()]] = true;
  }
  const auto loose =
      std::ranges::find_if(pieces, [&](int piece) { return piece >= 0 && !is_held[piece]; });
  if (loose == pieces.end()) return {};
  return static_cast<int>(loose - pieces.begin());
}

// SPEC 9, "Whole-body motion".
std::optional<Error> check_is_held(const Scene& scene, const Surface& surface,
                                   const RestShape& shape) {
  if (surface.solver.region != SolvedRegion::All) return {};
  const auto found = static_frame_of(scene, surface, sampled_frames(scene, surface));
  if (!found) return {};
  if (shape.grid) {
    const auto& [is_closed_u, is_closed_v] =
        std::pair(shape.grid->is_closed_u, shape.grid->is_closed_v);
    if (surface.solver.edges.hold(is_closed_u, is_closed_v)) return {};
    const bool has_edges = !is_closed_u || !is_closed_v;
    return not_held(scene, surface, *found,
                    has_edges ? "" : "a surface that is closed along u and v");
  }
  const auto node = loose_node(*shape.surface, surface.reading.border != Border::Free);
  if (!node) return {};
  const auto vertex = std::ranges::find(shape.surface->vertex_nodes, *node);
  const auto index = static_cast<int>(vertex - shape.surface->vertex_nodes.begin());
  return not_held(scene, surface, *found,
                  fmt::format("the piece with vertex {}", index + shape.mesh.first_index));
}

}  // namespace

std::vector<Error> check_against_shape(const Scene& scene, const Surface& surface,
                                       const RestShape& shape) {
  std::vector<Error> errors = check_maps(scene, surface, shape);
  if (auto loose = check_is_held(scene, surface, shape)) errors.push_back(*std::move(loose));
  return errors;
}

}  // namespace pliant
