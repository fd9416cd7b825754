#include "pliant/sampling/drawn_collider.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/sampling/collider_mesh.hpp"
#include "pliant/sampling/sampling.hpp"

namespace pliant {
namespace {

SolidLengths lengths_of(const Solid& solid) {
  if (const auto* const sphere = std::get_if<SphereSolid>(&solid))
    return {.radius = sphere->radius};
  if (const auto* const capsule = std::get_if<CapsuleSolid>(&solid))
    return {.half = {0, capsule->length / 2, 0}, .radius = capsule->radius};
  const auto* const box = std::get_if<BoxSolid>(&solid);
  if (!box) return {};
  // Round edges add no length, so that what is left of a box of round edges only is 0.
  return {.half = (box->size / 2 - Vector3d::Constant(box->round)).cwiseMax(0),
          .radius = box->round};
}

// Without a scale. Neither a plane nor a mesh has any.
SolidLengths lengths_at(const Collider& collider, int frame) {
  const std::optional<Solid> shape = shape_at(collider, frame);
  return shape ? lengths_of(*shape) : SolidLengths{};
}

bool is_sharp(const BoxChannels& box) { return box.round == Channel<1>(0); }

bool targets_one_of(const Collider& collider, const std::set<std::string_view>& surfaces) {
  return collider.targets.empty() ||
         std::ranges::any_of(collider.targets,
                             [&](const std::string& target) { return surfaces.contains(target); });
}

}  // namespace

Result<std::optional<DrawnCollider>> DrawnCollider::make(const Collider& collider, int first_frame,
                                                         std::shared_ptr<const ColliderMesh> file) {
  const SolidLengths first = lengths_at(collider, first_frame);
  struct Make {
    const SolidLengths& first;
    const ColliderMesh* file;

    std::optional<DrawnSolid> operator()(const SphereChannels&) const {
      return make_ball_mesh(first.radius);
    }
    std::optional<DrawnSolid> operator()(const CapsuleChannels&) const {
      return make_capsule_mesh(first);
    }
    std::optional<DrawnSolid> operator()(const BoxChannels& box) const {
      return is_sharp(box) ? make_sharp_box_mesh(first.half) : make_round_box_mesh(first);
    }
    std::optional<DrawnSolid> operator()(const PlaneChannels&) const { return std::nullopt; }
    std::optional<DrawnSolid> operator()(const ClosedMesh&) const {
      PLIANT_EXPECTS(file != nullptr);
      return DrawnSolid{.mesh = file->drawn(), .directions = {}, .corners = {}};
    }
  };
  auto solid = std::visit(Make{first, file.get()}, collider.shape);
  if (!solid) return std::nullopt;
  DrawnCollider made(collider, *std::move(solid), first);
  made.file_ = std::move(file);
  auto pose = made.at(first_frame);
  if (!pose) return fail(pose.error());
  made.solid_.mesh.positions = std::move(pose->positions);
  return made;
}

bool DrawnCollider::moves_points() const {
  if (file_) return file_->is_animated();
  if (const auto* const capsule = std::get_if<CapsuleChannels>(&collider_->shape))
    return capsule->radius.is_animated() || capsule->length.is_animated();
  const auto* const box = std::get_if<BoxChannels>(&collider_->shape);
  return box && !is_sharp(*box) &&
         (box->size.is_animated() || box->round.is_animated() ||
          collider_->transform.scale.is_animated());
}

std::size_t DrawnCollider::bytes() const {
  constexpr std::size_t of_others = std::size_t{1} << 18U;
  // Points as the engine and as a writer have them, faces, and what they take on their way. Where
  // edges are hard a corner may have a normal and, in some formats, a point of its own.
  constexpr std::size_t of_point = 200, of_corner = 140;
  if (!file_) return of_others;
  return static_cast<std::size_t>(mesh().vertex_count()) * of_point +
         mesh().corner_vertices.size() * of_corner;
}

Placement DrawnCollider::placement_at(int frame) const {
  Placement placement = collider_->transform.placement_at(frame);
  Vector3d& scale = placement.scale;
  if (file_) return placement;
  scale = scale.cwiseAbs();
  if (const auto* const box = std::get_if<BoxChannels>(&collider_->shape)) {
    const Vector3d half = lengths_at(*collider_, frame).half;
    scale = is_sharp(*box) ? Vector3d(scale.cwiseProduct(half).cwiseQuotient(first_.half))
                           : Vector3d(Vector3d::Ones());
  } else if (std::holds_alternative<SphereChannels>(collider_->shape)) {
    scale *= lengths_at(*collider_, frame).radius / first_.radius;
  }
  return placement;
}

Result<Field> DrawnCollider::positions_at(int frame) const {
  if (file_) {
    const auto posed = file_->at(frame);
    if (!posed) return fail(posed.error());
    return (*posed)->points();
  }
  if (std::holds_alternative<CapsuleChannels>(collider_->shape))
    return solid_.positions(lengths_at(*collider_, frame));
  const auto* const box = std::get_if<BoxChannels>(&collider_->shape);
  if (!box || is_sharp(*box)) return solid_.positions(first_);
  return solid_.positions(lengths_of(*solid_at(*collider_, frame)));
}

Result<SurfacePose> DrawnCollider::at(int frame) const {
  auto positions = positions_at(frame);
  if (!positions) return fail(positions.error());
  return SurfacePose{.positions = *std::move(positions),
                     .placement = placement_at(frame),
                     .is_shown = collider_->enabled.at(frame)};
}

Result<DrawnColliders> DrawnColliders::make(
    const Scene& scene, std::span<const std::shared_ptr<const ColliderMesh>> files,
    const AnimationPlan& plan, std::size_t free_memory) {
  DrawnColliders made;
  if (!contains_colliders(plan.file)) return made;
  std::set<std::string_view> surfaces;
  for (const AnimatedSurface& surface : plan.surfaces) surfaces.insert(surface.name);
  std::size_t bytes = 0;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    if (!targets_one_of(scene.colliders[k], surfaces)) continue;
    auto mesh = DrawnCollider::make(scene.colliders[k], plan.first_frame, files[k]);
    if (!mesh) return fail(mesh.error());
    if (!*mesh) continue;
    bytes += (*mesh)->bytes();
    made.meshes_.push_back(**std::move(mesh));
    if (bytes <= free_memory) continue;
    return fail(ErrorCode::OutOfMemory,
                fmt::format("{}: the colliders need more than the {} left of --max-memory to be "
                            "written; pliant bake --no-colliders leaves them out",
                            plan.file, bytes_text(free_memory)));
  }
  return made;
}

std::vector<AnimatedSurface> DrawnColliders::surfaces() const {
  std::vector<AnimatedSurface> surfaces;
  for (const DrawnCollider& mesh : meshes_) {
    surfaces.push_back(
        {.name = mesh.collider().name, .mesh = &mesh.mesh(), .rest = mesh.mesh().positions});
  }
  return surfaces;
}

Result<std::vector<SurfacePose>> DrawnColliders::at(int frame) const {
  std::vector<SurfacePose> poses;
  for (const DrawnCollider& mesh : meshes_) {
    auto pose = mesh.at(frame);
    if (!pose) return fail(pose.error());
    poses.push_back(*std::move(pose));
  }
  return poses;
}

}  // namespace pliant
