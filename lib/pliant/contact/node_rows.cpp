#include "pliant/contact/node_rows.hpp"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Cosines of the angle between two walls that are one, and from which on they squeeze.
constexpr double one_wall = 0.999;
constexpr double squeeze = -0.8;
// The volume that the normals of three walls span at least.
constexpr double least_volume = 0.1;

double volume(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// How far a place is from a box that is around another one; 0 within it.
double distance_to(const PosedMesh::Box& box, const Vector3d& x) {
  Vector3d way;
  for (int k = 0; k < 3; ++k) way[k] = std::max({box.low[k] - x[k], x[k] - box.high[k], 0.0});
  return length_of(way.transpose());
}

// The same as below.
bool stays_away_from_mesh(const PlacedCollider& from, const PlacedCollider& to, const Vector3d& x0,
                          const Vector3d& x1, NearMesh& near) {
  const PosedMesh& mesh = *std::get<MeshSolid>(from.kept.solid).posed;
  const double most = (length_of((x1 - x0).transpose()) + to.mesh_way - from.mesh_way +
                       std::abs(to.kept.offset - from.kept.offset)) *
                          (1 + 1e-9) +
                      1e-12 * mesh.diagonal() + from.kept.offset;
  return distance_to(mesh.box(0), x0) > most || is_known_to_be_farther(from, x0, most, near) ||
         distance_to_mesh(from, x0, near) > most;
}

// Whether a node is so far from a solid that it does not come near it: a distance changes at most
// as much as the node moves in the solid's frame, and the solid grows.
bool stays_away(const PlacedCollider& from, const PlacedCollider& to, const Vector3d& x0,
                const Vector3d& x1, NearMesh& near_mesh) {
  if (std::holds_alternative<MeshSolid>(from.kept.solid))
    return stays_away_from_mesh(from, to, x0, x1, near_mesh);
  const double growth = std::visit(
      [&]<class Kind>(const Kind& kind) {
        const auto& last = std::get<Kind>(to.kept.solid);
        if constexpr (std::is_same_v<Kind, SphereSolid>) return std::abs(last.radius - kind.radius);
        if constexpr (std::is_same_v<Kind, CapsuleSolid>)
          return std::abs(last.radius - kind.radius) + std::abs(last.length - kind.length);
        if constexpr (std::is_same_v<Kind, BoxSolid>)
          return length_of(last.size - kind.size) + 3 * std::abs(last.round - kind.round);
        return 0.0;  // a mesh is looked at below
      },
      from.kept.solid);
  const double most = length_of(x1 - x0) + growth + std::abs(to.kept.offset - from.kept.offset);
  return nearness(from.kept, x0).distance > most;
}

NodeRow row_at(const PlacedCollider& to, const Contact& contact) {
  NodeRow row;
  row.normal = to.turned(contact.normal);
  row.height = contact.support + to.kept.offset + dot_of(row.normal, to.translation);
  row.place = to.to_world(contact.place);
  return row;
}

}  // namespace

// The distance where it was looked at, less the ways since, is no more than that now.
bool is_known_to_be_farther(const PlacedCollider& mesh, const Vector3d& x, double distance,
                            const NearMesh& near) {
  if (near.triangle < 0) return false;
  const double ways =
      length_of((x - near.place).transpose()) + std::abs(mesh.mesh_way - near.mesh_way);
  return near.distance - ways * (1 + 1e-9) > distance;
}

double distance_to_mesh(const PlacedCollider& mesh, const Vector3d& x, NearMesh& near) {
  if (near.triangle >= 0 && near.place == x && near.mesh_way == mesh.mesh_way) return near.distance;
  const PosedMesh& posed = *std::get<MeshSolid>(mesh.kept.solid).posed;
  const MeshNearness found = MeshWay(posed, posed).nearness(x, 0, near.triangle);
  near = {found.foot.triangle, x, found.distance, mesh.mesh_way};
  return found.distance;
}

double NodeRow::lack(const Vector3d& at) const { return height - dot_of(normal, at); }

std::optional<NodeRow> row_of(const PlacedCollider& from, const PlacedCollider& to,
                              const Vector3d& before, const Vector3d& after, double slack,
                              NearMesh* near_mesh) {
  NearMesh unknown;
  NearMesh& near = near_mesh ? *near_mesh : unknown;
  const Vector3d x0 = from.to_frame(before), x1 = to.to_frame(after);
  if (stays_away(from, to, x0, x1, near)) return std::nullopt;
  MeshBegin begin{near.triangle, {}};
  if (near.triangle >= 0 && near.place == x0) begin.distance = near.distance;
  const auto contact = first_contact(from.kept, to.kept, x0, x1, slack, begin);
  if (!contact) return std::nullopt;
  return row_at(to, *contact);
}

std::optional<NodeRow> lying_row_of(const PlacedCollider& from, const PlacedCollider& to,
                                    const Vector3d& before, double near) {
  const auto contact = lying_contact(from.kept, to.kept, from.to_frame(before), near);
  if (!contact) return std::nullopt;
  return row_at(to, *contact);
}

const NodeRow* NodeRows::squeezer_of(const NodeRow& row) const {
  const auto own = rows_.find(row.node);
  if (own == rows_.end()) return nullptr;
  const auto found = std::ranges::find_if(own->second, [&](const NodeRow& other) {
    return dot_of(row.normal, other.normal) < squeeze;
  });
  return found == own->second.end() ? nullptr : &*found;
}

NodeRows::Offer NodeRows::add(const NodeRow& row, const Vector3d& at) {
  std::vector<NodeRow>& own = rows_[row.node];
  if (!own.empty() && own.front().sticks) return Offer::Dropped;
  if (row.sticks) {
    own.assign(1, row);
    return Offer::Taken;
  }
  if (squeezer_of(row)) return Offer::Squeezed;
  const auto same = std::ranges::find_if(
      own, [&](const NodeRow& other) { return dot_of(row.normal, other.normal) > one_wall; });
  if (same != own.end()) {
    if (row.lack(at) > same->lack(at)) *same = row;
    return Offer::Same;
  }
  const bool fits = own.size() < 2 ||
                    (own.size() == 2 &&
                     std::abs(volume(own[0].normal, own[1].normal, row.normal)) >= least_volume);
  if (!fits) return Offer::Dropped;
  own.push_back(row);
  return Offer::Taken;
}

std::vector<NodeRow> NodeRows::all() const {
  std::vector<NodeRow> all;
  for (const auto& [node, own] : rows_) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace pliant
