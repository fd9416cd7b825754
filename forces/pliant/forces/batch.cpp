#include "pliant/forces/batch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pliant/forces/vectors.hpp"

namespace pliant {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

BatchNumbers distances_from(const Vector3d& center, const Batch& points) {
  const double cx = center.x(), cy = center.y(), cz = center.z();
  BatchNumbers numbers;
  for (int k = 0; k < points.count; ++k) {
    const double x = points.x[k] - cx, y = points.y[k] - cy, z = points.z[k] - cz;
    numbers.of[k] = std::sqrt(x * x + y * y + z * z);
  }
  return numbers;
}

struct Distances {
  const Batch& points;

  BatchNumbers operator()(const PointForce& force) const {
    return distances_from(force.center, points);
  }
  BatchNumbers operator()(const RadialForce& force) const {
    return distances_from(force.center, points);
  }
  BatchNumbers operator()(const NoiseForce& force) const {
    return distances_from(force.center, points);
  }
  BatchNumbers operator()(const UniformForce&) const { return {}; }
  BatchNumbers operator()(const InertiaForce&) const { return {}; }

  BatchNumbers operator()(const LineForce& line) const {
    const Vector3d along = line.to - line.from;
    const double squared_length = dot(along, along);
    if (squared_length == 0) return distances_from(line.from, points);
    const double fx = line.from.x(), fy = line.from.y(), fz = line.from.z();
    const double ax = along.x(), ay = along.y(), az = along.z();
    BatchNumbers numbers;
    for (int k = 0; k < points.count; ++k) {
      const double px = points.x[k], py = points.y[k], pz = points.z[k];
      const double t = ((px - fx) * ax + (py - fy) * ay + (pz - fz) * az) / squared_length;
      const double above = t < 0.0 ? 0.0 : t;
      const double s = 1.0 < above ? 1.0 : above;
      const double x = px - (fx + s * ax), y = py - (fy + s * ay), z = pz - (fz + s * az);
      numbers.of[k] = std::sqrt(x * x + y * y + z * z);
    }
    return numbers;
  }

  BatchNumbers operator()(const VortexForce& vortex) const {
    const Vector3d axis = normalised(vortex.axis);
    const double cx = vortex.center.x(), cy = vortex.center.y(), cz = vortex.center.z();
    const double ax = axis.x(), ay = axis.y(), az = axis.z();
    BatchNumbers numbers;
    for (int k = 0; k < points.count; ++k) {
      const double ox = points.x[k] - cx, oy = points.y[k] - cy, oz = points.z[k] - cz;
      const double s = ox * ax + oy * ay + oz * az;
      const double x = ox - s * ax, y = oy - s * ay, z = oz - s * az;
      numbers.of[k] = std::sqrt(x * x + y * y + z * z);
    }
    return numbers;
  }

  BatchNumbers operator()(const FunctionForce& function) const {
    BatchNumbers numbers;
    for (int k = 0; k < points.count; ++k) numbers.of[k] = function.distance(points.at(k));
    return numbers;
  }
};

// The unit force if it is the same everywhere.
struct CommonUnitForce {
  std::optional<Vector3d> operator()(const PointForce& force) const {
    return normalised(force.direction);
  }
  std::optional<Vector3d> operator()(const UniformForce& force) const {
    return normalised(force.direction);
  }
  std::optional<Vector3d> operator()(const LineForce& force) const {
    if (!force.direction) return {};
    return normalised(*force.direction);
  }
  template <class Other>
  std::optional<Vector3d> operator()(const Other&) const {
    return {};
  }
};

// magnitude x falloff at each distance.
BatchNumbers strengths(const SampledForce& force, const BatchNumbers& distance, int count) {
  BatchNumbers strength = distance;
  const double magnitude = force.magnitude;
  const double radius = force.force_radius;
  double* const of = strength.of;
  if (force.falloff_curve) {
    for (int k = 0; k < count; ++k) {
      of[k] = magnitude * force.falloff_curve->value(std::min(of[k] / radius, 1.0))[0];
    }
    return strength;
  }
  switch (force.falloff) {
    case Falloff::Constant:
      std::fill_n(of, count, magnitude * 1.0);
      break;
    case Falloff::Linear:
      for (int k = 0; k < count; ++k) {
        const double rest = 1 - of[k] / radius;
        of[k] = magnitude * (0.0 < rest ? rest : 0.0);
      }
      break;
    case Falloff::Smooth:
      for (int k = 0; k < count; ++k) {
        const double rest = 1 - of[k] / radius;
        const double above = rest < 0.0 ? 0.0 : rest;
        const double x = 1.0 < above ? 1.0 : above;
        of[k] = magnitude * (x * x * (3 - 2 * x));
      }
      break;
    case Falloff::Gaussian:
      for (int k = 0; k < count; ++k)
        of[k] = magnitude * falloff(Falloff::Gaussian, of[k] / radius);
      break;
  }
  return strength;
}

// Rounding is monotone: for a component p >= low > c, the computed p - c is not below the computed
// low - c, and the same is true for squares, sums and the root. So the distance computed from the
// smallest differences is a bound without an extra tolerance.
double gap_to_box(double low, double high, double from, double to) {
  if (low > to) return low - to;
  return high < from ? from - high : 0;
}

double least_from(const Vector3d& center, const Vector3d& low, const Vector3d& high) {
  Vector3d gap;
  for (int k = 0; k < 3; ++k) gap[k] = gap_to_box(low[k], high[k], center[k], center[k]);
  return length(gap);
}

struct LeastDistance {
  const Vector3d& low;
  const Vector3d& high;

