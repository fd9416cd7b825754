#include "pliant/mesh/triangles/triangle_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/mesh/triangles/triangle_frame.hpp"
#include "pliant/mesh/triangles/weld.hpp"

namespace pliant {
namespace {

// The share of the bounding box's diagonal within which vertices are one node.
constexpr double one_node = 1e-6;

// The slope across an edge joins all its faces, so that a frame costs the square of their number.
constexpr int most_faces_of_edge = 256;

// Items 0 to #keys - 1 sorted by their keys 0 to `count` - 1, and where each key begins.
struct Sorted {
  std::vector<int> starts;  // #keys + 1
  std::vector<int> items;   // in their order within a key

  std::span<int> of(int key) {
    return {items.data() + starts[key], static_cast<std::size_t>(starts[key + 1] - starts[key])};
  }
};

// Unfinished if it is stopped.
template <class KeyOf>
Sorted sorted_by(std::size_t item_count, int key_count, StopPoll& poll, const KeyOf& key_of) {
  Sorted sorted{std::vector<int>(static_cast<std::size_t>(key_count) + 1, 0),
                std::vector<int>(item_count)};
  for (std::size_t item = 0; item < item_count && !poll.after(); ++item)
    ++sorted.starts[key_of(item) + 1];
  std::partial_sum(sorted.starts.begin(), sorted.starts.end(), sorted.starts.begin());
  std::vector<int> next(sorted.starts.begin(), sorted.starts.end() - 1);
  for (std::size_t item = 0; item < item_count && !poll.after(); ++item) {
    sorted.items[next[key_of(item)]++] = static_cast<int>(item);
  }
  return sorted;
}

class SurfaceMaker {
 public:
  SurfaceMaker(const Mesh& mesh, const MeshReading& reading, const StopRequest& should_stop)
      : mesh_(mesh), reading_(reading), should_stop_(should_stop), poll_(should_stop) {}

  Result<TriangleSurface> make() {
    if (auto joined = join_vertices(); !joined) return fail(joined.error());
    return make_of_nodes();
  }

  Result<TriangleSurface> make(std::vector<int> vertex_nodes, Field rest) {
    surface_.vertex_nodes = std::move(vertex_nodes);
    surface_.rest = std::move(rest);
    return make_of_nodes();
  }

 private:
  bool is_stopped() { return poll_.after(0); }

  // Each part of the work ends unfinished if it is stopped.
  Result<TriangleSurface> make_of_nodes() {
    take_faces();
    if (!is_stopped()) leave_out_repeated();
    if (is_stopped()) return interrupted();
    if (surface_.face_count() == 0) {
      return invalid(fmt::format(
          "none of the mesh's {} faces can be used: each has fewer than three different corners, "
          "or a corner twice",
          mesh_.face_sizes.size()));
    }
    if (auto numbered = number_edges(); !numbered) return fail(numbered.error());
    if (!is_stopped()) list_faces_of_nodes(surface_, surface_.node_count(), poll_);
    if (!is_stopped()) lay_flat();
    if (is_stopped()) return interrupted();
    if (auto found = find_unit(); !found) return fail(found.error());
    return std::move(surface_);
  }

