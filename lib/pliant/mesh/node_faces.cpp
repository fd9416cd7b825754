#include "pliant/mesh/node_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

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

double sum_of_sizes(double x, double y, double z) {
  return std::abs(x) + std::abs(y) + std::abs(z);
}

// The sums of the areas around some nodes, and of the sizes of their components.
struct AreaSums {
  alignas(64) double x[most_normals], y[most_normals], z[most_normals], sizes[most_normals];

  void clear(int count) {
    for (double* const numbers : {x, y, z, sizes}) std::fill_n(numbers, count, 0.0);
  }
};

// The areas of up to `most_normals` + 1 cells of a row, from the cell in column `first` on.
struct CellAreas {
  alignas(64) double x[most_normals + 1], y[most_normals + 1], z[most_normals + 1],
      sizes[most_normals + 1];

  CellAreas(const NodeFaces& faces, const Field& positions, int row, int first, int count) {
    const int columns = faces.grid_columns;
    const auto node = static_cast<Eigen::Index>(row) * columns + first;
    const double* const px = positions.col(0).data() + node;
    const double* const py = positions.col(1).data() + node;
    const double* const pz = positions.col(2).data() + node;
    const double sign = faces.is_turned ? -1 : 1;
    for (int k = 0; k < count; ++k) {
      const double ax = px[k + columns + 1] - px[k], bx = px[k + columns] - px[k + 1];
      const double ay = py[k + columns + 1] - py[k], by = py[k + columns] - py[k + 1];
      const double az = pz[k + columns + 1] - pz[k], bz = pz[k + columns] - pz[k + 1];
      x[k] = sign * (ay * bz - az * by);
      y[k] = sign * (az * bx - ax * bz);
      z[k] = sign * (ax * by - ay * bx);
      sizes[k] = sum_of_sizes(x[k], y[k], z[k]);
    }
  }
};

// Of nodes in one row of a grid.
void sum_cells(const NodeFaces& faces, const Field& positions, int first, int count,
               AreaSums& sums) {
  const int columns = faces.grid_columns;
  const auto rows = static_cast<int>(positions.rows() / columns);
  const int column = first % columns, row = first / columns;
  const int begin = std::max(column - 1, 0), end = std::min(column + count, columns - 1);
  for (const int cell_row : {row - 1, row}) {
    if (cell_row < 0 || cell_row >= rows - 1) continue;
    const CellAreas areas(faces, positions, cell_row, begin, end - begin);
    // The cell before each node, then the one after it.
    for (const int side : {-1, 0}) {
      const int from = std::max(begin - column - side, 0);
      const int to = std::min(end - column - side, count);
      const int shift = column + side - begin;
      for (int k = from; k < to; ++k) {
        sums.x[k] += areas.x[k + shift];
        sums.y[k] += areas.y[k + shift];
        sums.z[k] += areas.z[k + shift];
        sums.sizes[k] += areas.sizes[k + shift];
      }
    }
  }
}

// Of any nodes. A face of several of them is measured once, mostly.
void sum_faces(const NodeFaces& faces, const Field& positions, int first, int count,
               AreaSums& sums) {
  constexpr int places = 64;
  int known[places];
  Vector3d areas[places];
  std::fill_n(known, places, -1);
  for (int k = 0; k < count; ++k) {
    for (const int face : faces.faces_of(first + k)) {
      const int place = face % places;
      if (known[place] != face) {
        areas[place] = doubled_area(faces.nodes_of(face), positions);
        known[place] = face;
      }
      const Vector3d& area = areas[place];
      sums.x[k] += area.x(), sums.y[k] += area.y(), sums.z[k] += area.z();
      sums.sizes[k] += sum_of_sizes(area.x(), area.y(), area.z());
    }
  }
}

// Unit normals of the areas, with the squares of their lengths. In `sizes`: what a length has
// beyond `reach` times the sum of the sizes.
void turn(const AreaSums& sums, const Matrix3d& to_normals, double reach, int count,
          AreaSums& normals, double* squares) {
  // A copy cannot be what is written below.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const Matrix3d m = to_normals;
  for (int k = 0; k < count; ++k) {
    const double x = m(0, 0) * sums.x[k] + m(0, 1) * sums.y[k] + m(0, 2) * sums.z[k];
    const double y = m(1, 0) * sums.x[k] + m(1, 1) * sums.y[k] + m(1, 2) * sums.z[k];
    const double z = m(2, 0) * sums.x[k] + m(2, 1) * sums.y[k] + m(2, 2) * sums.z[k];
    const double square = x * x + y * y + z * z;
    const double length = std::sqrt(square);
    const double inverse = 1 / length;
    normals.x[k] = x * inverse;
    normals.y[k] = y * inverse;
    normals.z[k] = z * inverse;
    normals.sizes[k] = length - reach * sums.sizes[k];
    squares[k] = square;
  }
}

