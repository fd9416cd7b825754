#include "pliant/mesh/grid_mapping.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stoppable_sort.hpp"

namespace pliant {
namespace {

// Vertices nearer to each other than this times the diagonal of the bounding box count as one
// place, at the border of a grid or where it is closed.
constexpr double one_place = 1e-6;

// The error for a mesh in which some corner has no (u,v); `vertex` is that of the first one.
tl::unexpected<Error> without_uvs(const Mesh& mesh, int vertex) {
  const auto missing = std::count(mesh.corner_uvs.begin(), mesh.corner_uvs.end(), -1);
  if (missing == static_cast<std::ptrdiff_t>(mesh.corner_uvs.size())) {
    return invalid("it has no (u,v) (UVs)");
  }
  return invalid(
      fmt::format("vertex {} has no (u,v) (UVs); {} of the {} corners of faces have none",
                  mesh.number_of(vertex), missing, mesh.corner_uvs.size()));
}

// One direction of the lattice: `count` values from `least` on, `spacing` apart. If it is closed,
// the last one is the first again.
struct Axis {
  double least = 0;
  double spacing = 0;
  int count = 0;
  bool is_closed = false;

  int nodes() const { return is_closed ? count - 1 : count; }

  double position(double value) const { return (value - least) / spacing; }
  double nearest(double value) const { return std::round(position(value)); }
  bool is_even(double value) const {
    return std::abs(position(value) - nearest(value)) <= lattice_tolerance;
  }
  // The node nearest to it.
  double node(double value) const {
    const double line = nearest(value);
    return is_closed && line == nodes() ? 0 : line;
  }
  int index(double value) const {
    return static_cast<int>(node(value));
  }  // for a value on a uniform lattice
};

// In a uniform lattice, values of one line differ by at most 2 tolerances, and neighbouring lines
// are at least 1 - 2 tolerances apart, so every gap wider than half the widest one is between two
// lines. Values that form no lattice also give some axis; each value is then checked against it.
Axis find_axis(std::vector<double> values, bool is_closed, StopPoll& poll) {
  if (!sort_unless_stopped(values, poll)) return {};
  double widest = 0;
  for (std::size_t k = 1; k < values.size(); ++k)
    widest = std::max(widest, values[k] - values[k - 1]);
  int count = 1;
  for (std::size_t k = 1; k < values.size(); ++k) count += values[k] - values[k - 1] > 0.5 * widest;
  const double extent = values.back() - values.front();
  return {values.front(), count > 1 ? extent / (count - 1) : 0, count, is_closed};
}

double one_place_distance(const Field& positions) {
  return one_place * (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
}

using NodePair = std::array<int, 2>;

// The first pair of nodes with equal keys that `is_one_place` confirms; nodes at one place must
// have equal keys. O(n log n): nodes with one key are compared with only as many others as can be
// in one cell without such a pair among them.
template <class Key, class IsOnePlace>
std::optional<NodePair> find_pair(const std::vector<int>& nodes, StopPoll& poll, Key key_of,
                                  IsOnePlace is_one_place) {
  constexpr std::size_t most_apart = 64;  // more do not fit into a cell of two distances a side
  std::vector<std::pair<std::uint64_t, int>> keyed;
  keyed.reserve(nodes.size());
  for (const int node : nodes) {
    if (poll.after(10)) return {};
    keyed.emplace_back(key_of(node), node);
  }
  if (!sort_unless_stopped(keyed, poll)) return {};
  std::optional<NodePair> found;
  for (std::size_t k = 1; k < keyed.size(); ++k) {
    if (poll.after(4)) return {};
    for (std::size_t back = 1; back <= std::min(k, most_apart); ++back) {
      const auto& [key, node] = keyed[k - back];
      if (key != keyed[k].first) break;
      const NodePair pair = {node, keyed[k].second};
      if (!is_one_place(pair)) continue;
      if (!found || pair < *found) found = pair;
      break;
    }
  }
  return found;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t number) {
  hash = (hash ^ number) * 0x9e37'79b9'7f4a'7c15;
  return hash ^ hash >> 32;
}

std::vector<int> border_nodes(const Grid& grid) {
  std::vector<int> nodes;
  for (int j = 0; j < grid.rows; ++j) {
    const bool is_end = !grid.is_closed_v && (j == 0 || j == grid.rows - 1);
    if (!is_end && grid.is_closed_u) continue;
    for (int i = 0; i < grid.columns; i += is_end ? 1 : grid.columns - 1)
      nodes.push_back(grid.node(i, j));
  }
  return nodes;
}

// Border nodes nearer than `distance`: such a pair is in one cell, two distances a side, of one of
// eight lattices that are shifted by half a cell.
std::optional<NodePair> near_pair(const GridMapping& mapping, double distance, StopPoll& poll) {
  const Field& rest = mapping.rest;
  const Eigen::RowVector3d least = rest.colwise().minCoeff();
  const std::vector<int> nodes = border_nodes(mapping.grid);
  std::optional<NodePair> found;
  for (unsigned shift = 0; shift < 8; ++shift) {
    const auto key_of = [&](int node) {
      std::uint64_t key = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const double cell = (rest(node, axis) - least[axis]) / (2 * distance);
        key = mixed(key, static_cast<std::uint64_t>(cell + 0.5 * (shift >> axis & 1u)));
      }
      return key;
    };
    const auto pair = find_pair(nodes, poll, key_of, [&](const NodePair& each) {
      return (rest.row(each[0]) - rest.row(each[1])).norm() <= distance;
    });
    if (pair && (!found || *pair < *found)) found = pair;
  }
  return found;
}

// Two nodes that are distinct only in formats that split vertices: bit-identical positions; on the
// border, equal within rounding.
std::optional<NodePair> nodes_in_one_place(const GridMapping& mapping, StopPoll& poll) {
  const Field& rest = mapping.rest;
  std::vector<int> all(static_cast<std::size_t>(mapping.grid.node_count()));
  std::iota(all.begin(), all.end(), 0);
  const auto key_of = [&](int node) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
      key = mixed(key, std::bit_cast<std::uint64_t>(rest(node, axis) + 0.0));  // -0 becomes 0
    return key;
  };
  const auto same = find_pair(all, poll, key_of, [&](const NodePair& each) {
    return rest.row(each[0]) == rest.row(each[1]);
  });
  if (same) return same;
  const double distance = one_place_distance(rest);
  if (!(distance > 0) || !std::isfinite(distance)) return {};
  return near_pair(mapping, distance, poll);
}

// Whether `count` nodes from `first` on, `step` apart, are all in one place.
bool is_pole(const Field& rest, int first, int step, int count, double distance) {
  for (int k = 1; k < count; ++k) {
    if (!((rest.row(first + k * step) - rest.row(first)).norm() <= distance)) return false;
  }
  return true;
}

// The error for a grid that is closed round a pole; `vertices` has the first one of each node.
Result<void> check_poles(const Mesh& mesh, const GridMapping& mapping,
                         const std::vector<int>& vertices) {
  const Grid& grid = mapping.grid;
  const double distance = one_place_distance(mapping.rest);
  const auto pole = [&](std::string_view line, int number, int node, int other) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("{} {} of the grid, with vertices {} and {}, is in one place: a pole, "
                    "which a closed grid cannot have",
                    line, number, mesh.number_of(vertices[node]), mesh.number_of(vertices[other])));
  };
  for (int j = 0; grid.is_closed_u && j < grid.rows; ++j) {
    if (is_pole(mapping.rest, grid.node(0, j), 1, grid.columns, distance))
      return pole("row", j, grid.node(0, j), grid.node(1, j));
  }
  for (int i = 0; grid.is_closed_v && i < grid.columns; ++i) {
    if (is_pole(mapping.rest, grid.node(i, 0), grid.columns, grid.rows, distance))
      return pole("column", i, grid.node(i, 0), grid.node(i, 1));
  }
  return {};
}

}  // namespace

