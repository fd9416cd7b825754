#include "pliant/mesh/grid_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include <fmt/format.h>

namespace pliant {
namespace {

constexpr std::string_view way_out =
    "; a mesh that is no even grid needs uv=\"virtual\", a closed one needs wrap";

tl::unexpected<Error> not_a_grid(const std::string& reason) {
  return fail(ErrorCode::InvalidInput, reason + std::string(way_out));
}

// One direction of the lattice: `count` values from `least` on, `spacing` apart.
struct Axis {
  double least = 0;
  double spacing = 0;
  int count = 0;

  double position(double value) const { return (value - least) / spacing; }
  double nearest(double value) const { return std::round(position(value)); }
  bool is_even(double value) const {
    return std::abs(position(value) - nearest(value)) <= lattice_tolerance;
  }
  int index(double value) const {
    return static_cast<int>(nearest(value));
  }  // of a value that is even
};

// In an even lattice values of one line lie within 2 tolerances, and neighbouring lines at least
// 1 - 2 tolerances apart, so every gap wider than half the widest one is a step between lines.
// Values of no lattice give some axis too; whether it is even is checked against each value.
Axis find_axis(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double widest = 0;
  for (std::size_t k = 1; k < values.size(); ++k)
    widest = std::max(widest, values[k] - values[k - 1]);
  int count = 1;
  for (std::size_t k = 1; k < values.size(); ++k) count += values[k] - values[k - 1] > 0.5 * widest;
  const double extent = values.back() - values.front();
  return {values.front(), count > 1 ? extent / (count - 1) : 0, count};
}

}  // namespace

Field GridMapping::to_vertices(const Field& nodes, Field reuse) const {
  reuse.resize(static_cast<Eigen::Index>(vertex_nodes.size()), 3);
  for (int component = 0; component < 3; ++component) {
    const double* const from = nodes.col(component).data();
    double* const to = reuse.col(component).data();
    for (std::size_t vertex = 0; vertex < vertex_nodes.size(); ++vertex)
      to[vertex] = from[vertex_nodes[vertex]];
  }
  return reuse;
}

Result<GridMapping> find_grid(const Mesh& mesh) {
  // One corner with a (u,v) per vertex says where it lies; the others must agree.
  const int vertex_count = mesh.vertex_count();
  std::vector<int> vertex_uvs(vertex_count, -1);
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    const int vertex = mesh.corner_vertices[corner];
    const int uv = mesh.corner_uvs[corner];
    if (uv < 0) {
      return fail(ErrorCode::InvalidInput,
                  fmt::format("vertex {} has no (u,v); every face corner needs one", vertex + 1));
    }
    if (vertex_uvs[vertex] < 0) vertex_uvs[vertex] = uv;
  }
  std::vector<double> us, vs;
  us.reserve(vertex_count);
  vs.reserve(vertex_count);
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    if (vertex_uvs[vertex] < 0) {
      return fail(ErrorCode::InvalidInput,
                  fmt::format("vertex {} has no (u,v): no face uses it", vertex + 1));
    }
    us.push_back(mesh.uvs[vertex_uvs[vertex]][0]);
    vs.push_back(mesh.uvs[vertex_uvs[vertex]][1]);
  }
  if (us.empty()) return fail(ErrorCode::InvalidInput, "the mesh has no vertices");

  const Axis u_axis = find_axis(us);
  const Axis v_axis = find_axis(vs);
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    for (const auto& [axis, value, name] :
         {std::tuple{&u_axis, us[vertex], 'u'}, std::tuple{&v_axis, vs[vertex], 'v'}}) {
      if (axis->count > 1 && !axis->is_even(value)) {
        return not_a_grid(fmt::format(
            "vertex {} has {} = {}, which is not within {} of a spacing of the even lattice of {} "
            "values {} apart",
            vertex + 1, name, value, lattice_tolerance, axis->count, axis->spacing));
      }
    }
  }
  if (u_axis.count < 3 || v_axis.count < 3) {
    return not_a_grid(
        fmt::format("the (u,v) values make a grid of {} x {} nodes, smaller than 3 x 3",
                    u_axis.count, v_axis.count));
  }
  if (std::int64_t{u_axis.count} * v_axis.count > vertex_count) {
    return not_a_grid(
        fmt::format("the (u,v) values make a grid of {} x {} nodes, more than the {} "
                    "vertices",
                    u_axis.count, v_axis.count, vertex_count));
  }

  GridMapping mapping;
  mapping.grid = {u_axis.count, v_axis.count, u_axis.spacing, v_axis.spacing};
  const Grid& grid = mapping.grid;
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    const int vertex = mesh.corner_vertices[corner];
    const auto& [u, v] = mesh.uvs[mesh.corner_uvs[corner]];
    if (u_axis.nearest(u) != u_axis.nearest(us[vertex]) ||
        v_axis.nearest(v) != v_axis.nearest(vs[vertex])) {
      return not_a_grid(fmt::format("vertex {} has several (u,v), ({}, {}) and ({}, {}): a seam",
                                    vertex + 1, us[vertex], vs[vertex], u, v));
    }
    if (!u_axis.is_even(u) || !v_axis.is_even(v)) {
      return not_a_grid(fmt::format(
          "vertex {} has (u,v) = ({}, {}), which is not on the even lattice", vertex + 1, u, v));
    }
  }

  std::vector<int> node_vertices(grid.node_count(), -1);  // the first vertex of each node
  mapping.vertex_nodes.resize(vertex_count);
  mapping.rest.resize(grid.node_count(), 3);
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    const int node = grid.node(u_axis.index(us[vertex]), v_axis.index(vs[vertex]));
    mapping.vertex_nodes[vertex] = node;
    const int first = node_vertices[node];
    if (first < 0) {
      node_vertices[node] = vertex;
      mapping.rest.row(node) = mesh.positions.row(vertex);
    } else if (mesh.positions.row(vertex) != mesh.positions.row(first)) {
      return not_a_grid(
          fmt::format("vertices {} and {} share the (u,v) ({}, {}) but not the rest "
                      "position",
                      first + 1, vertex + 1, us[vertex], vs[vertex]));
    }
  }
  for (int node = 0; node < grid.node_count(); ++node) {
    if (node_vertices[node] < 0) {
      const int i = node % grid.columns, j = node / grid.columns;
      return not_a_grid(fmt::format(
          "no vertex lies at (u,v) = ({}, {}), node ({}, {}) of the grid of "
          "{} x {}",
          u_axis.least + i * grid.hu, v_axis.least + j * grid.hv, i, j, grid.columns, grid.rows));
    }
  }
  return mapping;
}

}  // namespace pliant