  // Nodes in the order of their lowest vertices.
  Result<void> join_vertices() {
    surface_.vertex_nodes.assign(static_cast<std::size_t>(mesh_.vertex_count()), -1);
    std::vector<int>& nodes = surface_.vertex_nodes;
    for (const int vertex : mesh_.corner_vertices) {
      if (poll_.after()) return interrupted();
      nodes[vertex] = 0;
    }
    std::vector<int> used;
    for (int vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      if (poll_.after()) return interrupted();
      if (nodes[vertex] == 0) used.push_back(vertex);
    }
    Field points(static_cast<Eigen::Index>(used.size()), 3);
    for (std::size_t k = 0; k < used.size(); ++k) {
      if (poll_.after(4)) return interrupted();
      points.row(static_cast<Eigen::Index>(k)) = mesh_.positions.row(used[k]);
    }
    const Eigen::RowVector3d extent = points.colwise().maxCoeff() - points.colwise().minCoeff();
    const double distance = reading_.weld.value_or(one_node * extent.stableNorm());
    const auto firsts = welded(points, distance, should_stop_);
    if (!firsts) return fail(firsts.error());
    int count = 0;
    for (std::size_t k = 0; k < used.size(); ++k) {
      if (poll_.after()) return interrupted();
      const auto first = static_cast<std::size_t>((*firsts)[k]);
      nodes[used[k]] = first == k ? count++ : nodes[used[first]];
    }
    surface_.rest.resize(count, 3);
    count = 0;
    for (std::size_t k = 0; k < used.size(); ++k) {
      if (poll_.after(4)) return interrupted();
      if ((*firsts)[k] == static_cast<int>(k))
        surface_.rest.row(count++) = mesh_.positions.row(used[k]);
    }
    return {};
  }

  // The faces that have three different corners or more, and none twice.
  void take_faces() {
    surface_.face_starts = {0};
    std::vector<int> last_face(static_cast<std::size_t>(surface_.node_count()), -1);
    std::size_t first = 0;
    for (std::size_t face = 0; face < mesh_.face_sizes.size(); ++face) {
      const auto size = static_cast<std::size_t>(mesh_.face_sizes[face]);
      if (poll_.after(4 * size)) return;
      const auto node_at = [&](std::size_t k) {
        return surface_.vertex_nodes[mesh_.corner_vertices[first + k]];
      };
      bool is_taken = true;
      for (std::size_t k = 0; k < size; ++k) {
        const int node = node_at(k);
        if (node == node_at((k + size - 1) % size)) continue;
        is_taken = is_taken && last_face[node] != static_cast<int>(face);
        last_face[node] = static_cast<int>(face);
        surface_.corner_nodes.push_back(node);
        surface_.mesh_corners.push_back(static_cast<int>(first + k));
      }
      const auto start = static_cast<std::size_t>(surface_.face_starts.back());
      if (is_taken && surface_.mesh_corners.size() - start >= 3) {
        surface_.face_starts.push_back(static_cast<int>(surface_.mesh_corners.size()));
      } else {
        surface_.corner_nodes.resize(start);
        surface_.mesh_corners.resize(start);
        ++surface_.faces_left_out;
      }
      first += size;
    }
  }

  // Faces with the nodes of an earlier one. Such faces have the same lowest node.
  void leave_out_repeated() {
    const auto face_count = static_cast<std::size_t>(surface_.face_count());
    std::vector<int> ordered = surface_.corner_nodes;  // ascending within each face
    const auto nodes = [&](int face) {
      return std::span(ordered).subspan(surface_.face_starts[face], surface_.size_of(face));
    };
    for (std::size_t face = 0; face < face_count; ++face) {
      if (poll_.after(10 * nodes(int(face)).size())) return;
      std::ranges::sort(nodes(int(face)));
    }
    Sorted faces = sorted_by(face_count, surface_.node_count(), poll_,
                             [&](std::size_t face) { return nodes(int(face))[0]; });
    if (is_stopped()) return;
    std::vector<bool> is_repeated(face_count, false);
    bool is_any = false;
    for (int node = 0; node < surface_.node_count(); ++node) {
      const std::span<int> some = faces.of(node);
      if (poll_.after(1 + 20 * some.size())) return;
      std::ranges::sort(some, [&](int a, int b) {
        const int order = compare(nodes(a), nodes(b));
        return order != 0 ? order < 0 : a < b;
      });
      for (std::size_t k = 1; k < some.size(); ++k) {
        if (compare(nodes(some[k - 1]), nodes(some[k])) != 0) continue;
        is_repeated[some[k]] = is_any = true;
      }
    }
    if (is_any) leave_out(is_repeated);
  }

  static int compare(std::span<const int> a, std::span<const int> b) {
    if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
    const auto [x, y] = std::mismatch(a.begin(), a.end(), b.begin());
    return x == a.end() ? 0 : *x < *y ? -1 : 1;
  }

