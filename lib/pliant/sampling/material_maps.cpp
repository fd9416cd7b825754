#include "pliant/sampling/material_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
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

// Where the values of a map or a hold come from: exactly one is not empty.
struct ValueSource {
  const std::string& file;
  const std::string& attribute;
  const std::vector<double>& values;
  std::string part;       // its name among the parts of its surface
  std::string_view what;  // "map"
};

// An error that names a file keeps it; the scene's place comes before.
Error at_part(const Surface& surface, const SceneOrigin& origin, Error error,
              const std::string& part, const std::string& attribute = {}) {
  if (error.code == ErrorCode::Interrupted) return error;
  const std::string file = error.file.empty() ? "" : error.file + ": ";
  error.message = fmt::format("{}.{}: {}{}", surface.name, part, file, error.message);
  const std::string path = fmt::format("{}.{}", surface.name, part);
  return origin.located(std::move(error), attribute.empty() ? origin.at(surface.name, part)
                                                            : origin.at(path, attribute));
}

// Reads the values of one map or hold after the other.
class MapReader {
 public:
  MapReader(const Surface& surface, const RestShape& shape, const SceneOrigin& origin,
            const std::function<Result<void>(std::size_t)>& take, const StopRequest& should_stop)
      : surface_(surface), shape_(shape), origin_(origin), take_(take), should_stop_(should_stop) {}

  // The factors of one map, by node.
  Result<std::vector<double>> read(const MaterialMap& map) {
    auto values =
        read(ValueSource{map.file, map.attribute, map.values, name_of(map.channel), "map"});
    if (!values) return values;
    for (double& value : *values) value = map.low + (map.high - map.low) * value;
    return values;
  }

  // Marks the nodes of one hold.
  Result<void> mark(const Hold& hold, const std::string& part, NodeMarks& marks) {
    if (!hold.vertices.empty()) return mark_vertices(hold.vertices, part, marks);
    const auto values = read(ValueSource{hold.file, hold.attribute, hold.values, part, "hold"});
    if (!values) return fail(values.error());
    bool is_any = false;
    for (std::size_t node = 0; node < values->size(); ++node) {
      if (!((*values)[node] > hold.above)) continue;
      marks[node] = 1;
      is_any = true;
    }
    if (is_any) return {};
    const auto [least, most] = std::ranges::minmax(*values);
    return fail(at_part({.code = ErrorCode::InvalidInput,
                         .message = fmt::format("no node is above {}: the values go from {} to {}",
                                                hold.above, least, most)},
                        part));
  }

 private:
  int node_count() const { return static_cast<int>(shape_.rest.rows()); }

  // The values of a source, by node.
  Result<std::vector<double>> read(const ValueSource& source) {
    if (auto taken = take_(static_cast<std::size_t>(node_count()) * sizeof(double)); !taken)
      return fail(taken.error());
    auto values = values_of(source);
    if (!values) return fail(at_part(values.error(), source.part));
    return values;
  }

