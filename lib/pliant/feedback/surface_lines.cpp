#include "pliant/feedback/surface_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/mesh/triangles/triangle_tree.hpp"
#include "pliant/mesh/triangles/triangulate.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"
#include "pliant/sampling/rest_shape.hpp"

namespace pliant {
namespace {

// The cells of a grid that some boxes cover. Those of a closed direction are counted round.
class CoveredCells {
 public:
  explicit CoveredCells(const Grid& grid)
      : grid_(grid),
        columns_(grid.columns - (grid.is_closed_u ? 0 : 1)),
        rows_(grid.rows - (grid.is_closed_v ? 0 : 1)),
        is_covered_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  void add(const Box& box) {
    each_cell(box, [&](int i, int j) { is_covered_[place(i, j)] = true; });
  }

  // Calls f(node, other) for each edge between a cell that is covered and one that is not.
  template <class F>
  void each_rim_edge(const F& f) const {
    for (int j = 0; j < grid_.rows; ++j) {
      for (int i = 0; i < grid_.columns; ++i) {
        if (i < columns_ && covers(i, j - 1) != covers(i, j)) f(node(i, j), node(i + 1, j));
        if (j < rows_ && covers(i - 1, j) != covers(i, j)) f(node(i, j), node(i, j + 1));
      }
    }
  }

  // The edges of a box that is a line.
  template <class F>
  void each_edge_of_line(const Box& box, const F& f) const {
    if (box.j0 == box.j1) {
      for (int i = box.i0; i < last(box.i0, box.i1, grid_.columns, grid_.is_closed_u); ++i)
        f(node(i, box.j0), node(i + 1, box.j0));
    }
    if (box.i0 == box.i1) {
      for (int j = box.j0; j < last(box.j0, box.j1, grid_.rows, grid_.is_closed_v); ++j)
        f(node(box.i0, j), node(box.i0, j + 1));
    }
  }

 private:
  // The line after the last cell between two lines: a run of all lines of a closed direction goes
  // all round.
  static int last(int first, int last, int count, bool is_closed) {
    return is_closed && last - first + 1 == count ? last + 1 : last;
  }

  template <class F>
  void each_cell(const Box& box, const F& f) const {
    for (int j = box.j0; j < last(box.j0, box.j1, grid_.rows, grid_.is_closed_v); ++j) {
      for (int i = box.i0; i < last(box.i0, box.i1, grid_.columns, grid_.is_closed_u); ++i) f(i, j);
    }
  }

  bool covers(int i, int j) const {
    const bool is_beyond_u = !grid_.is_closed_u && (i < 0 || i >= columns_);
    const bool is_beyond_v = !grid_.is_closed_v && (j < 0 || j >= rows_);
    return !is_beyond_u && !is_beyond_v && is_covered_[place(i, j)];
  }
  std::size_t place(int i, int j) const {
    return static_cast<std::size_t>((j + rows_) % rows_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>((i + columns_) % columns_);
  }
  int node(int i, int j) const { return j % grid_.rows * grid_.columns + i % grid_.columns; }

  const Grid& grid_;
  int columns_, rows_;  // of cells
  std::vector<bool> is_covered_;
};

// The vertex of each node; -1: none.
std::vector<int> lowest_vertices(const RestShape& shape) {
  std::vector<int> lowest(static_cast<std::size_t>(shape.rest.rows()), -1);
  for (std::size_t vertex = shape.vertex_nodes.size(); vertex-- > 0;) {
    const int node = shape.vertex_nodes[vertex];
    if (node >= 0) lowest[node] = static_cast<int>(vertex);
  }
  return lowest;
}

// The vertex in which each node has its greatest share, the first of equals; -1: in none.
std::vector<int> greatest_vertices(const RestShape& shape) {
  struct Greatest {
    double share = 0;
    int vertex = -1;
  };
  std::vector<Greatest> found(static_cast<std::size_t>(shape.mesh.vertex_count()));
  for (std::size_t k = 0; k < found.size(); ++k) found[k] = {1, static_cast<int>(k)};
  // From the vertices to the points that they are summed of, and to the nodes.
  for (const VertexWeights* map = shape.weights.get(); map; map = map->points.get()) {
    const Eigen::Index count = map->points ? map->points->vertex_count() : shape.rest.rows();
    std::vector<Greatest> next(static_cast<std::size_t>(count));
    for (int sum = 0; sum < map->vertex_count(); ++sum) {
      const auto& [share, vertex] = found[sum];
      for (std::size_t entry = map->starts[sum]; entry < map->starts[sum + 1]; ++entry) {
        Greatest& known = next[map->nodes[entry]];
        const double here = share * map->weights[entry];
        if (here > known.share) known = {here, vertex};
      }
    }
    found = std::move(next);
  }
  std::vector<int> vertices;
  for (const Greatest& greatest : found) vertices.push_back(greatest.vertex);
  return vertices;
}

Field places_on_mesh(const RestShape& shape) {
  Field places = shape.rest;
  const std::vector<int> vertices = greatest_vertices(shape);
  for (std::size_t node = 0; node < vertices.size(); ++node) {
    if (vertices[node] < 0) continue;
    places.row(static_cast<Eigen::Index>(node)) = shape.mesh.positions.row(vertices[node]);
  }
  return places;
}

std::vector<std::array<int, 3>> drawn_triangles(const Mesh& mesh) {
  std::vector<std::array<int, 3>> triangles = triangulate(mesh);
  for (std::array<int, 3>& triangle : triangles) {
    for (int& corner : triangle) corner = mesh.corner_vertices[corner];
  }
  return triangles;
}

double mean_side(const Field& points, std::span<const std::array<int, 3>> triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    sum += (points.row(b) - points.row(a)).norm() + (points.row(c) - points.row(b)).norm() +
           (points.row(a) - points.row(c)).norm();
  }
  return sum / (3 * static_cast<double>(triangles.size()));
}

}  // namespace

std::vector<int> node_vertices(const RestShape& shape) {
  return shape.weights ? greatest_vertices(shape) : lowest_vertices(shape);
}

void SurfaceLines::add_source(int source, double share) {
  sources.push_back(source);
  shares.push_back(share);
}

int SurfaceLines::add_point() {
  starts.push_back(static_cast<int>(sources.size()));
  return point_count() - 1;
}

Field SurfaceLines::points(const Field& positions) const {
  Field points = Field::Zero(point_count(), 3);
  for (int point = 0; point < point_count(); ++point) {
    for (int entry = starts[point]; entry < starts[point + 1]; ++entry) {
      const int source = sources[entry];
      const Field& from = source >= 0 ? positions : points;
      const Eigen::RowVector3d position = from.row(source >= 0 ? source : -1 - source);
      points.row(point) += shares[entry] * position;
    }
  }
  return points;
}

class LinesOnMesh::Mapping {
 public:
  explicit Mapping(const RestShape& shape) : shape_(shape) {
    if (!shape.weights) {
      vertices_ = lowest_vertices(shape);
      return;
    }
    places_ = places_on_mesh(shape);
    triangles_ = drawn_triangles(shape.mesh);
    if (triangles_.empty()) return;
    tree_.emplace(shape.mesh.positions, triangles_);
    spacing_ = 0.25 * mean_side(shape.mesh.positions, triangles_);
  }

