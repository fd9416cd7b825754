#include "pliant/sampling/carriers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pliant/mesh/triangles/face_triangles.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/mesh/triangles/triangle_tree.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {
namespace {

using Triangle = std::array<Vector3d, 3>;

bool has_area(const Triangle& corners) {
  constexpr double least = 1e-12;  // of the longest edge squared
  const Vector3d ab = corners[1] - corners[0], ac = corners[2] - corners[0];
  const double longest =
      std::max({ab.squaredNorm(), ac.squaredNorm(), (corners[2] - corners[1]).squaredNorm()});
  return ab.cross(ac).norm() > least * longest;
}

// The orthonormal frame of a triangle as columns: along its first edge, across, along its normal.
Matrix3d frame_of(const Triangle& corners) {
  const Vector3d first = (corners[1] - corners[0]).stableNormalized();
  const Vector3d normal = first.cross(corners[2] - corners[0]).stableNormalized();
  Matrix3d frame;
  frame.col(0) = first;
  frame.col(1) = normal.cross(first);
  frame.col(2) = normal;
  return frame;
}

Vector3d point_of(const Triangle& corners, const std::array<double, 3>& weights) {
  Vector3d point = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) point += weights[k] * corners[k];
  return point;
}

}  // namespace

// The triangles of an animated rest shape, to which places are bound as they are at the scene's
// start. Thread-safe.
class CarrierTriangles {
 public:
  static Result<std::shared_ptr<const CarrierTriangles>> make(
      const TriangleSurface& surface, std::shared_ptr<const AnimatedShape> animation, int start,
      const StopRequest& should_stop) {
    const auto at_start = animation->nodes_at(start);
    if (!at_start) return fail(at_start.error());
    auto made = std::make_shared<CarrierTriangles>();
    StopPoll poll(should_stop);
    made->faces_ = FaceTriangles(surface, poll);
    if (poll.after(0)) return interrupted();
    made->animation_ = std::move(animation);
    made->points_ = made->faces_.with_centres(**at_start, poll);
    std::vector<FaceTriangles::Corners> with_area;
    for (const FaceTriangles::Corners& corners : made->faces_.triangles) {
      if (poll.after(20)) return interrupted();
      if (has_area(made->corners_at_start(corners))) with_area.push_back(corners);
    }
    if (with_area.empty()) return invalid("none of its triangles has an area");
    made->faces_.triangles = with_area;
    auto tree = TriangleTree::make(made->points_, std::move(with_area), should_stop);
    if (!tree) return fail(tree.error());
    made->tree_.emplace(*std::move(tree));
    made->tolerance_ = one_place * length_of(made->points_.colwise().maxCoeff() -
                                             made->points_.colwise().minCoeff());
    return made;
  }

  // The place at a frame in object space, and how its triangle has turned since the start.
  Result<std::pair<Vector3d, Matrix3d>> carry(const Vector3d& place, int frame) const {
    const Bound bound = bind(place);
    const auto nodes = animation_->nodes_at(frame);
    if (!nodes) return fail(nodes.error());
    Triangle now;
    for (int k = 0; k < 3; ++k) now[k] = faces_.point(bound.corners[k], **nodes);
    if (!has_area(now))
      return invalid(fmt::format("the triangle that carries it has no area at frame {}", frame));
    const Transform turn{product(frame_of(now), bound.frame.transpose()),
                         point_of(now, bound.weights)};
    return std::pair(to_world(turn, bound.way), turn.linear);
  }

 private:
  static constexpr double one_place = 1e-9;  // of the box's diagonal
  static constexpr std::size_t most_bound = 256;

  struct Bound {
    FaceTriangles::Corners corners;
    std::array<double, 3> weights;
    Vector3d way;    // from the triangle's point to the place, at the start
    Matrix3d frame;  // of the triangle, at the start
  };

  Triangle corners_at_start(const FaceTriangles::Corners& corners) const {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = points_.row(corners[k]).transpose();
    return triangle;
  }

  // A place that stands still is bound once.
  Bound bind(const Vector3d& place) const {
    const std::array key = {place.x(), place.y(), place.z()};
    const std::lock_guard lock(mutex_);
    if (const auto found = bound_.find(key); found != bound_.end()) return found->second;
    const ClosestPoint closest = tree_->first_of_closest(place, tolerance_);
    Bound bound{
        faces_.triangles[static_cast<std::size_t>(closest.triangle)], closest.weights, {}, {}};
    const Triangle corners = corners_at_start(bound.corners);
    bound.way = place - point_of(corners, bound.weights);
    bound.frame = frame_of(corners);
    if (bound_.size() == most_bound) bound_.clear();
    bound_.emplace(key, bound);
    return bound;
  }

  std::shared_ptr<const AnimatedShape> animation_;
  FaceTriangles faces_;  // those with an area at the start
  Field points_;         // nodes and centres at the start
  std::optional<TriangleTree> tree_;
  double tolerance_ = 0;
  mutable std::mutex mutex_;
  mutable std::map<std::array<double, 3>, Bound> bound_;
};

Carriers::Carriers(const Scene& scene) {
  std::map<std::string_view, std::size_t> places;
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) places[scene.surfaces[k].name] = k;
  const auto follow = [&](const std::string& surface) {
    const auto found = places.find(surface);
    if (!surface.empty() && found != places.end())
      carriers_.try_emplace(surface, Carrier{found->second});
  };
  for (const Force& force : scene.forces) follow(force.follow);
  for (const Group& group : scene.groups) follow(group.follow);
}

Result<std::shared_ptr<const Carriers>> Carriers::make(
    const Scene& scene, std::span<const std::reference_wrapper<const RestShape>> shapes,
    const StopRequest& should_stop) {
  auto made = std::make_shared<Carriers>(scene);
  if (made->carriers_.empty()) return nullptr;
  for (auto& entry : made->carriers_) {
    Carrier& carrier = entry.second;
    const Surface& surface = scene.surfaces[carrier.surface];
    const RestShape& shape = shapes[carrier.surface];
    if (!shape.animation) continue;
    const auto refuse = [&](const Error& error) {
      if (error.code == ErrorCode::Interrupted) return fail(error);
      return fail(scene.origin.located(
          {.code = error.code,
           .message =
               fmt::format("surface \"{}\" cannot be followed: {}", surface.name, error.message)},
          scene.origin.at(surface.name)));
    };
    const auto triangles = triangles_of(surface, shape, should_stop);
    if (!triangles) return refuse(triangles.error());
    auto bound = CarrierTriangles::make(**triangles, shape.animation, scene.start, should_stop);
    if (!bound) return refuse(bound.error());
    carrier.triangles = *std::move(bound);
  }
  return made;
}

Result<Carried> Carriers::carry(const Scene& scene, std::string_view surface, const Vector3d& place,
                                int frame) const {
  const Carrier& carrier = carriers_.find(surface)->second;
  const TransformChannels& channels = scene.surfaces[carrier.surface].transform;
  const Transform transform = channels.at(frame);
  const Matrix3d rotation = channels.rotation_at(frame);
  if (!carrier.triangles) return Carried{to_world(transform, place), transform.linear, rotation};
  const auto carried = carrier.triangles->carry(place, frame);
  if (!carried) return fail(carried.error());
  const auto& [moved, turn] = *carried;
  return Carried{to_world(transform, moved), product(transform.linear, turn),
                 product(rotation, turn)};
}

}  // namespace pliant
