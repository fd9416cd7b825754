#include "cli/new/mesh_piece.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>  // cross

#include "pliant/core/joined_sets.hpp"

namespace pliant::cli {
namespace {

// The faces of a mesh between nodes.
struct NodeFace {
  std::vector<int> nodes;
  Vector3d area_normal;  // [length^2]
};

Vector3d area_normal_of(const Mesh& mesh, std::span<const int> corners) {
  Vector3d sum(0, 0, 0);
  const Vector3d first = mesh.positions.row(corners[0]).transpose();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vector3d a = mesh.positions.row(corners[k]).transpose() - first;
    const Vector3d b = mesh.positions.row(corners[k + 1]).transpose() - first;
    sum += 0.5 * a.cross(b);
  }
  return sum;
}

std::vector<NodeFace> faces_of(const RestShape& shape) {
  std::vector<NodeFace> faces;
  const Mesh& mesh = shape.mesh;
  std::size_t begin = 0;
  for (const int size : mesh.face_sizes) {
    const std::span corners(mesh.corner_vertices.data() + begin, static_cast<std::size_t>(size));
    begin += corners.size();
    NodeFace face{{}, area_normal_of(mesh, corners)};
    for (const int corner : corners) {
      const int node = shape.vertex_nodes[static_cast<std::size_t>(corner)];
      if (node >= 0 && (face.nodes.empty() || face.nodes.back() != node))
        face.nodes.push_back(node);
    }
    if (face.nodes.size() > 1 && face.nodes.front() == face.nodes.back()) face.nodes.pop_back();
    if (face.nodes.size() >= 3 && face.area_normal.norm() > 0) faces.push_back(std::move(face));
  }
  return faces;
}

// Whether each node is on an edge of one face.
std::vector<bool> border_of(const std::vector<NodeFace>& faces, std::size_t count) {
  std::vector<std::pair<int, int>> edges;
  for (const NodeFace& face : faces) {
    for (std::size_t k = 0; k < face.nodes.size(); ++k)
      edges.emplace_back(std::minmax(face.nodes[k], face.nodes[(k + 1) % face.nodes.size()]));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<bool> is_border(count);
  for (auto edge = edges.begin(); edge != edges.end();) {
    const auto next =
        std::find_if(edge, edges.end(), [&](const auto& one) { return one != *edge; });
    if (next - edge == 1)
      is_border[static_cast<std::size_t>(edge->first)] =
          is_border[static_cast<std::size_t>(edge->second)] = true;
    edge = next;
  }
  return is_border;
}

}  // namespace

MeshPiece largest_piece(const RestShape& shape) {
  const auto count = static_cast<std::size_t>(shape.rest.rows());
  const std::vector<NodeFace> faces = faces_of(shape);
  JoinedSets sets(count);  // of nodes that faces join
  for (const NodeFace& face : faces) {
    for (const int node : face.nodes) sets.join(node, face.nodes.front());
  }
  std::map<int, double> areas;
  for (const NodeFace& face : faces)
    areas[sets.first_of(face.nodes.front())] += face.area_normal.norm();
  MeshPiece piece;
  piece.is_grid = shape.grid.has_value();
  std::vector<int> nodes;
  std::vector<bool> is_border(count);
  Field normals = Field::Zero(shape.rest.rows(), 3);
  if (areas.empty()) {
    nodes.resize(count);
    std::iota(nodes.begin(), nodes.end(), 0);
  } else {
    const int largest =
        std::max_element(areas.begin(), areas.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    for (const NodeFace& face : faces) {
      for (const int node : face.nodes) normals.row(node) += face.area_normal.transpose();
    }
    std::vector<bool> is_used(count);
    for (const NodeFace& face : faces) {
      for (const int node : face.nodes) is_used[static_cast<std::size_t>(node)] = true;
    }
    for (int node = 0; node < static_cast<int>(count); ++node) {
      if (is_used[static_cast<std::size_t>(node)] && sets.first_of(node) == largest)
        nodes.push_back(node);
    }
    is_border = border_of(faces, count);
  }
  piece.vertices.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  piece.normals.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    piece.vertices.row(row) = shape.rest.row(nodes[k]);
    const double length = normals.row(nodes[k]).norm();
    piece.normals.row(row) =
        length > 0 ? (normals.row(nodes[k]) / length).eval() : Eigen::RowVector3d::Zero().eval();
    piece.is_border.push_back(is_border[static_cast<std::size_t>(nodes[k])]);
  }
  if (!nodes.empty()) {
    piece.low = piece.vertices.colwise().minCoeff().transpose();
    piece.high = piece.vertices.colwise().maxCoeff().transpose();
  }
  return piece;
}

Eigen::Index pushed_vertex(const MeshPiece& piece, const Vector3d& wanted, double radius) {
  // Some of a long border tell well enough how near it is.
  constexpr std::size_t most_border = 1000;
  std::vector<Eigen::Index> border;
  for (Eigen::Index row = 0; row < piece.vertices.rows(); ++row) {
    if (piece.is_border[static_cast<std::size_t>(row)]) border.push_back(row);
  }
  const std::size_t step = 1 + border.size() / most_border;
  Eigen::Index best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index row = 0; row < piece.vertices.rows(); ++row) {
    const Eigen::RowVector3d at = piece.vertices.row(row);
    double distance = (at - wanted.transpose()).norm() / piece.diagonal();
    if (!piece.is_border[static_cast<std::size_t>(row)]) {
      double to_border = radius;
      for (std::size_t k = 0; k < border.size(); k += step)
        to_border = std::min(to_border, (at - piece.vertices.row(border[k])).norm());
      distance += 1 - to_border / radius;
    } else {
      distance += 10;  // only if there is no other one
    }
    if (!(distance < least)) continue;
    least = distance;
    best = row;
  }
  return best;
}

}  // namespace pliant::cli
