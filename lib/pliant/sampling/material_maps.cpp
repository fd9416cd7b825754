#include "pliant/sampling/material_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/files/npy/npy_grid.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/png/read_png.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

using Pair = std::array<double, 2>;

constexpr std::size_t largest_map_file = std::size_t{4} << 30;

// Reads one map after the other.
class MapReader {
 public:
  MapReader(const Surface& surface, const RestShape& shape, const SceneOrigin& origin,
            const std::function<Result<void>(std::size_t)>& take, const StopRequest& should_stop)
      : surface_(surface), shape_(shape), origin_(origin), take_(take), should_stop_(should_stop) {}

  // The factors of one map, by node.
  Result<std::vector<double>> read(const MaterialMap& map) {
    if (auto taken = take_(static_cast<std::size_t>(node_count()) * sizeof(double)); !taken)
      return fail(taken.error());
    auto values = values_of(map);
    if (!values) return fail(at_map(values.error(), map));
    for (double& value : *values) value = map.low + (map.high - map.low) * value;
    return values;
  }

 private:
  int node_count() const { return static_cast<int>(shape_.rest.rows()); }

  Result<std::vector<double>> values_of(const MaterialMap& map) {
    if (!map.values.empty()) return of_program(map.values);
    if (!map.attribute.empty()) return of_attribute(map.attribute);
    const auto opened = OpenFile::open(map.file, origin_.root);
    if (!opened) return fail(opened.error());
    if (auto taken = take_(static_cast<std::size_t>(opened->size())); !taken)
      return fail(taken.error());
    const auto bytes = read_file(*opened, largest_map_file, should_stop_);
    if (!bytes) return fail(bytes.error());
    if (ending_of(map.file) == ".npy") return of_npy(*bytes, map.file);
    return of_picture(*bytes, map.file);
  }

  Result<std::vector<double>> of_npy(const std::string& bytes, const std::string& file) const {
    if (const auto* const sheet = std::get_if<GridSheet>(&surface_.shape)) {
      const auto values = parse_npy_grid(bytes, file, sheet->columns, sheet->rows, should_stop_);
      if (!values || shape_.grid) return values;
      return of_vertices(*values, "the map");
    }
    if (!shape_.grid)
      return fail(ErrorCode::InvalidInput,
                  "a .npy has a number for each node of a grid, but the mesh is read as a surface",
                  file);
    return parse_npy_grid(bytes, file, shape_.grid->columns, shape_.grid->rows, should_stop_);
  }

  Result<std::vector<double>> of_picture(const std::string& bytes, const std::string& file) {
    const auto size = bytes_of_png(bytes);
    if (!size) return fail(ErrorCode::InvalidInput, size.error().message, file);
    if (auto taken = take_(*size); !taken) return fail(taken.error());
    const auto picture = parse_png(bytes, file, should_stop_);
    if (!picture) return fail(picture.error());
    const auto uvs = uvs_of_nodes();
    if (!uvs) return fail(uvs.error());
    std::vector<double> values;
    values.reserve(uvs->size());
    for (const auto& [u, v] : *uvs) values.push_back(picture->at(u, v));
    return values;
  }

  Result<std::vector<double>> of_program(const std::vector<double>& values) const {
    const bool is_net = std::holds_alternative<NurbsNet>(surface_.shape);
    const std::size_t count =
        is_net ? static_cast<std::size_t>(node_count()) : shape_.vertex_nodes.size();
    if (values.size() != count)
      return invalid(fmt::format("the map has {} values, but the surface has {} {}", values.size(),
                                 count, is_net ? "control points" : "vertices"));
    for (std::size_t k = 0; k < count; ++k) {
      if (!std::isfinite(values[k]))
        return invalid(fmt::format("value {} of the map is {}, which is not finite", k, values[k]));
    }
    if (is_net) return values;
    return of_vertices(values, "the map");
  }

  Result<std::vector<double>> of_attribute(const std::string& name) const {
    const auto& attributes = shape_.mesh.attributes;
    const auto found = std::ranges::find(attributes, name, &VertexAttribute::name);
    if (found == attributes.end())
      return invalid(fmt::format("the mesh has no attribute {}", printable(name)));
    return of_vertices(found->values, printable(name));
  }

  // Values at vertices as values at nodes.
  Result<std::vector<double>> of_vertices(const std::vector<double>& at_vertices,
                                          const std::string& name) const {
    std::vector<double> values(static_cast<std::size_t>(node_count()));
    const std::vector<int> lowest = lowest_vertices();
    for (std::size_t vertex = 0; vertex < shape_.vertex_nodes.size(); ++vertex) {
      const int node = shape_.vertex_nodes[vertex];
      if (node < 0) continue;
      const auto first = static_cast<std::size_t>(lowest[static_cast<std::size_t>(node)]);
      values[static_cast<std::size_t>(node)] = at_vertices[first];
      if (at_vertices[vertex] == at_vertices[first]) continue;
      return invalid(fmt::format(
          "{} is {} at vertex {} and {} at vertex {}, but both are one node, which has one value",
          name, at_vertices[first], shape_.mesh.number_of(static_cast<int>(first)),
          at_vertices[vertex], shape_.mesh.number_of(static_cast<int>(vertex))));
    }
    return values;
  }

