// Measures surfaces of triangles against what CHOLMOD takes for the same matrix in the same run. A
// frame is 20 backward Euler steps of three components, from one state to the next.
//
//   kept      a frame whose region and coefficients are those of the frame before
//   sliding   a frame whose force, and with it region and factor, is new
//   order     and pattern of the factor; numbers: those of it
//   (a)       20 solves with CHOLMOD's simplicial factor; of sliding: AMD's order and the factor
//             too
//   (b)       the same with its supernodal factor and the system's BLAS, one thread
//   memory    of the factor, as a part of (a)'s
//   limit     40 times reading as many bytes as the factor has
//   read      an OBJ file; prepare: nodes, faces, triangles, and the tree for selecting
//   select    a force that reaches a hundredth of the surface
//
// Times are medians in ms, in brackets as a part of (a) and of (b). Run:
// build/release/bench/meshes [--large] [--threads N] [--csv FILE]. --large adds 10^5 nodes; with
// --csv, which prints the rows for script/performance_plot, also 10^6, without (a) and (b).

#include "support/meshes.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "measuring.hpp"
#include "pliant/body/triangle_body.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/files/obj/read_obj.hpp"
#ifdef PLIANT_BENCH_SUPERNODAL
#include "supernodal.hpp"
#endif

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

// What a factor takes. [ms], [bytes]
struct FactorCost {
  double order = 0, numbers = 0, solves = 0;
  std::size_t bytes = 0;

  double all() const { return order + numbers + solves; }
};

FactorCost cost_of(const SparseMatrix& matrix, SolverChoice choice, const RunContext& context,
                   int repetitions) {
  std::unique_ptr<SparseFactor> factor;
  FactorCost cost;
  cost.order = median_ms(repetitions, [&] {
    factor = make_sparse_factor(choice, context);
    if (!factor->analyze(matrix)) std::abort();
  });
  cost.numbers = median_ms(repetitions, [&] {
    if (!factor->factorize(matrix, {})) std::abort();
  });
  const Field forces = Field::Random(matrix.rows(), 3);
  cost.solves = median_ms(repetitions, [&] {
    for (int step = 0; step < steps; ++step) {
      if (!factor->solve(forces)) std::abort();
    }
  });
  cost.bytes = factor->bytes();
  return cost;
}

FactorCost cost_of_supernodal([[maybe_unused]] const SparseMatrix& matrix,
                              [[maybe_unused]] int repetitions) {
  FactorCost cost;
#ifdef PLIANT_BENCH_SUPERNODAL
  std::unique_ptr<bench::SupernodalCholmod> factor;
  const double first = median_ms(repetitions, [&] {
    factor = std::make_unique<bench::SupernodalCholmod>(CHOLMOD_AMD);
    factor->factor(matrix);
  });
  cost.numbers = median_ms(repetitions, [&] { factor->factor(matrix); });
  cost.order = first - cost.numbers;
  const Field forces = Field::Random(matrix.rows(), 3);
  cost.solves = median_ms(repetitions, [&] {
    for (int step = 0; step < steps; ++step) factor->solve(forces);
  });
#endif
  return cost;
}

// The time of 20 solves that only read the factor. [ms]
double limit_of(std::size_t bytes, int repetitions) {
  const Eigen::ArrayXd numbers =
      Eigen::ArrayXd::Ones(static_cast<Eigen::Index>(bytes / sizeof(double)));
  volatile double sum = 0;
  return 2 * steps * median_ms(repetitions, [&] { sum = numbers.sum(); });
}

struct Frames {
  int nodes = 0;
  double kept = 0, sliding = 0, limit = 0;  // [ms]
};

