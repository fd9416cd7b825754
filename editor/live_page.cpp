#include "editor/live_page.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/feedback/surface_lines.hpp"
#include "pliant/files/single_precision.hpp"
#include "viewer/arrays.hpp"
#include "viewer/channels.hpp"
#include "viewer/colliders.hpp"
#include "viewer/forces.hpp"
#include "viewer/mesh_order.hpp"
#include "viewer/shape.hpp"

namespace pliant::editor {
namespace {

using viewer::Arrays;
using viewer::to_json;

FrameSpan frames_of(const Scene& scene) { return {scene.start, scene.end}; }

template <class Shapes>
std::string add_to(Shapes& shapes, const Json& head, Arrays& arrays) {
  auto packed = viewer::joined(head, arrays.take());
  std::string key = to_text(hash_of(packed));
  shapes.try_emplace(key, std::make_shared<const std::string>(std::move(packed)));
  return key;
}

// Moves members with arrays from `json` to the head of a shape.
Json split_off(Json& json, std::initializer_list<const char*> members) {
  Json shape = {{"version", 1}};
  for (const char* const member : members) {
    if (!json.contains(member)) continue;
    shape[member] = std::move(json[member]);
    json.erase(member);
  }
  return shape;
}

// The box around a mesh at rest, in the world, at some frames.
std::pair<Vector3d, Vector3d> box_of(const Mesh& mesh, const Surface& surface,
                                     const FrameSpan& frames) {
  constexpr int most_frames = 32;
  const Vector3d low = mesh.positions.colwise().minCoeff();
  const Vector3d high = mesh.positions.colwise().maxCoeff();
  const int step = std::max(1, frames.count() / most_frames);
  Vector3d least = Vector3d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (int frame = frames.first; frame <= frames.last; frame += step) {
    const Transform transform = make_transform(surface.transform.placement_at(frame));
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d place((corner & 1) != 0 ? high[0] : low[0],
                           (corner & 2) != 0 ? high[1] : low[1],
                           (corner & 4) != 0 ? high[2] : low[2]);
      const Vector3d there = transform.linear * place + transform.translation;
      least = least.cwiseMin(there);
      most = most.cwiseMax(there);
    }
  }
  // Room for what moves, so that the floor of the page is below it.
  const double room = 0.12 * (most - least).norm();
  for (int k = 0; k < 3; ++k) {
    const double missing = std::max(0.0, room - 0.5 * (most[k] - least[k]));
    least[k] -= missing;
    most[k] += missing;
  }
  return {least, most};
}

}  // namespace

Result<std::string> positions_bytes(const Frame& frame) {
  std::string bytes;
  Field positions;
  for (const SurfaceFrame& surface : frame.surfaces()) {
    positions = surface.positions(std::move(positions));
    const auto single = to_single(positions, frame.number());
    if (!single) return fail(single.error());
    append_number(bytes, static_cast<std::uint32_t>(positions.rows()));
    const std::size_t begin = bytes.size();
    bytes.resize(begin + single->size() * sizeof(float));
    std::memcpy(bytes.data() + begin, single->data(), single->size() * sizeof(float));
  }
  return bytes;
}

// The members of a surface that its shape has, with the key of its arrays.
Result<Json> LivePage::shape_facts(const RestShape& shape, Shapes& shapes,
                                   const StopRequest& should_stop) {
  const auto is_same = [&](const Shown& shown) {
    return shown.held == shape.held && shown.nodes == shape.vertex_nodes &&
           shown.mesh == shape.mesh;
  };
  if (const auto known = std::ranges::find_if(shown_, is_same); known != shown_.end()) {
    shapes.try_emplace(known->key, this->shape(known->key));
    return known->facts;
  }
  Arrays arrays;
  auto facts = viewer::shape_json(shape, arrays, should_stop);
  if (!facts) return facts;
  Json head = split_off(*facts, {"rest", "uvs", "nodes", "triangles", "edges", "pins"});
  for (const char* const member : {"columns", "rows"}) head[member] = (*facts)[member];
  (*facts)["shape"] = add_to(shapes, head, arrays);
  shown_.push_back({shape.mesh, shape.vertex_nodes, shape.held, *facts, (*facts)["shape"]});
  return facts;
}

