#include "pliant/sampling/shape_shelf.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

#include "pliant/core/hash.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/mesh/written/binding.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/memory.hpp"
#include "pliant/sampling/read_files.hpp"

namespace pliant {
namespace {

// All that `make_rest_shape` reads of a surface.
bool has_same_shape(const Surface& a, const Surface& b) {
  return a.name == b.name && a.is_driven() == b.is_driven() && a.shape == b.shape &&
         a.reading == b.reading && a.subdivision == b.subdivision && a.maps == b.maps &&
         a.holds == b.holds &&
         a.material.damping_ratio.has_value() == b.material.damping_ratio.has_value() &&
         a.solver.reference == b.solver.reference &&
         a.solver.edges.are_clamped() == b.solver.edges.are_clamped();
}

struct ShapeItem final : Shelf::Item {
  Surface surface;
  std::string root;  // as in SceneOrigin
  ReadFiles files;
  RestShape shape;
  std::size_t bytes = 0;
};

// What `bind_to_driver` binds: points in the world, to the triangles of a driver.
struct BindingInputs {
  const Surface& driving;
  const RestShape& driver;
  const Field& nodes;  // of the driver, at the scene's start
  Transform transform;
  Field points;
};

struct BindingItem final : Shelf::Item {
  explicit BindingItem(const BindingInputs& of)
      : driving(of.driving),
        driver(of.driver.mesh),
        nodes(of.nodes),
        transform(of.transform),
        points(of.points) {
    driving.cache = {};  // the nodes are at one frame
  }

  bool is_of(const BindingInputs& of) const {
    return has_same_shape(driving, of.driving) && transform.linear == of.transform.linear &&
           transform.translation == of.transform.translation && is_same(nodes, of.nodes) &&
           is_same(points, of.points) && driver == of.driver.mesh;
  }

  static bool is_same(const Field& a, const Field& b) { return a.rows() == b.rows() && a == b; }

  Surface driving;
  Mesh driver;
  Field nodes;
  Transform transform;
  Field points;
  std::shared_ptr<const Binding> binding;
  std::size_t bytes = 0;  // that binding takes of the driven surface's share
};

}  // namespace

Result<ReservedShape> find_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context) {
  if (!context.shelf) return make_rest_shape(surface, origin, context);
  const Hash key = hash_of(surface.name);
  const auto found = context.shelf->find<ShapeItem>(key, [&](const ShapeItem& one) {
    return one.root == origin.root && has_same_shape(one.surface, surface) &&
           one.files.are_unchanged();
  });
  if (found) {
    MemoryShare memory(context.memory);
    if (memory.try_resize(found->bytes)) return ReservedShape{found->shape, std::move(memory)};
    // Making it tells what does not fit.
  }
  ReadFiles files(inputs_of_shape(surface, origin, context.should_stop));
  auto made = make_rest_shape(surface, origin, context);
  if (made && !found) {
    auto shape = std::make_shared<ShapeItem>();
    shape->surface = surface;
    shape->surface.cache = {};  // is not compared, and may be large
    shape->root = origin.root;
    shape->files = std::move(files);
    shape->shape = made->shape;
    shape->bytes = made->memory.bytes();
    const auto* const mesh = std::get_if<Mesh>(&surface.shape);
    const std::size_t bytes = shape->bytes + (mesh ? bytes_of(*mesh) : 0);
    context.shelf->keep(key, std::move(shape), bytes);
  }
  return made;
}

Result<void> find_binding(ReservedShape& driven, const Surface& own, const RestShape& driver,
                          const Surface& driving, const Scene& scene, const RunContext& context) {
  const auto bind = [&] {
    return bind_to_driver(driven, own, driver, driving, scene, context.should_stop);
  };
  if (!context.shelf) return bind();
  std::shared_ptr<const Field> posed;
  if (driver.animation) {
    auto nodes = driver.animation->nodes_at(scene.start);
    if (!nodes) return fail(nodes.error());
    posed = *std::move(nodes);
  }
  const BindingInputs inputs{driving, driver, posed ? *posed : driver.rest,
                             driving.transform.at(scene.start),
                             to_world(own.transform.at(scene.start), driven.shape.mesh.positions)};
  const Hash key = hash_of(own.name);
  const auto found = context.shelf->find<BindingItem>(
      key, [&](const BindingItem& one) { return one.is_of(inputs); });
  const std::size_t before = driven.memory.bytes();
  if (found && driven.memory.try_resize(before + found->bytes)) {
    driven.shape.binding = found->binding;
    return {};
  }
  if (auto bound = bind(); !bound || found) return bound;
  auto item = std::make_shared<BindingItem>(inputs);
  item->binding = driven.shape.binding;
  item->bytes = driven.memory.bytes() - before;
  // The driver's mesh may also be in its surface.
  const std::size_t bytes = item->bytes + 2 * bytes_of(driver.mesh) + bytes_of(driven.shape.mesh);
  context.shelf->keep_instead(key, std::move(item), bytes);
  return {};
}

}  // namespace pliant