  void leave_out(const std::vector<bool>& is_out) {
    std::vector<int>& starts = surface_.face_starts;
    int faces = 0, corners = 0;
    for (std::size_t face = 0; face < is_out.size(); ++face) {
      const int begin = starts[face], end = starts[face + 1];
      if (poll_.after(static_cast<std::size_t>(end - begin))) return;
      if (is_out[face]) continue;
      for (int k = begin; k < end; ++k, ++corners) {
        surface_.corner_nodes[corners] = surface_.corner_nodes[k];
        surface_.mesh_corners[corners] = surface_.mesh_corners[k];
      }
      // Not before `starts[face + 1]` was read: faces <= face.
      starts[++faces] = corners;
    }
    surface_.faces_left_out += static_cast<int>(is_out.size()) - faces;
    starts.resize(static_cast<std::size_t>(faces) + 1);
    surface_.corner_nodes.resize(static_cast<std::size_t>(corners));
    surface_.mesh_corners.resize(static_cast<std::size_t>(corners));
  }

  // Edges in the order of their lower nodes, then of the higher ones.
  Result<void> number_edges() {
    const std::size_t corner_count = surface_.corner_nodes.size();
    std::vector<int> highers(corner_count), lowers(corner_count);
    for (int face = 0; face < surface_.face_count(); ++face) {
      const std::span<const int> nodes = surface_.nodes_of(face);
      if (poll_.after(nodes.size())) return {};
      const auto start = static_cast<std::size_t>(surface_.face_starts[face]);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto [low, high] = std::minmax(nodes[k], nodes[(k + 1) % nodes.size()]);
        lowers[start + k] = low;
        highers[start + k] = high;
      }
    }
    Sorted sides = sorted_by(corner_count, surface_.node_count(), poll_,
                             [&](std::size_t corner) { return lowers[corner]; });
    if (is_stopped()) return {};
    surface_.corner_edges.resize(corner_count);
    for (int node = 0; node < surface_.node_count(); ++node) {
      const std::span<int> some = sides.of(node);
      if (poll_.after(1 + 10 * some.size())) return {};
      std::ranges::sort(some, {}, [&](int corner) { return std::pair(highers[corner], corner); });
      for (std::size_t k = 0; k < some.size(); ++k) {
        if (k == 0 || highers[some[k]] != highers[some[k - 1]]) surface_.edge_sides.push_back(0);
        if (++surface_.edge_sides.back() > most_faces_of_edge) {
          return invalid(fmt::format(
              "the edge between the vertices {} and {} belongs to more than {} faces",
              first_vertex_of(node), first_vertex_of(highers[some[k]]), most_faces_of_edge));
        }
        surface_.corner_edges[some[k]] = surface_.edge_count() - 1;
      }
    }
    return {};
  }

  int first_vertex_of(int node) const {
    const std::vector<int>& nodes = surface_.vertex_nodes;
    return mesh_.number_of(static_cast<int>(std::ranges::find(nodes, node) - nodes.begin()));
  }

