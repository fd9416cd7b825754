#include "pliant/forces/force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

// Sums of three terms are written out, so that their order is stated and no library chooses it.
double dot(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

double length(const Vector3d& a) { return std::sqrt(dot(a, a)); }

double largest_component(const Vector3d& a) {
  return std::max({std::abs(a.x()), std::abs(a.y()), std::abs(a.z())});
}

Vector3d normalised(const Vector3d& a) {
  // Scaled by the largest component first: the square of a tiny or huge length would be lost.
  const double largest = largest_component(a);
  if (largest == 0) return Vector3d::Zero();
  const Vector3d scaled = a / largest;
  return scaled / length(scaled);
}

Vector3d closest_point(const LineForce& line, const Vector3d& p) {
  const Vector3d along = line.to - line.from;
  const double squared_length = dot(along, along);
  if (squared_length == 0) return line.from;
  const double t = std::clamp(dot(p - line.from, along) / squared_length, 0.0, 1.0);
  return line.from + t * along;
}

struct Distance {
  Vector3d p;
  double operator()(const PointForce& force) const { return length(p - force.center); }
  double operator()(const RadialForce& force) const { return length(p - force.center); }
  double operator()(const LineForce& force) const { return length(p - closest_point(force, p)); }
};

struct Direction {
  Vector3d p;
  Vector3d operator()(const PointForce& force) const { return normalised(force.direction); }
  Vector3d operator()(const RadialForce& force) const { return normalised(p - force.center); }
  Vector3d operator()(const LineForce& force) const {
    if (force.direction) return normalised(*force.direction);
    // On the segment there is no way out. The closest point is rounded, so "on" means within a few
    // ulps of the coordinates it was computed from; the direction of what is left would be noise.
    const Vector3d outward = p - closest_point(force, p);
    const double extent = std::max(
        {largest_component(p), largest_component(force.from), largest_component(force.to)});
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * extent;
    return largest_component(outward) <= rounding ? Vector3d::Zero() : normalised(outward);
  }
};

}  // namespace

double distance(const ForceShape& shape, const Vector3d& p) {
  return std::visit(Distance{p}, shape);
}

Vector3d direction(const ForceShape& shape, const Vector3d& p) {
  return std::visit(Direction{p}, shape);
}

Vector3d force_at(const SampledForce& force, const Vector3d& p) {
  const double s = distance(force.shape, p) / force.force_radius;
  return force.magnitude * falloff(force.falloff, s) * direction(force.shape, p);
}

}  // namespace pliant
