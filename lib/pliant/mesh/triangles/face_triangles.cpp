#include "pliant/mesh/triangles/face_triangles.hpp"

#include <cstddef>

namespace pliant {

FaceTriangles::FaceTriangles(const TriangleSurface& surface, StopPoll& poll)
    : node_count(surface.node_count()) {
  for (int face = 0; face < surface.face_count(); ++face) {
    const auto nodes = surface.nodes_of(face);
    if (poll.after(nodes.size())) return;
    if (!surface.has_centre(face)) {
      triangles.push_back({nodes[0], nodes[1], nodes[2]});
      continue;
    }
    const int centre = node_count + centre_count();
    for (std::size_t k = 0; k < nodes.size(); ++k)
      triangles.push_back({nodes[k], nodes[(k + 1) % nodes.size()], centre});
    centre_nodes.insert(centre_nodes.end(), nodes.begin(), nodes.end());
    centre_starts.push_back(static_cast<int>(centre_nodes.size()));
  }
}

Vector3d FaceTriangles::point(int index, const Field& nodes) const {
  if (index < node_count) return nodes.row(index).transpose();
  const auto centre = static_cast<std::size_t>(index - node_count);
  const int begin = centre_starts[centre], end = centre_starts[centre + 1];
  Vector3d sum = Vector3d::Zero();
  for (int k = begin; k < end; ++k)
    sum += nodes.row(centre_nodes[static_cast<std::size_t>(k)]).transpose();
  return sum / (end - begin);
}

Field FaceTriangles::with_centres(const Field& nodes, StopPoll& poll) const {
  Field points(node_count + centre_count(), 3);
  points.topRows(node_count) = nodes;
  for (int index = node_count; index < points.rows(); ++index) {
    if (poll.after(16)) return points;
    points.row(index) = point(index, nodes).transpose();
  }
  return points;
}

}  // namespace pliant
