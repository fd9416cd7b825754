#include "pliant/sampling/shape_shelf.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "pliant/core/hash.hpp"
#include "pliant/core/shelf.hpp"

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

bool is_same(const Hold& a, const Hold& b) {
  return std::tie(a.file, a.attribute, a.above, a.vertices, a.values) ==
         std::tie(b.file, b.attribute, b.above, b.vertices, b.values);
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
         std::equal(a.holds.begin(), a.holds.end(), b.holds.begin(), b.holds.end(),
                    [](const Hold& x, const Hold& y) { return is_same(x, y); }) &&
         a.material.damping_ratio.has_value() == b.material.damping_ratio.has_value() &&
         a.solver.reference == b.solver.reference &&
         a.solver.edges.are_clamped() == b.solver.edges.are_clamped();
}

struct ShapeItem final : Shelf::Item {
  Surface surface;
  std::string root;  // as in SceneOrigin
  RestShape shape;
  std::size_t bytes = 0;
};

}  // namespace

Result<ReservedShape> find_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  // A mesh made by a program is not compared.
  if (!context.shelf || std::holds_alternative<Mesh>(surface.shape))
    return make_rest_shape(surface, origin, context);
  const Hash key = hash_of(surface.name);
  const auto found = context.shelf->find<ShapeItem>(key, [&](const ShapeItem& one) {
    return one.root == origin.root && has_same_shape(one.surface, surface);
  });
  if (found) {
    MemoryShare memory(context.memory);
    if (memory.try_resize(found->bytes)) return ReservedShape{found->shape, std::move(memory)};
    // Making it tells what does not fit.
  }
  auto made = make_rest_shape(surface, origin, context);
  if (made && !found) {
    auto shape = std::make_shared<ShapeItem>();
    shape->surface = surface;
    shape->surface.cache = {};  // is not compared, and may be large
    shape->root = origin.root;
    shape->shape = made->shape;
    shape->bytes = made->memory.bytes();
    const std::size_t bytes = shape->bytes;
    context.shelf->keep(key, std::move(shape), bytes);
  }
  return made;
}

}  // namespace pliant
