#include "own_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/channels.hpp"
#include "rounded.hpp"

namespace pliant::cli {
namespace {

std::string direction_text(const Vector3d& direction) {
  return fmt::format("{} {} {}", rounded(direction.x()), rounded(direction.y()),
                     rounded(direction.z()));
}

// Multiplies channels by a factor, with the digits that a person would write.
edit::Scale scaling_of(std::vector<std::string> channels, double factor) {
  return {.channels = std::move(channels), .factor = factor, .digits = 3};
}

// The animated channels of one attribute.
std::vector<std::string> animated(const Scene& scene, std::string_view attribute) {
  std::vector<std::string> paths;
  for (const NamedChannel& each : channels_of(scene)) {
    if (each.is_animated() && each.path.ends_with(attribute)) paths.push_back(each.path);
  }
  return paths;
}

// The vertex of the mesh that is nearest to the place that `point` has in the starter's box.
Vector3d same_place(const Vector3d& point, const StarterFacts& own, const StarterFacts& mesh) {
  const auto share = (point - own.low).cwiseQuotient(own.high - own.low);
  const Vector3d wanted = mesh.low + share.cwiseProduct(mesh.high - mesh.low);
  Eigen::Index nearest = 0;
  (mesh.vertices.rowwise() - wanted.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return mesh.vertices.row(nearest).transpose();
}

// Scales lengths, and moves each point force to the same place, with its direction inwards.
std::vector<Operation> placing(const Scene& scene, const StarterFacts& own,
                               const StarterFacts& mesh) {
  const double size = mesh.diagonal() / own.diagonal();
  std::vector<Operation> operations{scaling_of(animated(scene, ".translate"), size)};
  for (const Force& force : scene.forces) {
    const auto* const point = std::get_if<PointChannels>(&force.kind);
    if (!point) continue;
    operations.emplace_back(
        scaling_of({force.name + ".deformationRadius", force.name + ".forceRadius"}, size));
    const Value<3> center = point->center.at(scene.start);
    const Vector3d at = same_place({center[0], center[1], center[2]}, own, mesh);
    const Vector3d inwards = ((mesh.low + mesh.high) / 2 - at).normalized();
    operations.emplace_back(edit::Set{force.name + ".center", place_text(at, mesh.diagonal())});
    operations.emplace_back(edit::Set{force.name + ".direction", direction_text(inwards)});
  }
  return operations;
}

}  // namespace

Result<StarterFacts> use_own_mesh(SceneDocument& scene, const OwnMesh& mesh,
                                  const StarterFacts& own, const StarterSource& source) {
  const std::string surface = scene.scene().surfaces.front().name;
  std::vector<Operation> naming{edit::Set{surface + ".file", edit::literal_text(mesh.file)},
                                edit::Set{surface + ".uv", "auto"}};
  if (!mesh.object.empty())
    naming.emplace_back(edit::Set{surface + ".object", edit::literal_text(mesh.object)});
  auto changed = scene.apply(naming);
  if (!changed) return fail(changed.error());
  const auto size = measure(scene.text(), source);
  if (!size) return fail(size.error());
  changed = scene.apply(placing(scene.scene(), own, *size));
  if (!changed) return fail(changed.error());
  auto trial = look_at(scene.text(), source);
  if (!trial) return trial;
  if (!trial->is_held) {
    return invalid(
        "nothing holds the mesh: it has no border; this starter needs one, such as the rim of a "
        "bowl");
  }
  changed = scene.apply(
      {scaling_of({surface + ".density"}, std::pow(trial->frequency / own.frequency, 2))});
  if (!changed) return fail(changed.error());
  const double wanted = own.peak * trial->diagonal() / own.diagonal();
  auto moved = look_at(scene.text(), source);
  if (!moved || moved->is_by_inertia || !(moved->peak > 0)) return moved;
  changed = scene.apply({scaling_of(animated(scene.scene(), ".magnitude"), wanted / moved->peak)});
  if (!changed) return fail(changed.error());
  StarterFacts facts = *moved;
  facts.peak = wanted;
  return facts;
}

}  // namespace pliant::cli
