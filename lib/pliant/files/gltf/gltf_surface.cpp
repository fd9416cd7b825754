#include "pliant/files/gltf/gltf_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/elementary.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/files/raw_bytes.hpp"
#include "pliant/files/single_precision.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

using Json = GltfBuffer::Json;
using Bounds = GltfBuffer::Bounds;
using Quaternion = std::array<double, 4>;  // x y z w

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

// The rotation of R = R_third R_second R_first.
Quaternion rotation_of(const Placement& placement) {
  Quaternion rotation = {0, 0, 0, 1};
  for (const int axis : axes(placement.order)) {
    const auto [sine, cosine] = sine_cosine_of_degrees(placement.rotate[axis] / 2);
    Quaternion about = {0, 0, 0, cosine};
    about[static_cast<std::size_t>(axis)] = sine;
    rotation = product(about, rotation);
  }
  return rotation;
}

void append(const Vector3d& vector, std::vector<float>& numbers) {
  for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(vector[k]));
}

// Of the two quaternions of a rotation, the one nearer to the last key, so that interpolation takes
// the shorter way.
void append(Quaternion rotation, std::vector<float>& numbers) {
  double dot = 0;
  for (std::size_t k = 0; k < 4 && numbers.size() >= 4; ++k)
    dot += rotation[k] * static_cast<double>(numbers[numbers.size() - 4 + k]);
  for (const double component : rotation)
    numbers.push_back(static_cast<float>(dot < 0 ? -component : component));
}

bool has_uvs(const GltfShape& shape) {
  return std::any_of(shape.uvs.begin(), shape.uvs.end(), [](int uv) { return uv >= 0; });
}

std::vector<float> uvs_of(const GltfShape& shape, const Mesh& mesh) {
  std::vector<float> numbers;
  numbers.reserve(2 * shape.uvs.size());
  for (const int uv : shape.uvs) {
    const std::array<double, 2> pair =
        uv < 0 ? std::array<double, 2>{0, 1} : mesh.uvs[static_cast<std::size_t>(uv)];
    numbers.push_back(static_cast<float>(pair[0]));
    numbers.push_back(static_cast<float>(1 - pair[1]));
  }
  return numbers;
}

// The hash of a target's numbers.
std::string name_of_shape(std::span<const float> positions, std::span<const float> normals) {
  HashStream hash;
  for (const auto numbers : {positions, normals}) hash.add(bytes_of(numbers));
  return to_text(hash.hash());
}

}  // namespace

bool GltfKeys::is_moving() const {
  for (std::size_t k = static_cast<std::size_t>(width); k < numbers.size(); ++k)
    if (numbers[k] != numbers[k - static_cast<std::size_t>(width)]) return true;
  return false;
}

GltfSurface::GltfSurface(const AnimatedSurface& surface, WrittenAs as, StopRequest should_stop)
    : name_(surface.name),
      written_(*surface.mesh),
      mesh_(written_.in_space(surface.is_mirrored)),
      as_(as),
      should_stop_(std::move(should_stop)),
      keys_{{"translation", 3}, {"rotation", 4}, {"scale", 3}} {}

Result<GltfSurface> GltfSurface::make(const AnimatedSurface& surface, WrittenAs as,
                                      const StopRequest& should_stop) {
  GltfSurface made(surface, as, should_stop);
  auto shape = make_gltf_shape(made.mesh_, should_stop);
  if (!shape) return fail(shape.error());
  made.shape_ = *std::move(shape);
  return made;
}

Result<void> GltfSurface::begin(const Field& rest, int frame, GltfBuffer& buffer) {
  const auto rows = to_single(rest, frame, mesh_.first_index);
  if (!rows) return fail(rows.error());
  base_.reserve(3 * shape_.source.size());
  for (const int vertex : shape_.source) {
    const auto row = rows->begin() + std::ptrdiff_t{3} * vertex;
    base_.insert(base_.end(), row, row + 3);
  }
  auto own_normals = normals_at(rest);
  if (!own_normals) return fail(own_normals.error());
  base_normals_ = *std::move(own_normals);

  const auto positions = buffer.add_vertices(base_, 3, Bounds::Written);
  if (!positions) return fail(positions.error());
  const auto normals = buffer.add_vertices(base_normals_, 3, Bounds::None);
  if (!normals) return fail(normals.error());
  attributes_ = {{"POSITION", *positions}, {"NORMAL", *normals}};
  if (has_uvs(shape_)) {
    const auto uvs = buffer.add_vertices(uvs_of(shape_, mesh_), 2, Bounds::None);
    if (!uvs) return fail(uvs.error());
    attributes_["TEXCOORD_0"] = *uvs;
  }
  for (GltfShape::Primitive& primitive : shape_.primitives) {
    const auto indices = buffer.add_indices(primitive.corners);
    if (!indices) return fail(indices.error());
    indices_.push_back(*indices);
    primitive.corners = {};
  }
  return {};
}

Result<std::vector<float>> GltfSurface::normals_at(const Field& positions) const {
  const auto normals = unit_normals(mesh_, positions, should_stop_);
  if (!normals) return fail(normals.error());
  StopPoll poll(should_stop_);
  std::vector<float> numbers;
  numbers.reserve(3 * shape_.normals.size());
  for (const int normal : shape_.normals) {
    if (poll.after(8)) return interrupted();
    append(normal < 0 ? Vector3d(0, 1, 0) : Vector3d(normals->row(normal)), numbers);
  }
  return numbers;
}

