// Measures surfaces of triangles against what the sparse factor of the same matrix takes in the
// same run. A frame is 20 backward Euler steps of three components, from one state to the next.
//
//   kept      a frame whose region and coefficients are those of the frame before
//   sliding   a frame whose force, and with it region and factor, is new
//   bound     of kept: 20 solves by the library; of sliding: its order and factor too
//   ratio     of a frame to its bound
//   read      an OBJ file; prepare: nodes, faces, triangles, and the tree for selecting
//   select    a force that reaches a hundredth of the surface
//
// Times are medians, one thread. Run: build/release/bench/meshes [--large]

#include "support/meshes.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "measuring.hpp"
#include "pliant/body/triangle_body.hpp"
#include "pliant/files/obj/read_obj.hpp"

namespace {

using namespace pliant;

constexpr int steps = 20;

SampledForce poke(double x, double radius) {
  return {PointForce{{x, 0, 0.3 * x}, {0, 1, 0}}, 1, radius, 0.5 * radius, Falloff::Smooth};
}

BodyInputs inputs_of(const SampledForce& force) {
  BodyInputs in;
  in.dynamics = {0.01, 0.05};
  in.frame_length = 1.0 / 24;
  in.dt = in.frame_length / steps;
  in.forces = {force};
  return in;
}

template <class Work>
double median_ms(int repetitions, const Work& work) {
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) times.push_back(1e3 * seconds(work));
  return typical(std::move(times), false);
}

// What the factor takes for the matrix of a body's last step.
struct Bound {
  double factor = 0, solves = 0;  // [ms]
};

Bound bound_of(const TriangleBody& body, const BodyInputs& in, int repetitions) {
  const TrianglePatch& patch = body.last_step().surface->patches.at(0);
  const TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
  const double dt = in.frame_length / steps;
  const Bending bending = bending_of(in, body.surface().unit, body.settings().border);
  const SparseMatrix matrix = plate.matrix(bending, in.dynamics.shift(dt)).value();
  std::unique_ptr<SparseFactor> factor;
  Bound bound;
  bound.factor = median_ms(repetitions, [&] {
    factor = make_sparse_factor(available_solvers().front());
    if (!factor->analyze(matrix) || !factor->factorize(matrix, {})) std::abort();
  });
  const Field forces = Field::Random(matrix.rows(), 3);
  bound.solves = median_ms(repetitions, [&] {
    for (int step = 0; step < steps; ++step) {
      if (!factor->solve(forces)) std::abort();
    }
  });
  return bound;
}

void measure_frames(int count, bool has_quads) {
  const Mesh mesh = testing::square(count, 1, 0.3, has_quads);
  TriangleBody body(std::make_shared<TriangleSurface>(make_surface(mesh).value()),
                    {.measure = Measure::Rest});
  const int repetitions = count < 200 ? 9 : 3;
  const BodyInputs in = inputs_of(poke(0, 0.45));
  const auto step = [&](const BodyInputs& inputs) {
    if (!body.step(inputs)) std::abort();
  };
  step(in);
  const Bound bound = bound_of(body, in, repetitions);
  const double kept = median_ms(repetitions, [&] { step(in); });
  double x = 0;
  const double sliding = median_ms(repetitions, [&] { step(inputs_of(poke(x += 1e-3, 0.45))); });
  const double whole = bound.factor + bound.solves;
  fmt::print("| {} | {} | {} | {:.0f} | {:.0f} | {:.2f} | {:.0f} | {:.0f} | {:.2f} |\n",
             body.last_step().unknown_count(), has_quads ? "quads" : "triangles",
             body.last_step().surface->patches[0].cells.cells.size(), kept, bound.solves,
             kept / bound.solves, sliding, whole, sliding / whole);
  std::fflush(stdout);
}

void measure_preparation(int count) {
  const Mesh mesh = testing::square(count, 1, 0.3);
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("pliant-bench-meshes-{}.obj", ::getpid());
  {
    std::ofstream out(file);
    for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k) {
      out << fmt::format("v {} {} {}\n", mesh.positions(k, 0), mesh.positions(k, 1),
                         mesh.positions(k, 2));
    }
    for (std::size_t k = 0; k < mesh.corner_vertices.size(); k += 3) {
      out << fmt::format("f {} {} {}\n", mesh.corner_vertices[k] + 1,
                         mesh.corner_vertices[k + 1] + 1, mesh.corner_vertices[k + 2] + 1);
    }
  }
  const double read = median_ms(3, [&] {
    if (!read_obj(file, "")) std::abort();
  });
  std::filesystem::remove(file);
  std::unique_ptr<TriangleBody> body;
  const double prepare = median_ms(3, [&] {
    body = std::make_unique<TriangleBody>(
        std::make_shared<TriangleSurface>(make_surface(mesh).value()),
        BodySettings{.measure = Measure::Rest});
  });
  const BodyInputs in = inputs_of(poke(0, 0.0564));  // of area 0.01
  const double select = median_ms(9, [&] {
    if (!body->look(in)) std::abort();
  });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "\n{} triangles: read {:.0f} ms, prepare {:.0f} ms, select {:.1f} ms ({} nodes inside); "
      "at most {:.0f} MB in all\n",
      mesh.face_sizes.size(), read, prepare, select, body->look(in)->unknown_count(),
      static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace

int main(int count, char** arguments) {
  bool is_large = false;
  if (!read_options(count, arguments, {{"--large", &is_large}}, "meshes [--large]")) return 2;
  fmt::print(
      "| nodes inside | faces | cells | kept, ms | bound | ratio | sliding, ms | bound | ratio |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const int side : {40, 125}) {
    for (const bool has_quads : {false, true}) measure_frames(side, has_quads);
  }
  if (is_large) measure_frames(395, false);
  measure_preparation(707);
}
