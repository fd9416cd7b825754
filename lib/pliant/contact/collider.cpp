#include "pliant/contact/collider.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pliant {
namespace {

Vector3d mix(const Vector3d& first, const Vector3d& last, double a) {
  Vector3d between;
  for (int k = 0; k < 3; ++k)
    between[k] = first[k] == last[k] ? first[k] : (1 - a) * first[k] + a * last[k];
  return between;
}

Solid scaled(SphereSolid sphere, const Vector3d& scale) {
  sphere.radius *= std::abs(scale[0]);
  return sphere;
}
Solid scaled(CapsuleSolid capsule, const Vector3d& scale) {
  capsule.radius *= std::abs(scale[0]);
  capsule.length *= std::abs(scale[0]);
  return capsule;
}
Solid scaled(BoxSolid box, const Vector3d& scale) {
  for (int k = 0; k < 3; ++k) box.size[k] *= std::abs(scale[k]);
  return box;
}
Solid scaled(const PlaneSolid& plane, const Vector3d&) { return plane; }
Solid scaled(const MeshSolid& mesh, const Vector3d& scale) {
  return MeshSolid{PosedMesh::scaled(mesh.posed, scale)};
}

}  // namespace

Vector3d PlacedCollider::to_frame(const Vector3d& world) const {
  const Vector3d way = world - translation;
  Vector3d x;
  for (int k = 0; k < 3; ++k)
    x[k] = rotation(0, k) * way[0] + rotation(1, k) * way[1] + rotation(2, k) * way[2];
  return x;
}

Vector3d PlacedCollider::to_world(const Vector3d& x) const {
  return pliant::to_world({rotation, translation}, x);
}

Vector3d PlacedCollider::turned(const Vector3d& direction) const {
  return pliant::to_world({rotation, Vector3d::Zero()}, direction);
}

Placement between(const Placement& first, const Placement& last, double a) {
  return {mix(first.translate, last.translate, a), mix(first.rotate, last.rotate, a),
          mix(first.scale, last.scale, a), first.order};
}

bool has_moving_mesh(const SampledCollider& collider) {
  const auto* const first = std::get_if<MeshSolid>(&collider.first.shape);
  if (!first) return false;
  return collider.first.placement.scale != collider.last.placement.scale ||
         first->posed != std::get<MeshSolid>(collider.last.shape).posed;
}

double mesh_way_of(const SampledCollider& collider) {
  if (!has_moving_mesh(collider)) return 0;
  const Field& first = std::get<MeshSolid>(collider.first.shape).posed->points();
  const Field& last = std::get<MeshSolid>(collider.last.shape).posed->points();
  const Vector3d &from = collider.first.placement.scale, &to = collider.last.placement.scale;
  Vector3d most;
  for (int k = 0; k < 3; ++k) {
    const double largest = std::max(std::abs(from[k]), std::abs(to[k]));
    most[k] = largest * (last.col(k) - first.col(k)).cwiseAbs().maxCoeff() +
              std::abs(to[k] - from[k]) *
                  std::max(first.col(k).cwiseAbs().maxCoeff(), last.col(k).cwiseAbs().maxCoeff());
  }
  return length_of(most.transpose()) * (1 + 1e-9);
}

PlacedCollider placed(const SampledCollider& collider, double a) {
  const auto& [first, last] = std::tie(collider.first, collider.last);
  const Placement placement = between(first.placement, last.placement, a);
  const Transform frame =
      make_transform(placement.translate, placement.rotate, {1, 1, 1}, placement.order);
  const Solid shape = between(first.shape, last.shape, a);
  const double offset =
      first.offset == last.offset ? first.offset : (1 - a) * first.offset + a * last.offset;
  return {
      frame.linear,
      frame.translation,
      {std::visit([&](const auto& kind) { return scaled(kind, placement.scale); }, shape), offset},
      a * mesh_way_of(collider)};
}

}  // namespace pliant