// Of areas that are tiny, huge, or nearly cancel each other.
Vector3d careful_normal(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                        int node) {
  constexpr double least = 1e-12;
  double largest = 0;
  const auto each_area = [&](const auto& use) {
    for (const int face : faces.faces_of(node))
      use(Vector3d(to_normals * doubled_area(faces.nodes_of(face), positions)));
  };
  each_area([&](const Vector3d& area) { largest = std::max(largest, area.cwiseAbs().maxCoeff()); });
  if (!(largest > 0)) return Vector3d::Zero();
  Vector3d sum = Vector3d::Zero();
  double areas = 0;
  each_area([&](const Vector3d& area) {
    sum += area / largest;
    areas += (area / largest).norm();
  });
  const double length = sum.norm();
  return length < least * areas ? Vector3d(Vector3d::Zero()) : Vector3d(sum / length);
}

// The columns of nodes, if the faces are the cells of an open grid; otherwise 0.
int columns_of_cells(const NodeFaces& faces, int node_count, bool& is_turned) {
  if (faces.face_count() == 0 || faces.size_of(0) != 4) return 0;
  std::array<int, 4> sorted = {};
  std::ranges::copy(faces.nodes_of(0), sorted.begin());
  std::ranges::sort(sorted);
  const int columns = sorted[2];
  if (columns < 2 || node_count % columns != 0) return 0;
  const std::int64_t cells = std::int64_t{columns - 1} * (node_count / columns - 1);
  if (faces.face_count() != cells) return 0;
  for (int face = 0; face < faces.face_count(); ++face) {
    if (faces.size_of(face) != 4) return 0;
    const int base = face / (columns - 1) * columns + face % (columns - 1);
    const std::array round = {base, base + 1, base + columns + 1, base + columns};
    const std::span<const int> nodes = faces.nodes_of(face);
    const auto start = std::ranges::find(round, nodes[0]) - round.begin();
    if (start == 4) return 0;
    const bool turns = nodes[1] != round[static_cast<std::size_t>(start + 1) % 4];
    if (face == 0) is_turned = turns;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t place = static_cast<std::size_t>(start) + (is_turned ? 4 - k : k);
      if (nodes[k] != round[place % 4]) return 0;
    }
  }
  return columns;
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
  faces.grid_columns = columns_of_cells(faces, node_count, faces.is_turned);
  return faces;
}

Vector3d normal_at(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                   int node) {
  Vector3d normal;
  normals_of_run(faces, positions, to_normals, node, 1, {&normal.x(), &normal.y(), &normal.z()});
  return normal;
}

void normals_of_run(const NodeFaces& faces, const Field& positions, const Matrix3d& to_normals,
                    int first, int count, const NormalRun& out) {
  if (const int columns = faces.grid_columns; columns > 0) {
    const int left = columns - first % columns;  // in the row
    if (count > left) {
      normals_of_run(faces, positions, to_normals, first, left, out);
      return normals_of_run(faces, positions, to_normals, first + left, count - left,
                            {out.x + left, out.y + left, out.z + left});
    }
  }
  AreaSums sums;
  sums.clear(count);
  if (faces.grid_columns > 0)
    sum_cells(faces, positions, first, count, sums);
  else
    sum_faces(faces, positions, first, count, sums);
  // No sum of areas is longer than this times the sum of the sizes.
  constexpr double suspicious = 1e-10;
  const double reach = suspicious * to_normals.cwiseAbs().sum();
  constexpr double low = 1e-200, high = 1e200;  // squares of lengths that are far from the limits
  AreaSums normals;  // and in `sizes` how much a length exceeds its limit
  double squares[most_normals];
  turn(sums, to_normals, reach, count, normals, squares);
  std::copy_n(normals.x, count, out.x);
  std::copy_n(normals.y, count, out.y);
  std::copy_n(normals.z, count, out.z);
  for (int k = 0; k < count; ++k) {
    if (normals.sizes[k] > 0 && squares[k] > low && squares[k] < high) continue;
    const Vector3d normal = careful_normal(faces, positions, to_normals, first + k);
    out.x[k] = normal.x(), out.y[k] = normal.y(), out.z[k] = normal.z();
  }
}

}  // namespace pliant
