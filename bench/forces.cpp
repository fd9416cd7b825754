// Measures the cost of a force at a position, for every kind of force and every falloff.
//
//   distances   for 32 positions at once
//   forces      add_forces for 32 positions at once, which includes their distances
//   one by one  force_at for each position
//   bound       least_distance of a box, for each position
//
// Nanoseconds of a position, medians over rounds; a round measures everything once, so that noise
// affects all alike. With --least the minima, for a shared machine.
//
// Run: build/release/bench/forces [--rounds N] [--least]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/forces/batch.hpp"

namespace {

using namespace pliant;

constexpr int batch_count = 64;

struct Row {
  std::string name;
  SampledForce force;
  std::vector<double> distances = {}, forces = {}, one_by_one = {}, bounds = {};  // [ns]
};

std::vector<Row> rows() {
  const Vector3d center{0.3, 0.2, -0.1}, axis{0.1, 1, 0.2};
  const std::vector<std::pair<std::string, ForceKind>> shapes = {
      {"point", PointForce{center, axis}},
      {"radial", RadialForce{center}},
      {"line", LineForce{center, axis, {}}},
      {"line, directed", LineForce{center, axis, center}},
      {"uniform", UniformForce{axis}},
      {"vortex", VortexForce{center, axis, 0.3}},
      {"noise", NoiseForce{center, 3, 0.5, 7}},
      {"inertia", InertiaForce{Matrix3d::Identity(), center, axis}},
      {"function", SampledCustomForce{[](const Vector3d& p) { return std::abs(p.x()); },
                                      [](const Vector3d& p) { return p; }}}};
  std::vector<Row> rows;
  for (const auto& [name, shape] : shapes) rows.push_back({name, {.kind = shape, .magnitude = 2}});
  for (const auto& [name, falloff] : {std::pair{"point, linear", Falloff::Linear},
                                      {"point, smooth", Falloff::Smooth},
                                      {"point, gaussian", Falloff::Gaussian}}) {
    Row& row = rows.emplace_back(rows.front());
    row.name = name;
    row.force.falloff = falloff;
  }
  return rows;
}

std::vector<Batch> batches() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<Batch> batches(batch_count);
  for (Batch& batch : batches) {
    batch.count = batch_size;
    for (double* of : {batch.x, batch.y, batch.z}) {
      std::generate_n(of, batch_size, [&] { return place(random); });
    }
  }
  return batches;
}

// What the measured functions return, so that they cannot be left out.
double sum = 0;

// Calls `work` for each batch, and returns the nanoseconds of a position.
template <class Work>
double nanoseconds(const std::vector<Batch>& batches, const Work& work) {
  const double once = seconds([&] {
    for (const Batch& batch : batches) work(batch);
  });
  return once * 1e9 / (batch_count * batch_size);
}

void measure(Row& row, const std::vector<Batch>& batches) {
  const SampledForce& force = row.force;
  row.distances.push_back(
      nanoseconds(batches, [&](const Batch& batch) { sum += distances(force.kind, batch).of[0]; }));
  Batch sums = {};
  row.forces.push_back(
      nanoseconds(batches, [&](const Batch& batch) { add_forces(force, batch, 0, 0, sums); }));
  sum += sums.x[0];
  row.one_by_one.push_back(nanoseconds(batches, [&](const Batch& batch) {
    for (int k = 0; k < batch.count; ++k) sum += force_at(force, batch.at(k)).x();
  }));
  row.bounds.push_back(nanoseconds(batches, [&](const Batch& batch) {
    for (int k = 0; k < batch.count; ++k) {
      const Vector3d low = batch.at(k);
      sum += least_distance(force.kind, low, low + Vector3d(0.1, 0.1, 0.1));
    }
  }));
}

}  // namespace

int main(int count, char* arguments[]) {
  int rounds = 300;
  bool is_least = false;
  for (int k = 1; k < count; ++k) {
    const std::string_view name = arguments[k];
    if (name == "--least") {
      is_least = true;
    } else if (name != "--rounds" || ++k == count || !read_number(arguments[k], rounds) ||
               rounds < 1) {
      fmt::print(stderr, "usage: forces [--rounds N] [--least]\n");
      return 2;
    }
  }
  const std::vector<Batch> positions = batches();
  std::vector<Row> all = rows();
  for (int round = 0; round < rounds; ++round) {
    for (Row& row : all) measure(row, positions);
  }
  fmt::print("{:>16} {:>10} {:>10} {:>10} {:>10}\n", "", "distances", "forces", "one by one",
             "bound");
  for (const Row& row : all) {
    fmt::print("{:>16} {:>10.2f} {:>10.2f} {:>10.2f} {:>10.2f}\n", row.name,
               typical(row.distances, is_least), typical(row.forces, is_least),
               typical(row.one_by_one, is_least), typical(row.bounds, is_least));
  }
  // Printed only for an input that does not occur.
  if (sum == 0.125) fmt::print("{}\n", sum);
  return 0;
}
