#include "pliant/forces/force.hpp"

#include <algorithm>
#include <limits>

#include "pliant/forces/noise.hpp"
#include "pliant/forces/vectors.hpp"

namespace pliant {
namespace {

Vector3d closest_point(const LineForce& line, const Vector3d& p) {
  const Vector3d along = line.to - line.from;
  const double squared_length = dot(along, along);
  if (squared_length == 0) return line.from;
  const double t = std::clamp(dot(p - line.from, along) / squared_length, 0.0, 1.0);
  return line.from + t * along;
}

// The vector from the closest point of the vortex's axis to p; from its centre if the axis is zero.
Vector3d from_axis(const VortexForce& vortex, const Vector3d& p) {
  const Vector3d offset = p - vortex.center;
  const Vector3d axis = normalised(vortex.axis);
  return offset - dot(offset, axis) * axis;
}

// On a segment or an axis there is no outward direction. The closest point is rounded, so "on"
// means within a few ulps of the coordinates from which it was computed; the direction of the
// remaining vector would be noise.
bool is_rounding(const Vector3d& outward, double extent) {
  return largest_component(outward) <= 8 * std::numeric_limits<double>::epsilon() * extent;
}

}  // namespace

double PointForce::distance(const Vector3d& p) const { return length(p - center); }
Vector3d PointForce::unit_force(const Vector3d&) const { return normalised(direction); }

double RadialForce::distance(const Vector3d& p) const { return length(p - center); }
Vector3d RadialForce::unit_force(const Vector3d& p) const { return normalised(p - center); }

double LineForce::distance(const Vector3d& p) const { return length(p - closest_point(*this, p)); }
Vector3d LineForce::unit_force(const Vector3d& p) const {
  if (direction) return normalised(*direction);
  const Vector3d outward = p - closest_point(*this, p);
  const double extent =
      std::max({largest_component(p), largest_component(from), largest_component(to)});
  return is_rounding(outward, extent) ? Vector3d::Zero() : normalised(outward);
}

double UniformForce::distance(const Vector3d&) const { return 0; }
Vector3d UniformForce::unit_force(const Vector3d&) const { return normalised(direction); }

double VortexForce::distance(const Vector3d& p) const { return length(from_axis(*this, p)); }
Vector3d VortexForce::unit_force(const Vector3d& p) const {
  if (largest_component(axis) == 0) return Vector3d::Zero();
  const Vector3d outward = from_axis(*this, p);
  if (is_rounding(outward, std::max(largest_component(p), largest_component(center)))) {
    return Vector3d::Zero();
  }
  const Vector3d out = normalised(outward);
  return normalised(cross(normalised(axis), out)) - pull * out;
}

double NoiseForce::distance(const Vector3d& p) const { return length(p - center); }
Vector3d NoiseForce::unit_force(const Vector3d& p) const {
  return smooth_noise(seed, frequency * (p - center), time);
}

double InertiaForce::distance(const Vector3d&) const { return 0; }
Vector3d InertiaForce::unit_force(const Vector3d& p) const {
  const Vector3d q = p - origin;
  Vector3d force = offset;
  for (int row = 0; row < 3; ++row) {
    force[row] += linear(row, 0) * q.x() + linear(row, 1) * q.y() + linear(row, 2) * q.z();
  }
  return force;
}

SampledForce region_sphere(const Vector3d& center, double deformation_radius) {
  return {.shape = PointForce{center, Vector3d::Zero()},
          .magnitude = 0,
          .deformation_radius = deformation_radius,
          .force_radius = 0};
}

double distance(const ForceShape& shape, const Vector3d& p) {
  return std::visit([&](const auto& force) { return force.distance(p); }, shape);
}

Vector3d unit_force(const ForceShape& shape, const Vector3d& p) {
  return std::visit([&](const auto& force) { return Vector3d(force.unit_force(p)); }, shape);
}

Vector3d force_at(const SampledForce& force, const Vector3d& p) {
  const double s = distance(force.shape, p) / force.force_radius;
  const double fade = force.falloff_curve ? force.falloff_curve->value(std::min(s, 1.0))[0]
                                          : falloff(force.falloff, s);
  return force.magnitude * fade * unit_force(force.shape, p);
}

}  // namespace pliant
