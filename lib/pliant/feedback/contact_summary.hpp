#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// How far the nodes of a surface are apart, along the edges between them, world. [length]
struct NodeSpacing {
  double mean = 0;
  double largest = 0;
};

/// At rest, as the scene begins. Zeros: it is driven.
NodeSpacing spacing_of(const Scene& scene, const Surface& surface, const RestShape& shape);

/// What a collider does to a surface over the frames that were played.
struct ContactSummary {
  std::size_t collider = 0, surface = 0;  ///< indices in the scene
  std::optional<int> first_touch = {};    ///< the first frame at which it has touched
  int most_nodes = 0, most_nodes_frame = 0;
  double largest_force = 0;  ///< on all nodes; on triangles without the area of a node
  int largest_force_frame = 0;
  /// The offset at which the faces between nodes do not enter it either: the square of the largest
  /// spacing by 8 times the least radius. Null: it has sharp edges, or is a mesh. [length]
  std::optional<double> hiding_offset = {};
};

/// One for each collider and surface that it targets, in the order of the scene, before any frame.
std::vector<ContactSummary> contact_summaries(const Scene& scene,
                                              std::span<const RestShape> shapes);

/// Adds the contacts of the surface's state at a frame.
void add_contacts(ContactSummary& summary, int frame, const std::vector<ContactFacts>& contacts);

}  // namespace pliant