  SurfaceLines to_vertices(const SurfaceLines& of_nodes) const {
    if (shape_.weights) return along_mesh(of_nodes);
    SurfaceLines lines = of_nodes;
    for (int& source : lines.sources) {
      if (source >= 0) source = vertices_[source];
    }
    return lines;
  }

  SurfaceLines around(std::span<const Box> boxes) const {
    CoveredCells cells(*shape_.grid);
    SurfaceLines lines;
    std::map<int, int> points;
    const auto point = [&](int node) {
      const auto [place, is_new] = points.try_emplace(node, lines.point_count());
      if (is_new) {
        lines.add_source(node, 1);
        lines.add_point();
      }
      return place->second;
    };
    const auto join = [&](int node, int other) {
      const int from = point(node);
      lines.segments.push_back({from, point(other)});
    };
    for (const Box& box : boxes) {
      const Box within = clipped(box);
      if (within.is_empty()) continue;
      cells.add(within);
      cells.each_edge_of_line(within, join);
    }
    cells.each_rim_edge(join);
    return to_vertices(lines);
  }

 private:
  Box clipped(Box box) const {
    const Grid& grid = *shape_.grid;
    if (!grid.is_closed_u) {
      box.i0 = std::max(box.i0, 0);
      box.i1 = std::min(box.i1, grid.columns - 1);
    }
    if (!grid.is_closed_v) {
      box.j0 = std::max(box.j0, 0);
      box.j1 = std::min(box.j1, grid.rows - 1);
    }
    return box;
  }

  // Each segment becomes several short ones, which leave the mesh very little where they cross the
  // edges of its triangles.
  SurfaceLines along_mesh(const SurfaceLines& of_nodes) const {
    constexpr double most_parts = 64;
    SurfaceLines lines;
    if (!tree_) return lines;
    const Field points = of_nodes.points(places_);
    const auto place = [&](int point) -> Vector3d { return points.row(point).transpose(); };
    for (int point = 0; point < of_nodes.point_count(); ++point) add_closest(place(point), lines);
    for (const auto& [a, b] : of_nodes.segments) {
      const Vector3d way = place(b) - place(a);
      const int parts =
          static_cast<int>(std::clamp(std::ceil(way.norm() / spacing_), 1.0, most_parts));
      int from = a;
      for (int k = 1; k < parts; ++k) {
        const int to = add_closest(place(a) + static_cast<double>(k) / parts * way, lines);
        lines.segments.push_back({from, to});
        from = to;
      }
      lines.segments.push_back({from, b});
    }
    return lines;
  }

  // The point of the mesh that is closest to a place at rest.
  int add_closest(const Vector3d& place, SurfaceLines& lines) const {
    const ClosestPoint closest = tree_->closest(place);
    for (int k = 0; k < 3; ++k) {
      if (closest.weights[k] == 0) continue;
      lines.add_source(triangles_[closest.triangle][k], closest.weights[k]);
    }
    return lines.add_point();
  }

  const RestShape& shape_;
  std::vector<int> vertices_;  // of each node

  // If vertices are sums of nodes:
  Field places_;  // of the nodes (#nodes x 3), object space [length]
  std::vector<std::array<int, 3>> triangles_;
  std::optional<TriangleTree> tree_;
  double spacing_ = 1;  // of points along a line, at most about [length]
};

LinesOnMesh::LinesOnMesh(const RestShape& shape)
    : mapping_(std::make_unique<const Mapping>(shape)) {}
LinesOnMesh::LinesOnMesh(LinesOnMesh&&) noexcept = default;
LinesOnMesh& LinesOnMesh::operator=(LinesOnMesh&&) noexcept = default;
LinesOnMesh::~LinesOnMesh() = default;

SurfaceLines LinesOnMesh::to_vertices(const SurfaceLines& of_nodes) const {
  return mapping_->to_vertices(of_nodes);
}

SurfaceLines LinesOnMesh::around(std::span<const Box> boxes) const {
  return mapping_->around(boxes);
}

}  // namespace pliant
