#include "viewer/colliders.hpp"

#include <numeric>
#include <string>
#include <vector>

#include "pliant/mesh/normals.hpp"
#include "pliant/scene/collider_mesh.hpp"
#include "viewer/forces.hpp"
#include "viewer/mesh_order.hpp"
#include "viewer/motion.hpp"

namespace pliant::viewer {
namespace {

std::vector<float> numbers_of(const Field& points) {
  std::vector<float> numbers;
  for (Eigen::Index row = 0; row < points.rows(); ++row) {
    for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(points(row, k)));
  }
  return numbers;
}

// The mesh, where it is, and how its points move if they do.
Result<void> add_mesh(const ColliderMesh& mesh, const FrameSpan& frames, Arrays& arrays,
                      const StopRequest& should_stop, Json& json) {
  std::vector<int> order(static_cast<std::size_t>(mesh.mesh().vertex_count()));
  std::iota(order.begin(), order.end(), 0);
  const Field& points = mesh.mesh().positions;
  MotionPacker packer(points, order);
  bool is_moving = false;
  for (int frame = frames.first; mesh.moves_points() && frame <= frames.last; ++frame) {
    if (is_stopped(should_stop)) return interrupted();
    const Field moved = mesh.at(frame).positions;
    is_moving = is_moving || !are_equal(moved, points);
    if (auto added = packer.add(moved, frame); !added) return added;
  }
  json["transforms"] =
      track(frames, [&](int frame) { return to_json(make_transform(mesh.at(frame).placement)); });
  json["points"] = arrays.add(numbers_of(points));
  json["triangles"] = arrays.add(triangle_vertices(mesh.mesh()));
  if (is_flat(mesh.mesh())) json["isFlat"] = true;
  if (!is_moving) return {};
  const auto motion = packer.pack(should_stop);
  if (!motion) return fail(motion.error());
  json["motion"] = to_json(*motion, arrays);
  return {};
}

Json plane_transforms(const Collider& collider, const FrameSpan& frames) {
  return track(frames, [&](int frame) {
    Placement placement = collider.transform.placement_at(frame);
    placement.scale = Vector3d::Ones();
    return to_json(make_transform(placement));
  });
}

}  // namespace

Result<Json> view_colliders(const Scene& scene, const FrameSpan& frames, Arrays& arrays,
                            const StopRequest& should_stop) {
  Json colliders = Json::array();
  for (const Collider& collider : scene.colliders) {
    if (is_stopped(should_stop)) return interrupted();
    Json json = {
        {"name", collider.name}, {"kind", shape_of(collider)}, {"targets", collider.targets}};
    Json values = Json::object();
    for_each_value(collider, [&](std::string_view name, const ValueAt& value_at) {
      (name == "enabled" ? json : values)[std::string(name)] = track(frames, value_at);
    });
    json["values"] = std::move(values);
    if (const auto mesh = ColliderMesh::make(collider, frames.first)) {
      if (auto added = add_mesh(*mesh, frames, arrays, should_stop, json); !added)
        return fail(added.error());
    } else {
      json["transforms"] = plane_transforms(collider, frames);
    }
    colliders.push_back(std::move(json));
  }
  return colliders;
}

std::size_t moving_vertices(const Scene& scene) {
  std::size_t count = 0;
  for (const Collider& collider : scene.colliders) {
    const auto mesh = ColliderMesh::make(collider, scene.start);
    if (mesh && mesh->moves_points())
      count += static_cast<std::size_t>(mesh->mesh().vertex_count());
  }
  return count;
}

}  // namespace pliant::viewer
