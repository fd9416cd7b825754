#include "cli/new/own_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "cli/terminal/rounded.hpp"
#include "pliant/scene/channels.hpp"

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

// Inwards at a vertex: to the middle of the piece, or against its normal where that leads along it.
Vector3d inwards_at(const MeshPiece& piece, Eigen::Index vertex) {
  const Vector3d at = piece.vertices.row(vertex).transpose();
  const Vector3d normal = piece.normals.row(vertex).transpose();
  const Vector3d to_middle = (piece.low + piece.high) / 2 - at;
  const double along = to_middle.norm() > 0 ? normal.dot(to_middle.normalized()) : 0;
  if (std::abs(along) > 0.3 || (normal.isZero(0) && to_middle.norm() > 0))
    return to_middle.normalized();
  if (normal.isZero(0)) return {0, -1, 0};
  return along > 0 ? normal : -normal;
}

// Scales lengths, and moves each point force to the same place, with its direction inwards.
std::vector<Operation> placing(const Scene& scene, const MeshPiece& own, const MeshPiece& mesh) {
  const double size = mesh.diagonal() / own.diagonal();
  std::vector<Operation> operations{scaling_of(animated(scene, ".translate"), size)};
  for (const Force& force : scene.forces) {
    const auto* const point = std::get_if<PointChannels>(&force.kind);
    if (!point) continue;
    operations.emplace_back(
        scaling_of({force.name + ".deformationRadius", force.name + ".forceRadius"}, size));
    const Value<3> center = point->center.at(scene.start);
    const Vector3d share =
        (Vector3d(center[0], center[1], center[2]) - own.low).cwiseQuotient(own.high - own.low);
    const Vector3d wanted = mesh.low + share.cwiseProduct(mesh.high - mesh.low);
    const Eigen::Index vertex =
        pushed_vertex(mesh, wanted, size * force.force_radius.at(scene.start)[0]);
    operations.emplace_back(
        edit::Set{force.name + ".center",
                  place_text(mesh.vertices.row(vertex).transpose(), mesh.diagonal())});
    operations.emplace_back(
        edit::Set{force.name + ".direction", direction_text(inwards_at(mesh, vertex))});
  }
  return operations;
}

// The radii of point forces.
std::vector<std::string> radii_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (const Force& force : scene.forces) {
    if (!std::holds_alternative<PointChannels>(force.kind)) continue;
    paths.push_back(force.name + ".deformationRadius");
    paths.push_back(force.name + ".forceRadius");
  }
  return paths;
}

// Makes the spheres of the forces larger until something in them can move, or smaller until
// something holds it.
Result<StarterFacts> fit_radii(SceneDocument& scene, const StarterSource& source) {
  constexpr int most_turns = 12;
  double factor = 1;
  for (int turn = 0;; ++turn) {
    auto facts = look_at(scene.text(), source);
    if (!facts) return facts;
    const bool is_too_small = !facts->selects || !facts->is_solvable;
    const std::vector<std::string> radii = radii_of(scene.scene());
    if ((!is_too_small && facts->is_held) || radii.empty() || turn == most_turns) return facts;
    const double next = is_too_small ? 1.5 : 0.7;
    if (turn > 0 && (next > 1) != (factor > 1)) return facts;
    factor = next;
    if (auto changed = scene.apply({scaling_of(radii, factor)}); !changed)
      return fail(changed.error());
  }
}

// Pulls back to rest what has no border to hold it, about as strongly as the starter's own mesh
// resists its slowest vibration.
Result<StarterFacts> hold_by_goal(SceneDocument& scene, const StarterSource& source) {
  const std::string surface = scene.scene().surfaces.front().name;
  if (auto changed = scene.apply({edit::Set{surface + ".goal", "400"}}); !changed)
    return fail(changed.error());
  return look_at(scene.text(), source);
}

}  // namespace

Result<StarterFacts> use_own_mesh(SceneDocument& scene, const OwnMesh& mesh,
                                  const StarterFacts& own, const MeshPiece& own_piece,
                                  const StarterSource& source) {
  const std::string surface = scene.scene().surfaces.front().name;
  std::vector<Operation> naming{edit::Set{surface + ".file", edit::literal_text(mesh.file)},
                                edit::Set{surface + ".uv", "auto"}};
  if (!mesh.object.empty())
    naming.emplace_back(edit::Set{surface + ".object", edit::literal_text(mesh.object)});
  auto changed = scene.apply(naming);
  if (!changed) return fail(changed.error());
  const auto piece = measure(scene.text(), source);
  if (!piece) return fail(piece.error());
  if (!(piece->diagonal() > 0)) return invalid("all vertices of the mesh are in one place");
  std::vector<Operation> fitting = placing(scene.scene(), own_piece, *piece);
  if (!piece->is_grid) fitting.emplace_back(edit::Set{surface + ".uv", "surface"});
  changed = scene.apply(fitting);
  if (!changed) return fail(changed.error());
  auto facts = fit_radii(scene, source);
  if (facts && facts->is_by_inertia && facts->is_solvable && !facts->is_held)
    facts = hold_by_goal(scene, source);
  if (!facts) return facts;
  if (auto moves = check_moves(*facts); !moves) return fail(moves.error());
  changed = scene.apply(
      {scaling_of({surface + ".density"}, std::pow(facts->frequency / own.frequency, 2))});
  if (!changed) return fail(changed.error());
  const auto peak = played_peak(scene.text(), source);
  if (!peak) return fail(peak.error());
  if (!(*peak > 0)) {
    return invalid(
        "the starter moves nothing of the mesh: no force reaches a part of it that can move");
  }
  facts->peak = *peak;
  if (facts->is_by_inertia) {
    if (auto held = keep_in_frame(scene, *facts); !held) return fail(held.error());
    return facts;
  }
  const double wanted = own.peak * facts->size / own.size;
  changed = scene.apply({scaling_of(animated(scene.scene(), ".magnitude"), wanted / *peak)});
  if (!changed) return fail(changed.error());
  facts->peak = wanted;
  return facts;
}

Result<void> keep_in_frame(SceneDocument& scene, StarterFacts& facts) {
  const double most = 0.5 * facts.size;
  if (!facts.is_by_inertia || !(facts.peak > most)) return {};
  std::vector<std::string> magnitudes;
  for (const Force& force : scene.scene().forces) {
    if (std::holds_alternative<InertiaChannels>(force.kind))
      magnitudes.push_back(force.name + ".magnitude");
  }
  const auto changed = scene.apply({scaling_of(std::move(magnitudes), most / facts.peak)});
  if (!changed) return fail(changed.error());
  facts.peak = most;
  return {};
}

}  // namespace pliant::cli