  std::vector<int> lowest_vertices() const {
    std::vector<int> lowest(static_cast<std::size_t>(node_count()), -1);
    for (std::size_t vertex = 0; vertex < shape_.vertex_nodes.size(); ++vertex) {
      const int node = shape_.vertex_nodes[vertex];
      if (node >= 0 && lowest[static_cast<std::size_t>(node)] < 0)
        lowest[static_cast<std::size_t>(node)] = static_cast<int>(vertex);
    }
    return lowest;
  }

  // That of a node's lowest vertex, at its first corner; of a net its place among the points.
  Result<std::vector<Pair>> uvs_of_nodes() const {
    if (const auto* const net = std::get_if<NurbsNet>(&surface_.shape)) return uvs_of_net(*net);
    const Mesh& mesh = shape_.mesh;
    std::vector<int> first_uvs(static_cast<std::size_t>(mesh.vertex_count()), -2);
    for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
      int& first = first_uvs[static_cast<std::size_t>(mesh.corner_vertices[corner])];
      if (first == -2) first = mesh.corner_uvs[corner];
    }
    std::vector<Pair> uvs;
    for (const int vertex : lowest_vertices()) {
      const int uv = first_uvs[static_cast<std::size_t>(vertex)];
      if (uv < 0)
        return invalid(fmt::format("vertex {} has no (u,v), by which a picture is read",
                                   mesh.number_of(vertex)));
      uvs.push_back(mesh.uvs[static_cast<std::size_t>(uv)]);
    }
    return uvs;
  }

  std::vector<Pair> uvs_of_net(const NurbsNet& net) const {
    const auto share = [](int k, int count, bool is_closed) {
      return static_cast<double>(k) / (is_closed ? count : count - 1);
    };
    std::vector<Pair> uvs;
    for (int j = 0; j < net.v.count; ++j) {
      for (int i = 0; i < net.u.count; ++i)
        uvs.push_back(
            {share(i, net.u.count, net.u.is_closed), share(j, net.v.count, net.v.is_closed)});
    }
    return uvs;
  }

  // An error that names a file keeps it; the scene's place comes before.
  Error at_map(Error error, const MaterialMap& map) const {
    if (error.code == ErrorCode::Interrupted) return error;
    const std::string file = error.file.empty() ? "" : error.file + ": ";
    error.message =
        fmt::format("{}.{}: {}{}", surface_.name, name_of(map.channel), file, error.message);
    return origin_.located(std::move(error), origin_.at(surface_.name, name_of(map.channel)));
  }

  const Surface& surface_;
  const RestShape& shape_;
  const SceneOrigin& origin_;
  const std::function<Result<void>(std::size_t)>& take_;
  const StopRequest& should_stop_;
};

std::vector<double>& factors_of_channel(NodeFactors& factors, MapChannel channel) {
  switch (channel) {
    case MapChannel::Density:
      return factors.density;
    case MapChannel::Damping:
      return factors.damping;
    case MapChannel::B:
      return factors.b;
    case MapChannel::C:
      return factors.c;
    case MapChannel::D:
      return factors.d;
    case MapChannel::Yield:
      return factors.yield;
    case MapChannel::Hardening:
      return factors.hardening;
    default:
      return factors.goal;
  }
}

}  // namespace

std::vector<MapSummary> map_summaries_of(const RestShape& shape) {
  std::vector<MapSummary> summaries;
  if (!shape.factors) return summaries;
  NodeFactors factors = *shape.factors;
  for (std::size_t k = 0; k < std::size(map_channel_words); ++k) {
    const auto channel = static_cast<MapChannel>(k);
    const std::vector<double>& at_nodes = factors_of_channel(factors, channel);
    if (at_nodes.empty()) continue;
    const auto [least, most] = std::ranges::minmax(at_nodes);
    summaries.push_back({channel, least, most});
  }
  return summaries;
}

std::vector<std::string> attributes_of_maps(const Surface& surface) {
  std::vector<std::string> names;
  for (const MaterialMap& map : surface.maps) {
    if (!map.attribute.empty() && std::ranges::find(names, map.attribute) == names.end())
      names.push_back(map.attribute);
  }
  return names;
}

Result<NodeFactors> read_maps(const Surface& surface, const RestShape& shape,
                              const SceneOrigin& origin,
                              const std::function<Result<void>(std::size_t)>& take,
                              const StopRequest& should_stop) {
  NodeFactors factors;
  MapReader reader(surface, shape, origin, take, should_stop);
  for (const MaterialMap& map : surface.maps) {
    auto values = reader.read(map);
    if (!values) return fail(values.error());
    factors_of_channel(factors, map.channel) = *std::move(values);
  }
  return factors;
}

}  // namespace pliant