  void lay_flat() {
    std::optional<Vector3d> axis;
    if (reading_.axis) {
      axis.emplace((*reading_.axis)[0], (*reading_.axis)[1], (*reading_.axis)[2]);
      *axis /= axis->cwiseAbs().maxCoeff();  // its length does not matter
    }
    surface_.triangle_starts = {0};
    for (int face = 0; face < surface_.face_count(); ++face) {
      const int start = surface_.face_starts[face], size = surface_.size_of(face);
      if (poll_.after(50 * static_cast<std::size_t>(size))) return;
      bool has_uvs = true;
      Vector3d centre = Vector3d::Zero();
      std::array<double, 2> centre_uv = {0, 0};
      for (int k = 0; k < size; ++k) {
        centre += position(start + k);
        has_uvs = has_uvs && uv_index(start + k) >= 0;
        if (!has_uvs) continue;
        const auto& [u, v] = mesh_.uvs[uv_index(start + k)];
        centre_uv[0] += u, centre_uv[1] += v;
      }
      centre /= size;
      for (double& each : centre_uv) each /= size;
      for (int k = 0; k < size; ++k) {
        // Twice the way from the centre is no less than that between two corners.
        const double way = 2 * (position(start + k) - centre).norm();
        surface_.widest_face = std::max(surface_.widest_face, way);
      }
      const int triangle_count = size > 3 ? size : 1;
      for (int k = 0; k < triangle_count; ++k) {
        const int a = start + k, b = start + (k + 1) % size, c = start + 2;
        const Vector3d third = size > 3 ? centre : position(c);
        TriangleUvs uvs;
        if (has_uvs) {
          const auto& third_uv = size > 3 ? centre_uv : mesh_.uvs[uv_index(c)];
          uvs = {mesh_.uvs[uv_index(a)], mesh_.uvs[uv_index(b)], third_uv};
        }
        surface_.triangles.push_back(flattened({position(a), position(b), third}, uvs, axis));
      }
      surface_.triangle_starts.push_back(static_cast<int>(surface_.triangles.size()));
    }
  }

  Vector3d position(int corner) const {
    return surface_.rest.row(surface_.corner_nodes[corner]).transpose();
  }
  int uv_index(int corner) const { return mesh_.corner_uvs[surface_.mesh_corners[corner]]; }

  Result<void> find_unit() {
    double area = 0;
    for (const FlatTriangle& triangle : surface_.triangles) {
      if (poll_.after()) return interrupted();
      area += std::abs(triangle.signed_area());
    }
    if (!std::isfinite(area) || !(area > 0)) {
      return invalid(
          fmt::format("the area of the mesh's triangles is {}",
                      area == 0 ? "0, or too small for a number" : "too large for a number"));
    }
    const double side = std::sqrt(area);
    surface_.unit = reading_.unit.value_or(std::array{side, side});
    return {};
  }

  const Mesh& mesh_;
  const MeshReading& reading_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  TriangleSurface surface_;
};

}  // namespace

Result<TriangleSurface> make_surface(const Mesh& mesh, const MeshReading& reading,
                                     const StopRequest& should_stop) {
  return SurfaceMaker(mesh, reading, should_stop).make();
}

Result<TriangleSurface> surface_of_nodes(const Mesh& mesh, std::vector<int> vertex_nodes,
                                         Field rest, const StopRequest& should_stop) {
  return SurfaceMaker(mesh, {}, should_stop).make(std::move(vertex_nodes), std::move(rest));
}

TriangleSurface posed(TriangleSurface surface, const Field& nodes) {
  PLIANT_EXPECTS(nodes.rows() == surface.rest.rows());
  surface.rest = nodes;
  surface.widest_face = 0;
  for (int face = 0; face < surface.face_count(); ++face) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const int node : surface.nodes_of(face)) centre += nodes.row(node);
    centre /= surface.size_of(face);
    for (const int node : surface.nodes_of(face)) {
      const double way = 2 * (nodes.row(node) - centre).norm();
      surface.widest_face = std::max(surface.widest_face, way);
    }
  }
  return surface;
}

std::vector<int> pieces_of(const TriangleSurface& surface) {
  std::vector<int> pieces(static_cast<std::size_t>(surface.node_count()), -1);
  std::vector<bool> is_passed(static_cast<std::size_t>(surface.face_count()));
  std::vector<int> open;
  int count = 0;
  for (int first = 0; first < surface.node_count(); ++first) {
    if (pieces[first] >= 0 || surface.faces_of(first).empty()) continue;
    pieces[first] = count;
    open.push_back(first);
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      for (const int face : surface.faces_of(node)) {
        if (is_passed[face]) continue;
        is_passed[face] = true;
        for (const int other : surface.nodes_of(face)) {
          if (pieces[other] >= 0) continue;
          pieces[other] = count;
          open.push_back(other);
        }
      }
    }
    ++count;
  }
  return pieces;
}

}  // namespace pliant
