#include "pliant/forces/force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "pliant/forces/batch.hpp"
#include "pliant/forces/noise.hpp"
#include "pliant/forces/vectors.hpp"

namespace pliant {

// Each kind of force has a kernel, made by `kernel(force)`: it holds what all positions share, and
// computes the rest for one position, or in a loop over many, with the same bits.
//   distance(p), unit_force(p)  as in force.hpp
//   least_distance(low, high)   as in batch.hpp
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Rounding is monotone: for a component p >= low > c, the computed p - c is not below the computed
// low - c, and the same is true for squares, sums and the root. So the distance computed from the
// smallest differences is a bound without an extra tolerance.
double gap_to_box(double low, double high, double from, double to) {
  if (low > to) return low - to;
  return high < from ? from - high : 0;
}

// On a segment or an axis there is no outward direction. The closest point is rounded, so "on"
// means within a few ulps of the coordinates from which it was computed; the direction of the
// remaining vector would be noise.
bool is_rounding(const Triple& outward, double extent) {
  return largest_component(outward) <= 8 * epsilon * extent;
}

// The distances of kinds that act around a point.
struct AroundCenter {
  Triple center;

  double distance(const Triple& p) const { return length(p - center); }
  double least_distance(const Triple& low, const Triple& high) const {
    return length(by_component(gap_to_box, low, high, center, center));
  }
};

// The distances of kinds that act everywhere.
struct Everywhere {
  double distance(const Triple&) const { return 0; }
  double least_distance(const Triple&, const Triple&) const { return 0; }
};

// The same force at every position that it selects.
template <class Distances>
struct Directed : Distances {
  Triple unit;

  Triple unit_force(const Triple&) const { return unit; }
};

inline Directed<AroundCenter> kernel(const PointForce& force) {
  return {{force.center}, normalised(force.direction)};
}

inline Directed<Everywhere> kernel(const UniformForce& force) {
  return {{}, normalised(force.direction)};
}

struct RadialKernel : AroundCenter {
  Triple unit_force(const Triple& p) const { return normalised(p - center); }
};
inline RadialKernel kernel(const RadialForce& force) { return {{force.center}}; }

// The distances of both kinds of line.
struct AroundSegment {
  Triple from, to;
  Triple along = to - from;
  double squared_length = dot(along, along);

  Triple closest_point(const Triple& p) const {
    if (squared_length == 0) return from;
    return from + std::clamp(dot(p - from, along) / squared_length, 0.0, 1.0) * along;
  }
  double distance(const Triple& p) const { return length(p - closest_point(p)); }
  // To the bounding box of the segment, which contains the closest point except for its rounding:
  // three operations on numbers no larger than |from| + |to|.
  double least_distance(const Triple& low, const Triple& high) const {
    const auto gap = [](double least, double most, double a, double b) {
      const double rounding =
          8 * epsilon * (std::abs(a) + std::abs(b)) + std::numeric_limits<double>::min();
      return gap_to_box(least, most, std::min(a, b) - rounding, std::max(a, b) + rounding);
    };
    const double bound = length(by_component(gap, low, high, from, to));
    return bound >= 0 ? bound : 0;
  }
};

struct OutwardLineKernel : AroundSegment {
  Triple unit_force(const Triple& p) const {
    const Triple outward = p - closest_point(p);
    const double extent =
        std::max({largest_component(p), largest_component(from), largest_component(to)});
    return is_rounding(outward, extent) ? Triple{} : normalised(outward);
  }
};

struct VortexKernel {
  Triple center;
  Triple axis;  // a unit vector, or 0
  double pull;

  // From the closest point of the axis to p; from the centre if the axis is 0.
  Triple outward(const Triple& p) const {
    const Triple offset = p - center;
    return offset - dot(offset, axis) * axis;
  }
  double distance(const Triple& p) const { return length(outward(p)); }
  Triple unit_force(const Triple& p) const {
    if (largest_component(axis) == 0) return {};
    const Triple from_axis = outward(p);
    const double extent = std::max(largest_component(p), largest_component(center));
    if (is_rounding(from_axis, extent)) return {};
    const Triple out = normalised(from_axis);
    return normalised(cross(axis, out)) - pull * out;
  }
  // A distance changes no faster than the position: the distance of the middle minus half the
  // diagonal. Each computed distance is off by less than 16 roundings of the offset from the
  // centre, and by the squares of components below 1e-150, which underflow.
  double least_distance(const Triple& low, const Triple& high) const {
    const Triple middle = low + 0.5 * (high - low);
    const auto larger = [](double a, double b) { return std::max(a, b); };
    const double reach = length(by_component(larger, high - middle, middle - low));
    const double offset = length(middle - center) + reach;
    const double bound = distance(middle) - reach - 64 * epsilon * offset - 1e-150;
    return bound >= 0 ? bound : 0;
  }
};
inline VortexKernel kernel(const VortexForce& force) {
  return {force.center, normalised(force.axis), force.pull};
}

struct NoiseKernel : AroundCenter {
  const NoiseForce& force;

