#include "pliant/scene/collider_mesh.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/memory_budget.hpp"

namespace pliant {
namespace {

// Round edges add no length, so that what is left of a box of round edges only is 0.
Vector3d half_within(const Vector3d& size, double round) {
  return (size / 2 - Vector3d::Constant(round)).cwiseMax(0);
}

// Without a scale. A plane has none.
SolidLengths lengths_at(const Collider& collider, int frame) {
  struct At {
    int frame;

    SolidLengths operator()(const SphereChannels& sphere) const {
      return {.radius = sphere.radius.at(frame)[0]};
    }
    SolidLengths operator()(const CapsuleChannels& capsule) const {
      return {.half = {0, capsule.length.at(frame)[0] / 2, 0},
              .radius = capsule.radius.at(frame)[0]};
    }
    SolidLengths operator()(const BoxChannels& box) const {
      const Value<3> size = box.size.at(frame);
      const double round = box.round.at(frame)[0];
      return {.half = half_within({size[0], size[1], size[2]}, round), .radius = round};
    }
    SolidLengths operator()(const PlaneChannels&) const { return {}; }
  };
  return std::visit(At{frame}, collider.shape);
}

bool is_sharp(const BoxChannels& box) { return box.round == Channel<1>(0); }

bool targets_one_of(const Collider& collider, const std::set<std::string_view>& surfaces) {
  return collider.targets.empty() ||
         std::ranges::any_of(collider.targets,
                             [&](const std::string& target) { return surfaces.contains(target); });
}

}  // namespace

std::optional<ColliderMesh> ColliderMesh::make(const Collider& collider, int first_frame) {
  const SolidLengths first = lengths_at(collider, first_frame);
  struct Make {
    const SolidLengths& first;

    std::optional<SolidMesh> operator()(const SphereChannels&) const {
      return make_ball_mesh(first.radius);
    }
    std::optional<SolidMesh> operator()(const CapsuleChannels&) const {
      return make_capsule_mesh(first);
    }
    std::optional<SolidMesh> operator()(const BoxChannels& box) const {
      return is_sharp(box) ? make_sharp_box_mesh(first.half) : make_round_box_mesh(first);
    }
    std::optional<SolidMesh> operator()(const PlaneChannels&) const { return std::nullopt; }
  };
  auto solid = std::visit(Make{first}, collider.shape);
  if (!solid) return std::nullopt;
  ColliderMesh made(collider, *std::move(solid), first);
  made.solid_.mesh.positions = made.at(first_frame).positions;
  return made;
}

bool ColliderMesh::moves_points() const {
  if (const auto* const capsule = std::get_if<CapsuleChannels>(&collider_->shape))
    return capsule->radius.is_animated() || capsule->length.is_animated();
  const auto* const box = std::get_if<BoxChannels>(&collider_->shape);
  return box && !is_sharp(*box) &&
         (box->size.is_animated() || box->round.is_animated() ||
          collider_->transform.scale.is_animated());
}

SurfacePose ColliderMesh::at(int frame) const {
  SurfacePose pose{.positions = {},
                   .placement = collider_->transform.placement_at(frame),
                   .is_shown = collider_->enabled.at(frame)};
  const SolidLengths lengths = lengths_at(*collider_, frame);
  Vector3d& scale = pose.placement.scale;
  scale = scale.cwiseAbs();
  const auto* const box = std::get_if<BoxChannels>(&collider_->shape);
  if (box && is_sharp(*box)) {
    pose.positions = solid_.positions(first_);
    scale = scale.cwiseProduct(lengths.half).cwiseQuotient(first_.half);
  } else if (box) {
    const Value<3> size = box->size.at(frame);
    const Vector3d scaled = scale.cwiseProduct(Vector3d(size[0], size[1], size[2]));
    pose.positions = solid_.positions({half_within(scaled, lengths.radius), lengths.radius});
    scale = Vector3d::Ones();
  } else if (std::holds_alternative<SphereChannels>(collider_->shape)) {
    pose.positions = solid_.positions(first_);
    scale *= lengths.radius / first_.radius;
  } else {
    pose.positions = solid_.positions(lengths);
  }
  return pose;
}

Result<ColliderMeshes> ColliderMeshes::make(const Scene& scene, const AnimationPlan& plan,
                                            std::size_t free_memory) {
  ColliderMeshes made;
  if (!contains_colliders(plan.file)) return made;
  std::set<std::string_view> surfaces;
  for (const AnimatedSurface& surface : plan.surfaces) surfaces.insert(surface.name);
  for (const Collider& collider : scene.colliders) {
    if (!targets_one_of(collider, surfaces)) continue;
    auto mesh = ColliderMesh::make(collider, plan.first_frame);
    if (!mesh) continue;
    made.meshes_.push_back(*std::move(mesh));
    if (made.meshes_.size() <= free_memory / ColliderMesh::most_bytes) continue;
    return fail(ErrorCode::OutOfMemory,
                fmt::format("{}: the colliders need more than the {} left of --max-memory to be "
                            "written; pliant bake --no-colliders leaves them out",
                            plan.file, bytes_text(free_memory)));
  }
  return made;
}

std::vector<AnimatedSurface> ColliderMeshes::surfaces() const {
  std::vector<AnimatedSurface> surfaces;
  for (const ColliderMesh& mesh : meshes_) {
    surfaces.push_back(
        {.name = mesh.collider().name, .mesh = &mesh.mesh(), .rest = mesh.mesh().positions});
  }
  return surfaces;
}

std::vector<SurfacePose> ColliderMeshes::at(int frame) const {
  std::vector<SurfacePose> poses;
  for (const ColliderMesh& mesh : meshes_) poses.push_back(mesh.at(frame));
  return poses;
}

}  // namespace pliant