  Result<void> mark_vertices(const std::vector<int>& vertices, const std::string& part,
                             NodeMarks& marks) const {
    const bool is_net = std::holds_alternative<NurbsNet>(surface_.shape);
    const std::size_t count = is_net ? marks.size() : shape_.vertex_nodes.size();
    for (const int vertex : vertices) {
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= count)
        return fail(at_part(
            {.code = ErrorCode::InvalidInput,
             .message = fmt::format("there is no {0} {1}: the surface has {2}, from 0 to {3}",
                                    is_net ? "point" : "vertex", vertex, count, count - 1)},
            part, "vertices"));
      const int node = is_net ? vertex : shape_.vertex_nodes[static_cast<std::size_t>(vertex)];
      if (node >= 0) marks[static_cast<std::size_t>(node)] = 1;  // another one never moves
    }
    return {};
  }

  Result<std::vector<double>> values_of(const ValueSource& source) {
    if (!source.values.empty()) return of_program(source);
    if (!source.attribute.empty()) return of_attribute(source.attribute);
    const auto opened = OpenFile::open(source.file, origin_.root);
    if (!opened) return fail(opened.error());
    if (auto taken = take_(static_cast<std::size_t>(opened->size())); !taken)
      return fail(taken.error());
    const auto bytes = read_file(*opened, largest_map_file, should_stop_);
    if (!bytes) return fail(bytes.error());
    if (ending_of(source.file) == ".npy") return of_npy(*bytes, source.file);
    return of_picture(*bytes, source.file);
  }

  Result<std::vector<double>> of_npy(const std::string& bytes, const std::string& file) const {
    if (const auto* const sheet = std::get_if<GridSheet>(&surface_.shape)) {
      auto values = parse_npy_grid(bytes, file, sheet->columns, sheet->rows, should_stop_);
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

  Result<std::vector<double>> of_program(const ValueSource& source) const {
    const std::vector<double>& values = source.values;
    const bool is_net = std::holds_alternative<NurbsNet>(surface_.shape);
    const std::size_t count =
        is_net ? static_cast<std::size_t>(node_count()) : shape_.vertex_nodes.size();
    if (values.size() != count)
      return invalid(fmt::format("the {} has {} values, but the surface has {} {}", source.what,
                                 values.size(), count, is_net ? "control points" : "vertices"));
    for (std::size_t k = 0; k < count; ++k) {
      if (!std::isfinite(values[k]))
        return invalid(fmt::format("value {} of the {} is {}, which is not finite", k, source.what,
                                   values[k]));
    }
    if (is_net) return values;
    return of_vertices(values, fmt::format("the {}", source.what));
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

  Error at_part(Error error, const std::string& part, const std::string& attribute = {}) const {
    return pliant::at_part(surface_, origin_, std::move(error), part, attribute);
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
  for (const Hold& hold : surface.holds) {
    if (!hold.attribute.empty() && std::ranges::find(names, hold.attribute) == names.end())
      names.push_back(hold.attribute);
  }
  return names;
}

Error about_attribute(const Surface& surface, const SceneOrigin& origin, Error error,
                      std::string_view attribute) {
  const auto map = std::ranges::find(surface.maps, attribute, &MaterialMap::attribute);
  if (map != surface.maps.end())
    return at_part(surface, origin, std::move(error), name_of(map->channel), "attribute");
  const auto hold = std::ranges::find(surface.holds, attribute, &Hold::attribute);
  PLIANT_EXPECTS(hold != surface.holds.end());
  const auto index = static_cast<std::size_t>(hold - surface.holds.begin());
  return at_part(surface, origin, std::move(error), name_of_hold(index), "attribute");
}

std::string outside_unit_range(const MaterialMap& map, const MapSummary& summary) {
  const double scale = map.high - map.low;
  if (scale == 0) return {};
  constexpr double rounding = 1e-9;
  const auto is_within = [](double least, double most) {
    return least >= -rounding && most <= 1 + rounding;
  };
  double least = (summary.least - map.low) / scale, most = (summary.most - map.low) / scale;
  if (least > most) std::swap(least, most);
  if (is_within(least, most) || is_within(summary.least, summary.most)) return {};
  const bool is_bytes = least > -0.5 && most > 100 && most < 255.5;
  const std::string told = fmt::format(
      "the values of the map are {:.6g} to {:.6g}{}, and the channel is times {:.6g} to {:.6g}; ",
      least, most, is_bytes ? ", as of a picture of 0 to 255" : "", summary.least, summary.most);
  if (most <= 1 || least < 0) return told + "low and high are for 0 and 1";
  return told + fmt::format("high=\"{:.6g}\" makes them 0 to 1",
                            map.low + scale / (is_bytes ? 255 : most));
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

Result<NodeMarks> read_holds(const Surface& surface, const RestShape& shape,
                             const SceneOrigin& origin,
                             const std::function<Result<void>(std::size_t)>& take,
                             const StopRequest& should_stop) {
  NodeMarks marks(static_cast<std::size_t>(shape.rest.rows()), 0);
  MapReader reader(surface, shape, origin, take, should_stop);
  for (std::size_t k = 0; k < surface.holds.size(); ++k) {
    if (auto marked = reader.mark(surface.holds[k], name_of_hold(k), marks); !marked)
      return fail(marked.error());
  }
  return marks;
}

}  // namespace pliant