Result<void> GltfSurface::add(const SurfacePose& pose, int frame, GltfBuffer& buffer) {
  if (is_placed()) {
    auto held =
        check_placement(pose.placement, PlacementNumbers::Single, told_as(as_, name_), frame);
    if (!held) return held;
    append(pose.placement.translate, keys_[0].numbers);
    append(rotation_of(pose.placement), keys_[1].numbers);
    append(pose.is_shown ? pose.placement.scale : Vector3d(0, 0, 0), keys_[2].numbers);
    is_shown_.push_back(pose.is_shown);
  }
  // Offset from the base as written to the double position: the sum of base and offset is then as
  // accurate as an offset in single precision allows. It is 0 if the position rounds to the base;
  // otherwise the rounding error of the base would be an offset of every vertex that does not move.
  Field offsets(static_cast<Eigen::Index>(shape_.source.size()), 3);
  StopPoll poll(should_stop_);
  for (Eigen::Index row = 0; row < offsets.rows(); ++row) {
    if (poll.after(8)) return interrupted();
    for (int k = 0; k < 3; ++k) {
      const double position = pose.positions(shape_.source[static_cast<std::size_t>(row)], k);
      const float base = base_[static_cast<std::size_t>(3 * row + k)];
      offsets(row, k) =
          static_cast<float>(position) == base ? 0 : position - static_cast<double>(base);
    }
  }
  auto rounded = to_single(offsets, frame);
  if (!rounded) {  // report the mesh's own vertex if one is the cause
    const auto held = to_single(pose.positions, frame, mesh_.first_index);
    return fail(held ? rounded.error() : held.error());
  }
  auto own_normals = normals_at(pose.positions);
  if (!own_normals) return fail(own_normals.error());
  std::vector<float>& normals = *own_normals;
  for (std::size_t k = 0; k < normals.size(); ++k) normals[k] -= base_normals_[k];
  if (is_stopped(should_stop_)) return interrupted();

  if (std::ranges::all_of(*rounded, [](float number) { return number == 0; })) {
    target_of_frame_.push_back(-1);  // at rest
    return {};
  }
  // A frame may repeat any earlier one, as those of a loop do.
  const auto [shape, is_new] = target_of_shape_.try_emplace(name_of_shape(*rounded, normals),
                                                            static_cast<int>(targets_.size()));
  target_of_frame_.push_back(shape->second);
  if (!is_new) return {};
  const auto position_offsets = buffer.add_offsets(*rounded, Bounds::Written);
  if (!position_offsets) return fail(position_offsets.error());
  const auto normal_offsets = buffer.add_offsets(normals, Bounds::None);
  if (!normal_offsets) return fail(normal_offsets.error());
  targets_.push_back({frame, *position_offsets, *normal_offsets});
  return {};
}

Json GltfSurface::mesh(const std::function<std::size_t(const std::string*)>& material_of) const {
  const std::string unnamed;
  Json targets = Json::array(), names = Json::array();
  for (const Target& target : targets_) {
    targets.push_back({{"POSITION", target.positions}, {"NORMAL", target.normals}});
    names.push_back(fmt::format("frame {}", target.frame));
  }
  Json primitives = Json::array();
  for (std::size_t k = 0; k < shape_.primitives.size(); ++k) {
    const int material = shape_.primitives[k].material;
    const std::string& name =
        material < 0 ? unnamed : mesh_.materials.names[static_cast<std::size_t>(material)];
    Json primitive = {{"attributes", attributes_},
                      {"indices", indices_[k]},
                      {"material", material_of(as_ == WrittenAs::Collider ? nullptr : &name)}};
    if (!targets_.empty()) primitive["targets"] = targets;
    primitives.push_back(std::move(primitive));
  }
  Json mesh = {{"name", mesh_.object.empty() ? name_ : mesh_.object},
               {"primitives", std::move(primitives)}};
  if (!targets_.empty()) mesh["extras"]["targetNames"] = std::move(names);
  return mesh;
}

Json GltfSurface::node(std::size_t mesh_index) const {
  Json node = {{"name", name_}, {"mesh", mesh_index}};
  for (const GltfKeys& keys : keys_) {
    if (is_placed()) {
      node[keys.path] =
          std::vector<double>(keys.numbers.begin(), keys.numbers.begin() + keys.width);
    }
  }
  return node;
}

bool GltfSurface::is_animated() const {
  return !targets_.empty() || std::any_of(keys_.begin(), keys_.end(),
                                          [](const GltfKeys& keys) { return keys.is_moving(); });
}

Result<void> GltfSurface::animate(std::size_t node_index, std::size_t times, GltfBuffer& buffer,
                                  Json& animation) const {
  // A scale of 0 hides. It must not be gone to by shrinking.
  const bool is_switched =
      std::ranges::adjacent_find(is_shown_, std::not_equal_to<>()) != is_shown_.end();
  const auto add_channel = [&](std::string_view path, std::size_t values) {
    animation["channels"].push_back({{"sampler", animation["samplers"].size()},
                                     {"target", {{"node", node_index}, {"path", path}}}});
    animation["samplers"].push_back(
        {{"input", times},
         {"output", values},
         {"interpolation", is_switched && path == "scale" ? "STEP" : "LINEAR"}});
  };
  if (!targets_.empty()) {
    const auto weights = buffer.add_weights(target_of_frame_, static_cast<int>(targets_.size()));
    if (!weights) return fail(weights.error());
    add_channel("weights", *weights);
  }
  for (const GltfKeys& keys : keys_) {
    if (!keys.is_moving()) continue;
    const auto values = buffer.add_keys(keys.numbers, keys.width, Bounds::None);
    if (!values) return fail(values.error());
    add_channel(keys.path, *values);
  }
  return {};
}

}  // namespace pliant
