#include "pliant/mesh/node_faces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pliant {
namespace {

// Twice the vector area of a polygon.
Vector3d doubled_area(std::span<const int> nodes, const Field& positions) {
  const auto at = [&](std::size_t k) { return Vector3d(positions.row(nodes[k]).transpose()); };
  // Of a quad, the product of its diagonals.
  if (nodes.size() == 4) return (at(2) - at(0)).cross(at(3) - at(1));
  Vector3d sum = Vector3d::Zero();
  const Vector3d first = at(0);
  Vector3d before = at(1) - first;
  for (std::size_t k = 2; k < nodes.size(); ++k) {
    const Vector3d now = at(k) - first;
    sum += before.cross(now);
    before = now;
  }
  return sum;
}

}  // namespace

void list_faces_of_nodes(NodeFaces& faces, int node_count, StopPoll& poll) {
  const std::vector<int>& corners = faces.corner_nodes;
  std::vector<int>& starts = faces.node_starts;
  starts.assign(static_cast<std::size_t>(node_count) + 1, 0);
  for (const int node : corners) {
    if (poll.after()) return;
    ++starts[static_cast<std::size_t>(node) + 1];
  }
  for (std::size_t node = 0; node + 1 < starts.size(); ++node) starts[node + 1] += starts[node];
  std::vector<int> next(starts.begin(), starts.end() - 1);
  faces.node_faces.resize(corners.size());
  for (int face = 0; face < faces.face_count(); ++face) {
    if (poll.after(4)) return;
    for (const int node : faces.nodes_of(face)) faces.node_faces[next[node]++] = face;
  }
}

Result<NodeFaces> node_faces(const Mesh& mesh, const std::vector<int>& vertex_nodes, int node_count,
                             const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  NodeFaces faces;
  faces.face_starts = {0};
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    if (poll.after(4)) return interrupted();
    for (int k = 0; k < size; ++k) {
      const int node = vertex_nodes[static_cast<std::size_t>(mesh.corner_vertices[corner++])];
      if (node >= 0) faces.corner_nodes.push_back(node);
    }
    const auto first = static_cast<std::size_t>(faces.face_starts.back());
    if (faces.corner_nodes.size() < first + 3) faces.corner_nodes.resize(first);
    faces.face_starts.push_back(static_cast<int>(faces.corner_nodes.size()));
  }
  list_faces_of_nodes(faces, node_count, poll);
  if (poll.after(0)) return interrupted();
  return faces;
}

Vector3d normal_at(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                   int node) {
  constexpr double least = 1e-12, suspicious = 1e-10;
  Vector3d sum = Vector3d::Zero();
  double largest = 0;
  for (const int face : faces.faces_of(node)) {
    const Vector3d area = to_normals * doubled_area(faces.nodes_of(face), positions);
    sum += area;
    largest = std::max(largest, area.cwiseAbs().maxCoeff());
  }
  if (!(largest > 0)) return Vector3d::Zero();
  sum /= largest;
  const double length = sum.norm();
  if (length < suspicious * static_cast<double>(faces.faces_of(node).size())) {
    double areas = 0;
    for (const int face : faces.faces_of(node))
      areas += (to_normals * doubled_area(faces.nodes_of(face), positions) / largest).norm();
    if (length < least * areas) return Vector3d::Zero();
  }
  return sum / length;
}

}  // namespace pliant