  Triple unit_force(const Triple& p) const {
    return smooth_noise(force.seed, force.frequency * (p - center), force.time);
  }
};
inline NoiseKernel kernel(const NoiseForce& force) { return {{force.center}, force}; }

Triple times(const Matrix3d& matrix, const Triple& a) {
  const auto row = [&](int k) { return dot(Vector3d(matrix.row(k)), a); };
  return {row(0), row(1), row(2)};
}

struct TurnedNoiseKernel : AroundCenter {
  const NoiseForce& force;
  Matrix3d back = force.turn->transpose();

  Triple unit_force(const Triple& p) const {
    const Triple place = force.frequency * times(back, p - center);
    return times(*force.turn, smooth_noise(force.seed, place, force.time));
  }
};

struct InertiaKernel : Everywhere {
  const InertiaForce& force;

  Triple unit_force(const Triple& p) const {
    return force.offset + times(force.linear, p - force.origin);
  }
};
inline InertiaKernel kernel(const InertiaForce& force) { return {{}, force}; }

struct PressureKernel : AroundCenter {
  Triple unit_force(const Triple&) const { return {}; }
};
inline PressureKernel kernel(const PressureForce& force) { return {{force.center}}; }

template <class Value>
Value answer(const PositionFunction<Value>& function, const Vector3d& p, Value value) {
  function({&p, 1}, {&value, 1});
  return value;
}

struct CustomKernel {
  const SampledCustomForce& force;

  double distance(const Triple& p) const { return answer(force.distance, p, 0.0); }
  Triple unit_force(const Triple& p) const { return answer(force.unit_force, p, Vector3d()); }
  double least_distance(const Triple&, const Triple&) const { return 0; }
};
inline CustomKernel kernel(const SampledCustomForce& force) { return {force}; }

// The result of `use`, called with the kernel of a force.
template <class Force, class Use>
auto with_kernel(const Force& force, const Use& use) {
  return use(kernel(force));
}
template <class Use>
auto with_kernel(const LineForce& line, const Use& use) {
  const AroundSegment around{line.from, line.to};
  if (!line.direction) return use(OutwardLineKernel{around});
  return use(Directed<AroundSegment>{around, normalised(*line.direction)});
}
template <class Use>
auto with_kernel(const NoiseForce& noise, const Use& use) {
  if (!noise.turn) return use(kernel(noise));
  return use(TurnedNoiseKernel{{noise.center}, noise});
}
template <class Use>
auto with_kernel(const ForceKind& force, const Use& use) {
  return std::visit([&](const auto& kind) { return with_kernel(kind, use); }, force);
}

template <class Force>
double distance_of(const Force& force, const Vector3d& p) {
  return with_kernel(force, [&](const auto& kind) { return kind.distance(p); });
}

template <class Force>
Vector3d unit_force_of(const Force& force, const Vector3d& p) {
  return with_kernel(force, [&](const auto& kind) { return kind.unit_force(p); });
}

template <class Kernel>
BatchNumbers distances_from(const Kernel& kind, const Batch& points) {
  BatchNumbers numbers;
  for (int k = 0; k < points.count; ++k) numbers.of[k] = kind.distance(points.at(k));
  return numbers;
}

// The first vectors of a batch, for a program's functions.
struct Places {
  Places(const Batch& batch, int size) : count(static_cast<std::size_t>(size)) {
    for (int k = 0; k < size; ++k) at[k] = batch.at(k);
  }

  std::span<const Vector3d> span() const { return {at, count}; }

  Vector3d at[batch_size];
  std::size_t count;
};

BatchNumbers distances_from(const CustomKernel& kind, const Batch& points) {
  BatchNumbers numbers;
  const Places places(points, points.count);
  kind.force.distance(places.span(), {numbers.of, places.count});
  return numbers;
}

// Replaces every distance by magnitude x falloff.
void fade(const SampledForce& force, std::span<double> distances) {
  const double magnitude = force.magnitude, radius = force.force_radius;
  if (!force.falloff_curve) return fade(force.falloff, magnitude, radius, distances);
  for (double& each : distances) {
    each = magnitude * force.falloff_curve->value(std::min(each / radius, 1.0))[0];
  }
}

// What a force has for each node; null: nothing.
const Field* vectors_of_nodes(const SampledForce& force) {
  const auto* const inertia = std::get_if<InertiaForce>(&force.kind);
  return inertia ? inertia->of_nodes.get() : nullptr;
}

// The force per unit of magnitude and falloff on a node with that normal.
template <class Kernel>
Triple unit_force_along(const Kernel& kind, const Triple& p, const Triple& normal) {
  if constexpr (std::is_same_v<Kernel, PressureKernel>) return normal;
  return dot(normal, kind.unit_force(p)) * normal;
}

// `own_forces`. `strengths` has room for as many numbers.
void find_own_forces(const SampledForce& force, std::span<const Vector3d> points,
                     std::span<const Vector3d> normals, std::span<double> strengths,
                     std::span<Vector3d> forces) {
  const auto& own = std::get<SampledCustomForce>(force.kind);
  own.distance(points, strengths);
  fade(force, strengths);
  own.unit_force(points, forces);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const Triple unit = forces[k];
    const Triple pushing =
        force.is_along_normal ? dot(normals[k], unit) * Triple(normals[k]) : unit;
    forces[k] = strengths[k] * pushing;
  }
}