Result<GridMapping> find_grid(const Mesh& mesh, Wrap wrap, Seams seams,
                              const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  // The first corner with a (u,v) gives the place of its vertex; the others must agree.
  const int vertex_count = mesh.vertex_count();
  std::vector<int> vertex_uvs(vertex_count, -1);
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    if (poll.after()) return interrupted();
    const int vertex = mesh.corner_vertices[corner];
    const int uv = mesh.corner_uvs[corner];
    if (uv < 0) {
      return without_uvs(mesh, vertex);
    }
    if (vertex_uvs[vertex] < 0) vertex_uvs[vertex] = uv;
  }
  std::vector<double> us, vs;
  us.reserve(vertex_count);
  vs.reserve(vertex_count);
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    if (poll.after()) return interrupted();
    if (vertex_uvs[vertex] < 0) {
      return invalid(
          fmt::format("vertex {} has no (u,v): no face uses it", mesh.number_of(vertex)));
    }
    us.push_back(mesh.uvs[vertex_uvs[vertex]][0]);
    vs.push_back(mesh.uvs[vertex_uvs[vertex]][1]);
  }
  if (us.empty()) return fail(ErrorCode::InvalidInput, "the mesh has no vertices");

  // A vertex on the seam of a closed grid may have the (u,v) of both its sides.
  std::vector<double> all_us = us, all_vs = vs;
  if (wrap != Wrap::None) {
    for (const int uv : mesh.corner_uvs) {
      if (poll.after()) return interrupted();
      all_us.push_back(mesh.uvs[uv][0]);
      all_vs.push_back(mesh.uvs[uv][1]);
    }
  }
  const Axis u_axis = find_axis(std::move(all_us), closes_u(wrap), poll);
  const Axis v_axis = find_axis(std::move(all_vs), closes_v(wrap), poll);
  if (poll.after(0)) return interrupted();
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    if (poll.after(4)) return interrupted();
    for (const auto& [axis, value, name] :
         {std::tuple{&u_axis, us[vertex], 'u'}, std::tuple{&v_axis, vs[vertex], 'v'}}) {
      if (axis->count > 1 && !axis->is_even(value)) {
        return invalid(fmt::format(
            "vertex {} has {} = {}, which is more than {} of a spacing away from the even lattice "
            "of {} values {:.6g} apart",
            mesh.number_of(vertex), name, value, lattice_tolerance, axis->count, axis->spacing));
      }
    }
  }
  if (u_axis.nodes() < 3 || v_axis.nodes() < 3) {
    return invalid(
        fmt::format("the (u,v) values make a {}grid of {} x {} nodes, smaller than 3 x 3",
                    wrap == Wrap::None ? "" : "closed ", u_axis.nodes(), v_axis.nodes()));
  }
  // Of a closed grid the cause may be a pole, which is found first.
  const bool is_crowded = std::int64_t{u_axis.nodes()} * v_axis.nodes() > vertex_count;
  const auto too_few_vertices = [&] {
    return invalid(
        fmt::format("the (u,v) values make a grid of {} x {} nodes, more than the {} vertices",
                    u_axis.nodes(), v_axis.nodes(), vertex_count));
  };
  if (is_crowded && wrap == Wrap::None) return too_few_vertices();

  GridMapping mapping;
  mapping.grid = {u_axis.nodes(), v_axis.nodes(),   u_axis.spacing,
                  v_axis.spacing, u_axis.is_closed, v_axis.is_closed};
  const Grid& grid = mapping.grid;
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    if (poll.after(8)) return interrupted();
    const int vertex = mesh.corner_vertices[corner];
    const auto& [u, v] = mesh.uvs[mesh.corner_uvs[corner]];
    if (u_axis.node(u) != u_axis.node(us[vertex]) || v_axis.node(v) != v_axis.node(vs[vertex])) {
      return invalid(fmt::format("vertex {} has several (u,v), ({}, {}) and ({}, {}): a seam",
                                 mesh.number_of(vertex), us[vertex], vs[vertex], u, v));
    }
    if (!u_axis.is_even(u) || !v_axis.is_even(v)) {
      return invalid(fmt::format("vertex {} has (u,v) = ({}, {}), which is not on the even lattice",
                                 mesh.number_of(vertex), u, v));
    }
  }
  if (is_crowded) return too_few_vertices();

  const double joined = wrap == Wrap::None ? 0 : one_place_distance(mesh.positions);
  std::vector<int> node_vertices(grid.node_count(), -1);  // the first vertex of each node
  mapping.vertex_nodes.resize(vertex_count);
  mapping.rest.resize(grid.node_count(), 3);
  for (int vertex = 0; vertex < vertex_count; ++vertex) {
    if (poll.after(8)) return interrupted();
    const int node = grid.node(u_axis.index(us[vertex]), v_axis.index(vs[vertex]));
    mapping.vertex_nodes[vertex] = node;
    const int first = node_vertices[node];
    if (first < 0) {
      node_vertices[node] = vertex;
      mapping.rest.row(node) = mesh.positions.row(vertex);
    } else if (u_axis.nearest(us[first]) != u_axis.nearest(us[vertex]) ||
               v_axis.nearest(vs[first]) != v_axis.nearest(vs[vertex])) {
      const double apart = (mesh.positions.row(vertex) - mesh.positions.row(first)).norm();
      if (!(apart <= joined)) {
        return fail(ErrorCode::InvalidInput,
                    fmt::format("vertices {} and {}, with the (u,v) ({}, {}) and ({}, {}), are {} "
                                "apart, but wrap makes them one node; they must be within {} of "
                                "each other, 1e-6 of the bounding box's diagonal",
                                mesh.number_of(first), mesh.number_of(vertex), us[first], vs[first],
                                us[vertex], vs[vertex], apart, joined));
      }
    } else if (mesh.positions.row(vertex) != mesh.positions.row(first)) {
      return invalid(
          fmt::format("vertices {} and {} share the (u,v) ({}, {}) but not the rest "
                      "position",
                      mesh.number_of(first), mesh.number_of(vertex), us[vertex], vs[vertex]));
    }
  }
  for (int node = 0; node < grid.node_count(); ++node) {
    if (node_vertices[node] < 0) {
      const int i = node % grid.columns, j = node / grid.columns;
      return invalid(fmt::format(
          "there is no vertex at (u,v) = ({}, {}), node ({}, {}) of the grid of {} x {}",
          u_axis.least + i * grid.hu, v_axis.least + j * grid.hv, i, j, grid.columns, grid.rows));
    }
  }
  if (auto round = check_poles(mesh, mapping, node_vertices); !round) return fail(round.error());
  if (seams == Seams::Open) return mapping;
  const auto pair = nodes_in_one_place(mapping, poll);
  if (poll.after(0)) return interrupted();
  if (pair) {
    const int first = node_vertices[(*pair)[0]], second = node_vertices[(*pair)[1]];
    return invalid(fmt::format(
        "vertices {} and {} are at the same position, but have the (u,v) ({}, {}) and ({}, {}): a "
        "seam",
        mesh.number_of(first), mesh.number_of(second), us[first], vs[first], us[second],
        vs[second]));
  }
  return mapping;
}

}  // namespace pliant
