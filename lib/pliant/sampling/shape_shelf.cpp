#include "pliant/sampling/shape_shelf.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

#include "pliant/core/hash.hpp"
#include "pliant/core/shelf.hpp"
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

}  // namespace pliant
