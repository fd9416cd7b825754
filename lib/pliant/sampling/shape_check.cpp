#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/body/triangle_body.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/plate/vibration.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/checks/channel_check.hpp"

namespace pliant {
namespace {

// By node the piece that neither a border holds nor held nodes or a goal do; -1: it is held, or in
// no piece. `goals`: the factors of the nodes; null: there is no goal. `held` null: no node is.
std::vector<int> loose_pieces(const TriangleSurface& surface, bool border_holds,
                              const std::vector<double>* goals, const NodeMarks* held) {
  std::vector<int> pieces = pieces_of(surface);
  std::vector<bool> is_held(pieces.size());  // by piece
  for (int face = 0; face < surface.face_count() && border_holds; ++face) {
    const bool has_border = std::ranges::any_of(
        surface.edges_of(face), [&](int edge) { return surface.edge_sides[edge] == 1; });
    if (has_border) is_held[pieces[surface.nodes_of(face).front()]] = true;
  }
  std::vector<std::vector<int>> pulled(goals || held ? pieces.size() : 0);  // by piece
  for (int node = 0; !pulled.empty() && node < surface.node_count(); ++node) {
    const bool is_pulled = (goals && factor_at(*goals, node) > 0) || (held && (*held)[node] != 0);
    if (pieces[node] >= 0 && is_pulled) pulled[pieces[node]].push_back(node);
  }
  for (std::size_t piece = 0; piece < pulled.size(); ++piece)
    is_held[piece] = is_held[piece] || are_beyond_line(surface.rest, pulled[piece]);
  for (int& piece : pieces)
    if (piece >= 0 && is_held[piece]) piece = -1;
  return pieces;
}

// That of a whole grid, of which nodes may be held; null: none is.
Outline outline_of(const Grid& grid, const Edges& edges, const NodeMarks* held) {
  Outline whole(grid, edges);
  if (!held) return whole;
  InteriorMask mask(held->size(), 0);
  whole.for_each_run([&](const Outline::Run& run) {
    for (int node = grid.node(run.i0, run.j); node <= grid.node(run.i1, run.j); ++node)
      mask[static_cast<std::size_t>(node)] = (*held)[static_cast<std::size_t>(node)] == 0 ? 1 : 0;
  });
  return {grid, edges, std::move(mask)};
}

// SPEC 9, "Whole-body motion".
std::optional<Error> check_is_held(const Scene& scene, const Surface& surface,
                                   const RestShape& shape) {
  if (surface.solver.region != SolvedRegion::All) return {};
  const FrameSpan frames = sampled_frames(scene, surface);
  auto found = static_frame_of(scene, surface, frames);
  // A goal everywhere holds all.
  const bool has_map = shape.factors && !shape.factors->goal.empty();
  const bool is_by_goal = !found && has_map;
  if (is_by_goal) found = static_frame_of(scene, surface, frames, true);
  if (!found) return {};
  if (shape.grid) {
    PlateSystem system{outline_of(*shape.grid, surface.solver.edges, shape.held.get()), {}};
    if (is_by_goal) system.goal = surface.material.goal.at(found->frame)[0];
    system.factors = shape.factors;
    if (is_held(system)) return {};
    const bool has_edges = !shape.grid->is_closed_u || !shape.grid->is_closed_v;
    return not_held(scene, surface, *found,
                    has_edges ? "" : "a surface that is closed along u and v");
  }
  const std::vector<int> pieces =
      loose_pieces(*shape.surface, surface.reading.border != Border::Free,
                   is_by_goal ? &shape.factors->goal : nullptr, shape.held.get());
  const auto loose = std::ranges::find_if(pieces, [](int piece) { return piece >= 0; });
  if (loose == pieces.end()) return {};
  const auto node = static_cast<int>(loose - pieces.begin());
  const auto vertex = std::ranges::find(shape.surface->vertex_nodes, node);
  const auto index = static_cast<int>(vertex - shape.surface->vertex_nodes.begin());
  return not_held(scene, surface, *found,
                  fmt::format("the piece with vertex {}", index + shape.mesh.first_index));
}

}  // namespace

std::vector<int> loose_pieces_of(const Surface& surface, const RestShape& shape) {
  const Channel<1>& goal = surface.material.goal;
  const bool has_goal = goal.is_animated() || goal.at(0)[0] > 0;
  const std::vector<double>* const goals =
      has_goal && shape.factors ? &shape.factors->goal : nullptr;
  if (has_goal && (!goals || goals->empty())) return {};  // it is everywhere
  if (shape.surface) {
    return loose_pieces(*shape.surface, surface.reading.border != Border::Free, goals,
                        shape.held.get());
  }
  if (!shape.grid) return {};
  PlateSystem system{outline_of(*shape.grid, surface.solver.edges, shape.held.get()), {}};
  system.goal = has_goal ? 1 : 0;
  system.factors = shape.factors;
  return std::vector<int>(static_cast<std::size_t>(shape.grid->node_count()),
                          is_held(system) ? -1 : 0);
}

std::vector<Error> check_against_shape(const Scene& scene, const Surface& surface,
                                       const RestShape& shape) {
  std::vector<Error> errors = check_maps(scene, surface, shape);
  if (auto loose = check_is_held(scene, surface, shape)) errors.push_back(*std::move(loose));
  return errors;
}

}  // namespace pliant
