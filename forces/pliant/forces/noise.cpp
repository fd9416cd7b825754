#include "pliant/forces/noise.hpp"

#include <cmath>

namespace pliant {
namespace {

// Eq. (18): a bijection of 64 bits that spreads every bit over all others, the output function of
// SplitMix64. Source: G. L. Steele, D. Lea, C. H. Flood, Fast Splittable Pseudorandom Number
// Generators (2014), with D. Stafford's thirteenth set of constants.
constexpr std::uint64_t mixed(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15U;
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return bits ^ (bits >> 31U);
}

// A cell of the lattice along one axis, and the position in it.
struct Place {
  std::int64_t cell = 0;
  double weight = 0;  // of the cell's far corner, eq. (20)
};

Place place_at(double coordinate) {
  if (!std::isfinite(coordinate)) return {};
  const double floor = std::floor(coordinate);
  const double f = coordinate - floor;
  // Beyond 2^53 there is no fraction, beyond 2^63 no integer: the lattice repeats after 2^62 cells.
  // fmod is exact.
  constexpr double period = 4611686018427387904.0;
  return {static_cast<std::int64_t>(std::fmod(floor, period)), f * f * f * (f * (6 * f - 15) + 10)};
}

Vector3d blend(const Vector3d& near, const Vector3d& far, double weight) {
  return near * (1 - weight) + far * weight;
}

}  // namespace

Vector3d lattice_vector(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z,
                        std::int64_t t) {
  std::uint64_t hash = mixed(seed);
  for (const std::int64_t index : {x, y, z, t}) {
    hash = mixed(hash ^ static_cast<std::uint64_t>(index));
  }
  // Eq. (19): three groups of 21 bits, the largest of which maps to 1.
  constexpr std::uint64_t largest = (1U << 21U) - 1;
  Vector3d vector;
  for (unsigned k = 0; k < 3; ++k) {
    const auto bits = static_cast<double>((hash >> (21 * k)) & largest);
    vector[k] = 2 * bits / static_cast<double>(largest) - 1;
  }
  return vector;
}

Vector3d smooth_noise(std::uint64_t seed, const Vector3d& place, double time) {
  const Place x = place_at(place.x()), y = place_at(place.y()), z = place_at(place.z());
  const Place t = place_at(time);
  const auto along_x = [&](int dy, int dz, int dt) {
    return blend(lattice_vector(seed, x.cell, y.cell + dy, z.cell + dz, t.cell + dt),
                 lattice_vector(seed, x.cell + 1, y.cell + dy, z.cell + dz, t.cell + dt), x.weight);
  };
  const auto along_y = [&](int dz, int dt) {
    return blend(along_x(0, dz, dt), along_x(1, dz, dt), y.weight);
  };
  const auto along_z = [&](int dt) { return blend(along_y(0, dt), along_y(1, dt), z.weight); };
  return blend(along_z(0), along_z(1), t.weight);
}

}  // namespace pliant