Result<std::string> LivePage::scene(std::int64_t revision, const Simulation& simulation,
                                    const StopRequest& should_stop) {
  const Scene& scene = simulation.scene();
  const FrameSpan frames = frames_of(scene);
  Shapes shapes;
  Json surfaces = Json::array();
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    const RestShape& shape = simulation.rest_shapes()[k];
    const Surface& surface = scene.surfaces[k];
    const auto facts = shape_facts(shape, shapes, should_stop);
    if (!facts) return fail(facts.error());
    const auto [low, high] = box_of(shape.mesh, surface, frames);
    Json json = {{"name", shape.name},
                 {"enabled", surface.enabled},
                 {"low", to_json(low)},
                 {"high", to_json(high)},
                 {"peakDisplacement", 0},
                 {"peakSpeed", 0},
                 {"error", (high - low).maxCoeff() * 0x1p-24},
                 {"transforms", viewer::track(frames,
                                              [&](int frame) {
                                                return to_json(make_transform(
                                                    surface.transform.placement_at(frame)));
                                              })},
                 {"marks", Json::array()}};
    json.update(*facts);
    surfaces.push_back(std::move(json));
  }

  std::vector<ShownCollider> shown_colliders;
  const auto meshes = simulation.collider_meshes();
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const Collider& collider = scene.colliders[k];
    const bool is_known = k < colliders_.size() && frames.first == frames_before_.first &&
                          frames.last == frames_before_.last && meshes[k] == colliders_[k].mesh &&
                          collider == colliders_[k].collider;
    if (is_known) {
      shown_colliders.push_back(colliders_[k]);
      const Json& json = colliders_[k].facts;
      if (json.contains("shape")) {
        const std::string key = json["shape"];
        shapes.try_emplace(key, this->shape(key));
      }
      continue;
    }
    Arrays arrays;
    auto json = viewer::view_collider(collider, meshes[k], frames, arrays, should_stop);
    if (!json) return fail(json.error());
    const Json head = split_off(*json, {"points", "triangles", "isFlat", "motion"});
    if (head.contains("points")) (*json)["shape"] = add_to(shapes, head, arrays);
    shown_colliders.push_back({collider, meshes[k], *std::move(json)});
  }

  const auto forces = viewer::view_forces(simulation, frames, should_stop);
  if (!forces) return fail(forces.error());
  const auto channels = viewer::view_channels(scene, frames, should_stop);
  if (!channels) return fail(channels.error());
  Json head = {{"revision", revision},
               {"scene", scene.origin.file},
               {"fps", scene.fps},
               {"first", frames.first},
               {"last", frames.last},
               {"surfaces", std::move(surfaces)},
               {"forces", *forces},
               {"channels", *channels},
               {"messages", viewer::messages_of(simulation)}};
  for (const ShownCollider& collider : shown_colliders) head["colliders"].push_back(collider.facts);
  colliders_ = std::move(shown_colliders);
  frames_before_ = frames;
  std::erase_if(shown_, [&](const Shown& shown) { return !shapes.contains(shown.key); });
  {
    const std::lock_guard lock(mutex_);
    older_ = std::exchange(shapes_, std::move(shapes));
  }
  return head.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<std::string> LivePage::details(Simulation& simulation, int frame) const {
  const auto report = simulation.report(frame, ReportDetail::Outlines);
  if (!report) return fail(report.error());
  std::map<std::string, std::size_t, std::less<>> numbers;
  const Scene& scene = simulation.scene();
  for (const Force& force : scene.forces) numbers.try_emplace(force.name, numbers.size());
  for (const Group& group : scene.groups) numbers.try_emplace(group.name, numbers.size());
  const auto shown = simulation.at(frame);
  if (!shown) return fail(shown.error());
  Arrays arrays;
  Json surfaces = Json::array();
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    const RestShape& shape = simulation.rest_shapes()[k];
    viewer::SurfaceMarks marks(shape);
    marks.add(frame, report->surfaces[k], numbers);
    const auto& contacts = report->surfaces[k].contacts;
    const auto vertices = contacts.empty() ? std::vector<int>() : node_vertices(shape);
    Json json = {{"touching", arrays.add(viewer::touching_vertices(contacts, vertices))},
                 {"marks", marks.changes().empty() ? Json{{"frame", frame},
                                                          {"regions", Json::array()},
                                                          {"forces", Json::array()}}
                                                   : marks.changes().front()}};
    if (!marks.lines().is_empty()) json["lines"] = marks.lines().arrays(arrays);
    if (const Field& rest = shown->surfaces()[k].object_rest(); rest.rows() > 0) {
      const Vector3d low = shape.mesh.positions.colwise().minCoeff();
      const Vector3d high = shape.mesh.positions.colwise().maxCoeff();
      const Field relative = rest.rowwise() - (0.5 * low + 0.5 * high).transpose();
      const auto single = to_single(relative, frame);
      if (!single) return fail(single.error());
      json["rest"] = arrays.add(*single);
    }
    surfaces.push_back(std::move(json));
  }
  const Json head = {{"version", 1},
                     {"surfaces", std::move(surfaces)},
                     {"messages", viewer::messages_of(simulation)}};
  return viewer::joined(head, arrays.take());
}

std::shared_ptr<const std::string> LivePage::shape(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  for (const Shapes* const shapes : {&shapes_, &older_}) {
    if (const auto found = shapes->find(key); found != shapes->end()) return found->second;
  }
  return nullptr;
}

}  // namespace pliant::editor