  double operator()(const PointForce& force) const { return least_from(force.center, low, high); }
  double operator()(const RadialForce& force) const { return least_from(force.center, low, high); }
  double operator()(const NoiseForce& force) const { return least_from(force.center, low, high); }
  double operator()(const UniformForce&) const { return 0; }
  double operator()(const InertiaForce&) const { return 0; }
  double operator()(const FunctionForce&) const { return 0; }

  // To the bounding box of the segment, which contains the closest point except for its rounding:
  // three operations on numbers no larger than |from| + |to|.
  double operator()(const LineForce& line) const {
    Vector3d gap;
    for (int k = 0; k < 3; ++k) {
      const double rounding = 8 * epsilon * (std::abs(line.from[k]) + std::abs(line.to[k])) +
                              std::numeric_limits<double>::min();
      gap[k] = gap_to_box(low[k], high[k], std::min(line.from[k], line.to[k]) - rounding,
                          std::max(line.from[k], line.to[k]) + rounding);
    }
    const double bound = length(gap);
    return bound >= 0 ? bound : 0;
  }

  // A distance changes no faster than the position: the distance of the middle minus half the
  // diagonal. Each computed distance is off by less than 16 roundings of the offset from the
  // centre, and by the squares of components below 1e-150, which underflow.
  double operator()(const VortexForce& vortex) const {
    const Vector3d middle = low + 0.5 * (high - low);
    const double reach = length((high - middle).cwiseMax(middle - low));
    const double offset = length(middle - vortex.center) + reach;
    const double bound = vortex.distance(middle) - reach - 64 * epsilon * offset - 1e-150;
    return bound >= 0 ? bound : 0;
  }
};

}  // namespace

BatchNumbers distances(const ForceShape& shape, const Batch& points) {
  return std::visit(Distances{points}, shape);
}

void add_forces(const SampledForce& force, const Batch& points, int first, Batch& sums) {
  const BatchNumbers strength = strengths(force, distances(force.shape, points), points.count);
  double* const x = sums.x + first;
  double* const y = sums.y + first;
  double* const z = sums.z + first;
  if (const auto unit = std::visit(CommonUnitForce{}, force.shape)) {
    const double ux = unit->x(), uy = unit->y(), uz = unit->z();
    for (int k = 0; k < points.count; ++k) {
      x[k] += strength.of[k] * ux;
      y[k] += strength.of[k] * uy;
      z[k] += strength.of[k] * uz;
    }
    return;
  }
  std::visit(
      [&](const auto& shape) {
        for (int k = 0; k < points.count; ++k) {
          const Vector3d unit = shape.unit_force(points.at(k));
          x[k] += strength.of[k] * unit.x();
          y[k] += strength.of[k] * unit.y();
          z[k] += strength.of[k] * unit.z();
        }
      },
      force.shape);
}

double least_distance(const ForceShape& shape, const Vector3d& low, const Vector3d& high) {
  return std::visit(LeastDistance{low, high}, shape);
}

}  // namespace pliant
