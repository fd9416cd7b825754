#include "pliant/feedback/contact_summary.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/contact/collider.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/sampling/targets.hpp"

namespace pliant {
namespace {

template <class Visit>
void for_each_edge(const RestShape& shape, const Visit& visit) {
  if (shape.grid) {
    const Grid& grid = *shape.grid;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const int right = i + 1 < grid.columns ? i + 1 : 0, below = j + 1 < grid.rows ? j + 1 : 0;
        if (right > 0 || grid.is_closed_u) visit(grid.node(i, j), grid.node(right, j));
        if (below > 0 || grid.is_closed_v) visit(grid.node(i, j), grid.node(i, below));
      }
    }
  } else if (shape.surface) {
    const TriangleSurface& surface = *shape.surface;
    for (int face = 0; face < surface.face_count(); ++face) {
      const std::span<const int> nodes = surface.nodes_of(face);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        visit(nodes[k], nodes[k + 1 < nodes.size() ? k + 1 : 0]);
    }
  }
}

}  // namespace

NodeSpacing spacing_of(const Scene& scene, const Surface& surface, const RestShape& shape) {
  const Field world = to_world(surface.transform.at(scene.start), shape.rest);
  NodeSpacing spacing;
  double sum = 0, count = 0;
  for_each_edge(shape, [&](int a, int b) {
    const double length = length_of(world.row(a) - world.row(b));
    sum += length;
    ++count;
    spacing.largest = std::max(spacing.largest, length);
  });
  if (count > 0) spacing.mean = sum / count;
  return spacing;
}

std::vector<ContactSummary> contact_summaries(const Scene& scene,
                                              std::span<const RestShape> shapes) {
  std::vector<ContactSummary> summaries;
  const std::vector<SurfaceTargets> targets = targets_of(scene);
  for (std::size_t c = 0; c < scene.colliders.size(); ++c) {
    const std::optional<Solid> solid = solid_at(scene.colliders[c], scene.start);
    const double radius = solid ? least_radius(*solid) : 0;
    for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
      if (!std::ranges::binary_search(targets[k].colliders, c)) continue;
      ContactSummary& summary = summaries.emplace_back();
      summary.collider = c;
      summary.surface = k;
      if (radius == 0) continue;
      const double spacing = spacing_of(scene, scene.surfaces[k], shapes[k]).largest;
      summary.hiding_offset = spacing * spacing / (8 * radius);
    }
  }
  return summaries;
}

void add_contacts(ContactSummary& summary, int frame, const std::vector<ContactFacts>& contacts) {
  const auto facts =
      std::ranges::find(contacts, static_cast<int>(summary.collider), &ContactFacts::collider);
  if (facts == contacts.end()) return;
  if (facts->touched && !summary.first_touch) summary.first_touch = frame;
  const int nodes = static_cast<int>(facts->nodes.size());
  if (nodes > summary.most_nodes) {
    summary.most_nodes = nodes;
    summary.most_nodes_frame = frame;
  }
  const double force = length_of(facts->force);
  if (force > summary.largest_force) {
    summary.largest_force = force;
    summary.largest_force_frame = frame;
  }
}

}  // namespace pliant
