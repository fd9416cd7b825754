#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pliant/contact/collider.hpp"
#include "support/meshes.hpp"
#include "support/moving_scene.hpp"
#include "support/scenes.hpp"

namespace pliant::testing {

inline Collider collider(const std::string& name, TransformChannels transform) {
  Collider made;
  made.name = name;
  made.transform = std::move(transform);
  return made;
}

inline Collider ball_on_keys(double radius, std::vector<std::pair<double, Value<3>>> keys) {
  Collider made = collider("ball", {.translate = vector_curve(std::move(keys))});
  made.shape = SphereChannels{.radius = radius};
  return made;
}

inline Collider floor_at(double height) {
  Collider made = collider("floor", {.translate = Value<3>{0, height, 0}});
  made.shape = PlaneChannels{};
  return made;
}

// A sheet from -6 to 6 that is solved as a whole.
inline Surface wide_mat(const std::string& name = "s") {
  Surface surface = light(sheet(name));
  surface.material.density = 0.002;
  surface.material.damping = 0.001;
  return surface;
}

inline Surface wide_skin() {
  Surface surface = light_skin(square(12, 12, 0.2));
  surface.material.density = 0.002;
  surface.material.damping = 0.001;
  return surface;
}

inline Force weight_of(double magnitude) {
  Force force;
  force.name = "gravity";
  force.magnitude = magnitude;
  force.deformation_radius = force.force_radius = 100;
  force.kind = UniformChannels{.direction = Value<3>{0, -1, 0}};
  return force;
}

inline Scene met_scene(Surface surface, std::vector<Collider> colliders,
                       std::vector<Force> forces = {}) {
  Scene made = scene({std::move(surface)}, std::move(forces));
  made.colliders = std::move(colliders);
  return made;
}

inline SampledCollider standing(const Collider& of, double frame) {
  ColliderPose pose{SphereSolid{1}, of.transform.placement_at(frame), of.offset.at(frame)[0]};
  if (const auto* const sphere = std::get_if<SphereChannels>(&of.shape))
    pose.shape = SphereSolid{sphere->radius.at(frame)[0]};
  if (const auto* const capsule = std::get_if<CapsuleChannels>(&of.shape))
    pose.shape = CapsuleSolid{capsule->radius.at(frame)[0], capsule->length.at(frame)[0]};
  if (const auto* const box = std::get_if<BoxChannels>(&of.shape)) {
    const Value<3> size = box->size.at(frame);
    pose.shape = BoxSolid{{size[0], size[1], size[2]}, box->round.at(frame)[0]};
  }
  if (std::holds_alternative<PlaneChannels>(of.shape)) pose.shape = PlaneSolid{};
  return {pose, pose, 0};
}

// How deep the deepest of the vertices is in a collider that is where it is at a frame.
inline double depth_in(const Collider& of, double frame, const Field& positions) {
  const PlacedCollider one = placed(standing(of, frame), 0);
  double deepest = -1e300;
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const Vector3d p = positions.row(k).transpose();
    deepest = std::max(deepest, -nearness(one.kept, one.to_frame(p)).distance);
  }
  return deepest;
}

inline std::vector<Field> frames_met(const Scene& scene) { return baked(scene, "s"); }

// Solids that dip into the middle of the mat, and leave it again.
inline std::vector<Collider> dippers() {
  const TransformChannels dip{
      .translate = vector_curve({{1, {0.2, 3, -0.3}}, {5, {0.6, -0.8, 0.2}}, {12, {-1, 4, 0}}}),
      .rotate = vector_curve({{1, {0, 0, 10}}, {12, {40, 90, -20}}})};
  std::vector<Collider> all(4, collider("dip", dip));
  all[0].shape = SphereChannels{.radius = 1.4};
  all[1].shape = CapsuleChannels{.radius = 0.9, .length = curve({{1, 1}, {8, 3}})};
  all[2].shape = BoxChannels{.size = Value<3>{3, 1, 2}, .round = 0.2};
  all[3].shape = BoxChannels{.size = Value<3>{3, 1, 2}};
  for (Collider& one : all) one.offset = 0.05;
  return all;
}

}  // namespace pliant::testing