// Magnitude x falloff of a force whose distance is 0 everywhere.
double strength_everywhere(const SampledForce& force) {
  double strength = 0;
  fade(force, {&strength, 1});
  return strength;
}

}  // namespace

double PointForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d PointForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double RadialForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d RadialForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double LineForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d LineForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double UniformForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d UniformForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double VortexForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d VortexForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double NoiseForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d NoiseForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double InertiaForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d InertiaForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }
double PressureForce::distance(const Vector3d& p) const { return distance_of(*this, p); }
Vector3d PressureForce::unit_force(const Vector3d& p) const { return unit_force_of(*this, p); }

SampledForce region_sphere(const Vector3d& center, double deformation_radius) {
  return {.kind = PointForce{center, Vector3d::Zero()},
          .magnitude = 0,
          .deformation_radius = deformation_radius,
          .force_radius = 0};
}

double distance(const ForceKind& force, const Vector3d& p) { return distance_of(force, p); }

Vector3d unit_force(const ForceKind& force, const Vector3d& p) { return unit_force_of(force, p); }

Vector3d force_at(const SampledForce& force, const Vector3d& p) {
  return with_kernel(force.kind, [&](const auto& kind) {
    double strength = kind.distance(p);
    fade(force, {&strength, 1});
    return strength * kind.unit_force(p);
  });
}

Vector3d force_on(const SampledForce& force, const Vector3d& p, int node, const Vector3d& normal) {
  if (uses_normals(force)) {
    return with_kernel(force.kind, [&](const auto& kind) -> Vector3d {
      double strength = kind.distance(p);
      fade(force, {&strength, 1});
      return strength * unit_force_along(kind, p, normal);
    });
  }
  Vector3d load = force_at(force, p);
  if (const Field* const of_nodes = vectors_of_nodes(force)) {
    load += strength_everywhere(force) * of_nodes->row(node).transpose();
  }
  return load;
}

BatchNumbers distances(const ForceKind& force, const Batch& points) {
  return with_kernel(force, [&](const auto& kind) { return distances_from(kind, points); });
}

void add_forces(const SampledForce& force, const Batch& points, const Batch* normals, int node,
                int first, Batch& sums) {
  if (is_own(force)) {
    const Places places(points, points.count);
    const Places sides(normals ? *normals : points, normals ? points.count : 0);
    BatchNumbers strengths;
    Vector3d forces[batch_size];
    find_own_forces(force, places.span(), sides.span(), {strengths.of, places.count},
                    {forces, places.count});
    for (int k = 0; k < points.count; ++k) {
      sums.x[first + k] += forces[k].x();
      sums.y[first + k] += forces[k].y();
      sums.z[first + k] += forces[k].z();
    }
    return;
  }
  if (uses_normals(force) || vectors_of_nodes(force)) {
    for (int k = 0; k < points.count; ++k) {
      const Vector3d normal = normals ? normals->at(k) : Vector3d(Vector3d::Zero());
      const Vector3d load = force_on(force, points.at(k), node + k, normal);
      sums.x[first + k] += load.x();
      sums.y[first + k] += load.y();
      sums.z[first + k] += load.z();
    }
    return;
  }
  with_kernel(force.kind, [&](const auto& kind) {
    BatchNumbers strength = distances_from(kind, points);
    fade(force, {strength.of, static_cast<std::size_t>(points.count)});
    double* const x = sums.x + first;
    double* const y = sums.y + first;
    double* const z = sums.z + first;
    for (int k = 0; k < points.count; ++k) {
      const Triple unit = kind.unit_force(points.at(k));
      x[k] += strength.of[k] * unit.x;
      y[k] += strength.of[k] * unit.y;
      z[k] += strength.of[k] * unit.z;
    }
  });
}

std::vector<Vector3d> own_forces(const SampledForce& force, std::span<const Vector3d> points,
                                 std::span<const Vector3d> normals) {
  std::vector<double> strengths(points.size());
  std::vector<Vector3d> forces(points.size());
  find_own_forces(force, points, normals, strengths, forces);
  return forces;
}

double least_distance(const ForceKind& force, const Vector3d& low, const Vector3d& high) {
  return with_kernel(force, [&](const auto& kind) { return kind.least_distance(low, high); });
}

}  // namespace pliant
