#include "pliant/contact/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

// Of what is nearer than `radius` to a place that is at `way` from here.
Nearness round_nearness(const Vector3d& way, double radius, const Vector3d& if_none) {
  const double length = length_of(way);
  if (!(length > 0)) return {-radius, if_none};
  return {length - radius, way / length};
}

double sign_of(double number) { return number < 0 ? -1 : 1; }

Nearness near_to(const SphereSolid& sphere, const Vector3d& x) {
  return round_nearness(x, sphere.radius, Vector3d::UnitY());
}

Nearness near_to(const CapsuleSolid& capsule, const Vector3d& x) {
  const double half = capsule.length / 2;
  const Vector3d way(x[0], x[1] - std::clamp(x[1], -half, half), x[2]);
  return round_nearness(way, capsule.radius, Vector3d::UnitX());
}

// Within the core, the box without its round edges, a face is nearest; around it, a place of it.
Nearness near_to(const BoxSolid& box, const Vector3d& x) {
  Vector3d beyond;  // the core, along each axis
  for (int k = 0; k < 3; ++k) beyond[k] = std::abs(x[k]) - (box.size[k] / 2 - box.round);
  int nearest = 0;
  bool is_within = true;
  Vector3d way(0, 0, 0);
  for (int k = 0; k < 3; ++k) {
    if (beyond[k] > beyond[nearest]) nearest = k;
    if (!(beyond[k] > 0)) continue;
    is_within = false;
    way[k] = sign_of(x[k]) * beyond[k];
  }
  const Vector3d face = sign_of(x[nearest]) * Vector3d::Unit(nearest);
  if (is_within) return {beyond[nearest] - box.round, face};
  return round_nearness(way, box.round, face);
}

Nearness near_to(const PlaneSolid&, const Vector3d& x) { return {x[1], Vector3d::UnitY()}; }

Nearness near_to(const MeshSolid& mesh, const Vector3d& x) {
  const MeshNearness near = MeshWay(*mesh.posed, *mesh.posed).nearness(x, 0);
  return {near.distance, near.normal};
}

double support_of(const SphereSolid& sphere, const Vector3d&) { return sphere.radius; }
double support_of(const CapsuleSolid& capsule, const Vector3d& n) {
  return std::abs(n[1]) * (capsule.length / 2) + capsule.radius;
}
double support_of(const BoxSolid& box, const Vector3d& n) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += std::abs(n[k]) * (box.size[k] / 2 - box.round);
  return sum + box.round;
}
double support_of(const PlaneSolid&, const Vector3d&) { return 0; }
double support_of(const MeshSolid& mesh, const Vector3d& n) {
  const Field& points = mesh.posed->points();
  double most = -std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    most = std::max(most, dot_of(n, points.row(k).transpose()));
  return most;
}

double mix(double one, double other, double t) {
  return one == other ? one : (1 - t) * one + t * other;
}

SphereSolid mix(const SphereSolid& a, const SphereSolid& b, double t) {
  return {mix(a.radius, b.radius, t)};
}
CapsuleSolid mix(const CapsuleSolid& a, const CapsuleSolid& b, double t) {
  return {mix(a.radius, b.radius, t), mix(a.length, b.length, t)};
}
BoxSolid mix(const BoxSolid& a, const BoxSolid& b, double t) {
  BoxSolid between;
  for (int k = 0; k < 3; ++k) between.size[k] = mix(a.size[k], b.size[k], t);
  between.round = mix(a.round, b.round, t);
  return between;
}
PlaneSolid mix(const PlaneSolid& plane, const PlaneSolid&, double) { return plane; }
MeshSolid mix(const MeshSolid& a, const MeshSolid& b, double t) {
  if (t == 0 || a == b) return a;
  if (t == 1) return b;
  return {std::make_shared<const PosedMesh>(a.posed->shared_mesh(),
                                            (1 - t) * a.posed->points() + t * b.posed->points(),
                                            a.posed->is_mirrored())};
}

}  // namespace

Nearness nearness(const Solid& solid, const Vector3d& x) {
  return std::visit([&](const auto& kind) { return near_to(kind, x); }, solid);
}

double support(const Solid& solid, const Vector3d& n) {
  return std::visit([&](const auto& kind) { return support_of(kind, n); }, solid);
}

Solid between(const Solid& one, const Solid& other, double t) {
  return std::visit(
      [&]<class Kind>(const Kind& kind) { return Solid(mix(kind, std::get<Kind>(other), t)); },
      one);
}

double reach(const Solid& solid) {
  struct Reach {
    double operator()(const SphereSolid& sphere) const { return sphere.radius; }
    double operator()(const CapsuleSolid& capsule) const {
      return capsule.radius + capsule.length / 2;
    }
    double operator()(const BoxSolid& box) const { return length_of(box.size) / 2; }
    double operator()(const PlaneSolid&) const { return std::numeric_limits<double>::infinity(); }
    double operator()(const MeshSolid& mesh) const {
      const PosedMesh::Box& box = mesh.posed->box(0);
      return length_of(box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).transpose());
    }
  };
  return std::visit(Reach(), solid);
}

double inner_radius(const Solid& solid) {
  if (const auto* const mesh = std::get_if<MeshSolid>(&solid)) {
    const PosedMesh::Box& around = mesh->posed->box(0);
    return (around.high - around.low).minCoeff() / 2;
  }
  const auto* const box = std::get_if<BoxSolid>(&solid);
  return box ? box->size.minCoeff() / 2 : least_radius(solid);
}

double least_radius(const Solid& solid) {
  struct Radius {
    double operator()(const SphereSolid& sphere) const { return sphere.radius; }
    double operator()(const CapsuleSolid& capsule) const { return capsule.radius; }
    double operator()(const BoxSolid& box) const { return box.round; }
    double operator()(const PlaneSolid&) const { return std::numeric_limits<double>::infinity(); }
    double operator()(const MeshSolid&) const { return 0; }
  };
  return std::visit(Radius(), solid);
}

}  // namespace pliant
