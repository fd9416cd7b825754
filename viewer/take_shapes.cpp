#include "viewer/take_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "pliant/core/hash.hpp"
#include "viewer/mesh_order.hpp"

namespace pliant::viewer {
namespace {

std::string_view bytes_of(std::span<const std::uint32_t> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

// All surfaces of a frame as one mesh, neighbours next to each other as far as possible.
struct Whole {
  Field positions;                       // #vertices x 3, world space
  Field rest;                            // #vertices x 3, at rest and in object space
  std::vector<double> displaced;         // #vertices: |x - r|, object space
  std::vector<std::uint32_t> triangles;  // three vertices each
};

Whole whole_of(const Simulation& simulation, const Frame& frame) {
  Whole whole;
  Eigen::Index count = 0;
  for (const RestShape& shape : simulation.rest_shapes()) count += shape.mesh.positions.rows();
  whole.positions.resize(count, 3);
  whole.rest.resize(count, 3);
  whole.displaced.resize(static_cast<std::size_t>(count));
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < frame.surfaces().size(); ++k) {
    const SurfaceFrame& surface = frame.surfaces()[k];
    const RestShape& shape = simulation.rest_shapes()[k];
    const Field world = surface.positions();
    const Field& now = surface.object_positions();
    const Field& still = shape.mesh.positions;
    const Field& rest = surface.object_rest().rows() > 0 ? surface.object_rest() : still;
    const std::vector<int> order = node_order(shape.vertex_nodes);
    std::vector<std::uint32_t> place_of(order.size());
    for (std::size_t place = 0; place < order.size(); ++place) {
      const Eigen::Index row = first + static_cast<Eigen::Index>(place);
      const Eigen::Index vertex = order[place];
      place_of[static_cast<std::size_t>(vertex)] = static_cast<std::uint32_t>(row);
      whole.positions.row(row) = world.row(vertex);
      whole.rest.row(row) = still.row(vertex);
      whole.displaced[static_cast<std::size_t>(row)] = (now.row(vertex) - rest.row(vertex)).norm();
    }
    const std::size_t first_corner = whole.triangles.size();
    for (const std::uint32_t vertex : triangle_vertices(shape.mesh))
      whole.triangles.push_back(place_of[vertex]);
    if (surface.transform().is_mirrored()) {  // as the writers turn them
      for (std::size_t k = first_corner; k < whole.triangles.size(); k += 3)
        std::swap(whole.triangles[k + 1], whole.triangles[k + 2]);
    }
    first += still.rows();
  }
  return whole;
}

// Each index less that of the same corner one triangle before, which repeats along a grid's row.
std::vector<std::uint32_t> differences(std::vector<std::uint32_t> triangles) {
  for (std::size_t k = triangles.size(); k-- > 3;) triangles[k] -= triangles[k - 3];
  return triangles;
}

}  // namespace

std::shared_ptr<const CoarseMesh> TakeShapes::coarse(const Field& positions,
                                                     const std::vector<std::uint32_t>& triangles) {
  const std::string name = to_text(hash_of(positions)) + to_text(hash_of(bytes_of(triangles)));
  {
    const std::lock_guard lock(mutex_);
    if (const auto there = coarse_.find(name); there != coarse_.end()) return there->second;
  }
  auto made = std::make_shared<const CoarseMesh>(coarse_mesh(positions, triangles, most_vertices_));
  // Takes with meshes of their own would fill the memory.
  constexpr std::size_t most_kept = 8;
  const std::lock_guard lock(mutex_);
  if (coarse_.size() >= most_kept) coarse_.clear();
  coarse_[name] = made;
  return made;
}

Result<void> TakeShapes::add(std::size_t take, const Simulation& simulation, const Frame& frame) {
  const Whole whole = whole_of(simulation, frame);
  const auto coarse = this->coarse(whole.rest, whole.triangles);
  Shape shape{.frame = frame.number(), .vertex_count = static_cast<int>(whole.positions.rows())};
  shape.low = whole.positions.colwise().minCoeff();
  shape.high = whole.positions.colwise().maxCoeff();
  shape.origin = 0.5 * shape.low + 0.5 * shape.high;
  shape.most_displaced = *std::max_element(whole.displaced.begin(), whole.displaced.end());
  shape.shown = coarse->vertices.size();

  const auto rows = static_cast<Eigen::Index>(coarse->vertices.size());
  Field positions(rows, 3), origins(rows, 3);
  std::vector<int> order(coarse->vertices.size());
  std::iota(order.begin(), order.end(), 0);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const int vertex = coarse->vertices[static_cast<std::size_t>(row)];
    positions.row(row) = whole.positions.row(vertex);
    origins.row(row) = shape.origin.transpose();
    constexpr double greatest = 65535;
    const double share =
        shape.most_displaced > 0
            ? whole.displaced[static_cast<std::size_t>(vertex)] / shape.most_displaced
            : 0;
    const auto number = static_cast<unsigned>(std::lround(greatest * share));
    shape.displaced_low.push_back(static_cast<char>(number & 0xffU));
    shape.displaced_high.push_back(static_cast<char>(number >> 8U));
  }
  MotionPacker packer(std::move(origins), std::move(order));
  if (auto added = packer.add(positions, frame.number()); !added) return added;
  shape.motion = *packer.pack();

  const std::vector<std::uint32_t> stored = differences(coarse->triangles);
  std::string bytes(bytes_of(stored));
  shape.mesh = to_text(hash_of(bytes));
  const std::lock_guard lock(mutex_);
  meshes_.try_emplace(shape.mesh, std::move(bytes));
  shapes_.insert_or_assign(take, std::move(shape));
  return {};
}

Json TakeShapes::finish(Arrays& arrays) const {
  Json meshes = Json::array();
  std::map<std::string, std::size_t> numbers;
  for (const auto& [name, bytes] : meshes_) {
    numbers[name] = meshes.size();
    Json place = arrays.add(bytes);
    place["count"] = bytes.size() / sizeof(std::uint32_t);
    meshes.push_back(std::move(place));
  }
  Json takes = Json::array();
  for (const auto& [take, shape] : shapes_) {
    takes.push_back({{"take", take},
                     {"frame", shape.frame},
                     {"vertices", shape.vertex_count},
                     {"shown", shape.shown},
                     {"displaced", shape.most_displaced},
                     {"mesh", numbers[shape.mesh]},
                     {"origin", to_json(shape.origin)},
                     {"low", to_json(shape.low)},
                     {"high", to_json(shape.high)},
                     {"step", shape.motion.step},
                     {"predictors", arrays.add(shape.motion.predictors)},
                     {"lowBytes", arrays.add(shape.motion.low)},
                     {"highBytes", arrays.add(shape.motion.high)},
                     {"displacedLow", arrays.add(shape.displaced_low)},
                     {"displacedHigh", arrays.add(shape.displaced_high)}});
  }
  return {{"meshes", meshes}, {"takes", takes}};
}

}  // namespace pliant::viewer