Frames measure_frames(int count, bool has_quads, ThreadPool* threads) {
  const Mesh mesh = testing::square(count, 1, 0.3, has_quads);
  const RunContext context{.threads = threads};
  TriangleBody body(std::make_shared<TriangleSurface>(make_surface(mesh).value()),
                    {.measure = Measure::Rest}, SolverChoice::Auto, context);
  const int repetitions = count < 200 ? 9 : 3;
  const BodyInputs in = inputs_of(poke(0, 0.45));
  const auto step = [&](const BodyInputs& inputs) {
    if (!body.step(inputs)) std::abort();
  };
  step(in);
  const TrianglePatch& patch = body.last_step().surface->patches.at(0);
  TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
  SparseMatrix matrix =
      plate.stiffness(bending_of(in, body.surface().unit, body.settings().border)).value();
  for (std::size_t k = 0; k < patch.masses.size(); ++k) {
    matrix.valuePtr()[matrix.outerIndexPtr()[k + 1] - 1] +=
        in.dynamics.shift(in.frame_length / steps) * patch.masses[k];
  }
  const FactorCost ours = cost_of(matrix, SolverChoice::Supernodal, context, repetitions);
  const double kept = median_ms(repetitions, [&] { step(in); });
  double x = 0;
  const double sliding = median_ms(repetitions, [&] { step(inputs_of(poke(x += 1e-3, 0.45))); });
  const int nodes = body.last_step().unknown_count();
  const auto parts = [](double time, const std::string& part) {
    return fmt::format("{:.0f} {}", time, part);
  };
  std::string of_kept, of_sliding, of_solves, memory = "-";
  if (count < 1000) {
    const FactorCost simplicial = cost_of(matrix, SolverChoice::Cholmod, {}, repetitions);
    const FactorCost supernodal = cost_of_supernodal(matrix, repetitions);
    const auto beside = [](double time, double one, double other) {
      return fmt::format("({:.2f}, {:.2f})", time / one, time / other);
    };
    of_kept = beside(kept, simplicial.solves, supernodal.solves);
    of_sliding = beside(sliding, simplicial.all(), supernodal.all());
    of_solves = beside(ours.solves, simplicial.solves, supernodal.solves);
    memory = fmt::format("{:.2f}",
                         static_cast<double>(ours.bytes) / static_cast<double>(simplicial.bytes));
  }
  const double limit = limit_of(ours.bytes, repetitions);
  fmt::print("| {} | {} | {} | {} | {:.0f} + {:.0f} | {} | {:.0f} | {} |\n", nodes,
             has_quads ? "quads" : "triangles", parts(kept, of_kept), parts(sliding, of_sliding),
             ours.order, ours.numbers, parts(ours.solves, of_solves), limit, memory);
  std::fflush(stdout);
  return {nodes, kept, sliding, limit};
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
  int threads = 1;
  std::string csv;
  if (!read_options(count, arguments,
                    {{"--large", &is_large}, {"--threads", &threads}, {"--csv", &csv}},
                    "meshes [--large] [--threads N] [--csv FILE]"))
    return 2;
  ThreadPool pool(std::max(1, threads));
  ThreadPool* const used = threads > 1 ? &pool : nullptr;
  fmt::print(
      "| nodes inside | faces | kept | sliding | order + numbers | 20 solves | limit | memory |\n"
      "|---|---|---|---|---|---|---|---|\n");
  std::vector<Frames> rows;
  for (const int side : {40, 125}) {
    rows.push_back(measure_frames(side, false, used));
    measure_frames(side, true, used);
  }
  if (is_large) rows.push_back(measure_frames(395, false, used));
  if (csv.empty()) {
    measure_preparation(707);
    return 0;
  }
  rows.push_back(measure_frames(1250, false, used));
  std::ofstream out(csv);
  out << "nodes,kept,sliding,limit\n";
  for (const Frames& row : rows)
    out << fmt::format("{},{},{},{}\n", row.nodes, row.kept, row.sliding, row.limit);
  out.close();
  if (out) return 0;
  fmt::print(stderr, "meshes: cannot write {}\n", csv);
  return 1;
}
