#include "pliant/sampling/shape_shelf.hpp"

#include <algorithm>
#include <tuple>
#include <utility>
#include <variant>

namespace pliant {
namespace {

// Whether two shapes are read and made from the same values.

bool is_same(const GridSheet& a, const GridSheet& b) {
  return std::tie(a.columns, a.rows, a.width, a.depth, a.triangles) ==
         std::tie(b.columns, b.rows, b.width, b.depth, b.triangles);
}

bool is_same(const MeshFile& a, const MeshFile& b) {
  return std::tie(a.path, a.object, a.uv_set, a.root) ==
         std::tie(b.path, b.object, b.uv_set, b.root);
}

bool is_same(const NurbsDirection& a, const NurbsDirection& b) {
  return std::tie(a.count, a.degree, a.is_closed, a.knots, a.samples) ==
         std::tie(b.count, b.degree, b.is_closed, b.knots, b.samples);
}

bool is_same(const NurbsNet& a, const NurbsNet& b) {
  return is_same(a.u, b.u) && is_same(a.v, b.v) && a.weights == b.weights &&
         a.points.rows() == b.points.rows() && a.points == b.points;
}

bool is_same(const Mesh&, const Mesh&) { return false; }  // not kept

bool is_same(const SurfaceShape& a, const SurfaceShape& b) {
  return a.index() == b.index() && std::visit(
                                       [&](const auto& own) {
                                         using Shape = std::decay_t<decltype(own)>;
                                         return is_same(own, std::get<Shape>(b));
                                       },
                                       a);
}

bool is_same(const MaterialMap& a, const MaterialMap& b) {
  return std::tie(a.channel, a.file, a.attribute, a.low, a.high, a.values) ==
         std::tie(b.channel, b.file, b.attribute, b.low, b.high, b.values);
}

bool is_same(const MeshReading& a, const MeshReading& b) {
  return std::tie(a.uv, a.wrap, a.unit, a.axis, a.border, a.weld) ==
         std::tie(b.uv, b.wrap, b.unit, b.axis, b.border, b.weld);
}

// All that `make_rest_shape` reads of a surface.
bool has_same_shape(const Surface& a, const Surface& b) {
  return a.name == b.name && a.is_driven() == b.is_driven() && is_same(a.shape, b.shape) &&
         is_same(a.reading, b.reading) && a.subdivision == b.subdivision &&
         std::equal(a.maps.begin(), a.maps.end(), b.maps.begin(), b.maps.end(),
                    [](const MaterialMap& x, const MaterialMap& y) { return is_same(x, y); }) &&
         a.material.damping_ratio.has_value() == b.material.damping_ratio.has_value() &&
         a.solver.reference == b.solver.reference &&
         a.solver.edges.are_clamped() == b.solver.edges.are_clamped();
}

}  // namespace

ShapeShelf::Kept ShapeShelf::find(const Surface& surface) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return has_same_shape(kept.surface, surface);
  });
  if (found == kept_.end()) return {};
  std::rotate(kept_.begin(), found, found + 1);
  return kept_.front();
}

void ShapeShelf::keep(Kept kept) {
  if (kept.bytes > max_bytes_) return;
  const std::lock_guard lock(mutex_);
  std::erase_if(kept_,
                [&](const Kept& other) { return has_same_shape(other.surface, kept.surface); });
  kept_.insert(kept_.begin(), std::move(kept));
  std::size_t bytes = 0;
  const auto first_gone = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) {
    bytes += one.bytes;
    return bytes > max_bytes_;
  });
  kept_.erase(first_gone, kept_.end());
}

Result<ReservedShape> ShapeShelf::make(const Surface& surface, const SceneOrigin& origin,
                                       const RunContext& context) {
  if (std::holds_alternative<Mesh>(surface.shape)) return make_rest_shape(surface, origin, context);
  if (const Kept kept = find(surface); kept.shape) {
    MemoryShare memory(context.memory);
    if (memory.try_resize(kept.bytes)) return ReservedShape{*kept.shape, std::move(memory)};
    // Making it tells what does not fit.
  }
  auto made = make_rest_shape(surface, origin, context);
  if (made) keep({surface, std::make_shared<const RestShape>(made->shape), made->memory.bytes()});
  return made;
}

}  // namespace pliant
