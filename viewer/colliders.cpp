#include "viewer/colliders.hpp"

#include <numeric>
#include <string>
#include <vector>

#include "pliant/mesh/normals.hpp"
#include "pliant/sampling/drawn_collider.hpp"
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

// The page shows each vertex with one normal, or all faces flat. Where only some edges are hard, it
// has a vertex for each normal; of these the vertices of the mesh.
std::vector<int> split_at_hard_edges(Mesh& mesh) {
  std::vector<int> vertices(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(vertices.begin(), vertices.end(), 0);
  if (mesh.corner_normals.empty() || is_flat(mesh)) return vertices;
  vertices.resize(static_cast<std::size_t>(normal_count(mesh)));
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner)
    vertices[static_cast<std::size_t>(mesh.corner_normals[corner])] = mesh.corner_vertices[corner];
  mesh.positions = Field(mesh.positions(vertices, Eigen::all));
  mesh.corner_vertices = mesh.corner_normals;
  return vertices;
}

// The mesh, where it is, and how its points move if they do.
Result<void> add_mesh(const DrawnCollider& mesh, const FrameSpan& frames, Arrays& arrays,
                      const StopRequest& should_stop, Json& json) {
  Mesh shown = mesh.mesh();
  const std::vector<int> vertices = split_at_hard_edges(shown);
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const Field& points = shown.positions;
  MotionPacker packer(points, order);
  bool is_moving = false;
  for (int frame = frames.first; mesh.moves_points() && frame <= frames.last; ++frame) {
    if (is_stopped(should_stop)) return interrupted();
    const auto moved = mesh.at(frame);
    if (!moved) return fail(moved.error());
    const Field places = moved->positions(vertices, Eigen::all);
    is_moving = is_moving || !are_equal(places, points);
    if (auto added = packer.add(places, frame); !added) return added;
  }
  json["transforms"] =
      track(frames, [&](int frame) { return to_json(make_transform(mesh.placement_at(frame))); });
  json["points"] = arrays.add(numbers_of(points));
  json["triangles"] = arrays.add(triangle_vertices(shown));
  if (is_flat(shown)) json["isFlat"] = true;
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

Result<Json> view_collider(const Collider& collider,
                           const std::shared_ptr<const ColliderMesh>& mesh, const FrameSpan& frames,
                           Arrays& arrays, const StopRequest& should_stop) {
  Json json = {
      {"name", collider.name}, {"kind", shape_of(collider)}, {"targets", collider.targets}};
  Json values = Json::object();
  for_each_value(collider, [&](std::string_view name, const ValueAt& value_at) {
    (name == "enabled" ? json : values)[std::string(name)] = track(frames, value_at);
  });
  json["values"] = std::move(values);
  const auto drawn = DrawnCollider::make(collider, frames.first, mesh);
  if (!drawn) return fail(drawn.error());
  if (*drawn) {
    if (auto added = add_mesh(**drawn, frames, arrays, should_stop, json); !added)
      return fail(added.error());
  } else {
    json["transforms"] = plane_transforms(collider, frames);
  }
  return json;
}

Result<Json> view_colliders(const Simulation& simulation, const FrameSpan& frames, Arrays& arrays,
                            const StopRequest& should_stop) {
  Json colliders = Json::array();
  const auto meshes = simulation.collider_meshes();
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    if (is_stopped(should_stop)) return interrupted();
    auto collider =
        view_collider(simulation.scene().colliders[k], meshes[k], frames, arrays, should_stop);
    if (!collider) return collider;
    colliders.push_back(*std::move(collider));
  }
  return colliders;
}

Result<ColliderSize> size_of_colliders(const Simulation& simulation) {
  ColliderSize size;
  const auto meshes = simulation.collider_meshes();
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const auto mesh =
        DrawnCollider::make(simulation.scene().colliders[k], simulation.scene().start, meshes[k]);
    if (!mesh) return fail(mesh.error());
    if (!*mesh) continue;
    size.bytes += (*mesh)->bytes();
    if ((*mesh)->moves_points())
      size.moving_vertices += static_cast<std::size_t>(normal_count((*mesh)->mesh()));
  }
  return size;
}

}  // namespace pliant::viewer
