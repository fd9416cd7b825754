// Measures the cost of a plate in sine space, compared with its minimal memory traffic and with
// sparse factors, in one run. A frame is 20 backward Euler steps of three components from one state
// to the next, including all transforms. Every time is a median, every ratio the median of ratios
// of adjacent measurements, since the machine may be noisy.
//
//   triad     a[k] = b[k] + 3 c[k] over 15 doubles per node: the least memory traffic of a step
//   step      one of the steps, the state in sine space
//   set-up    for new coefficients
//   frame     20 steps and the transforms; "new" with the set-up, "kept" without
//   goal      the kept frame with a goal, as a multiple of the one without
//   simplicial, supernodal, eigen   the same frame with sparse factors, as a multiple of the
//             spectral time, with new coefficients and with the factor kept. The fill-reducing
//             order is always kept
//
// Run: build/release/bench/plate [--boxes 51,101x801,...] [--direct SIDE]
//      [--threads N] [--csv FILE]
// Sparse factors are measured up to SIDE nodes per side (401), simplicial ones and Eigen's up to
// half of that. --csv prints the rows for script/performance_plot.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/spectral/spectral_plate.hpp"
#ifdef PLIANT_BENCH_SUPERNODAL
#include "supernodal.hpp"
#endif

namespace {

using namespace pliant;

constexpr int steps_per_frame = 20;
constexpr double dt = 1.0 / 24 / steps_per_frame;
constexpr Dynamics dynamics{40, 20};

struct Options {
  // Squares with smooth numbers of intervals; then neighbouring sizes with a prime number or twice
  // a prime; then longer boxes.
  std::string boxes = "51,101,201,401,701,1001,2001,102,198,402,398,720,101x801,801x101,31x2001";
  int direct_side = 401;
  int threads = 1;
  std::string csv;  // file; empty: none
};

double median(std::vector<double> numbers) { return typical(std::move(numbers), false); }

// A frame of sparse factors. [s]
struct DirectCost {
  double factor = 0;
  double step = 0;
};

DirectCost cost_of(PlateSolver& solver, const PlateProblem& problem, const PlateState& state) {
  PlateSystem system{problem.outline, problem.stiffness, problem.dynamics.shift(dt)};
  if (!solver.prepare(system)) return {};  // computes the fill-reducing order, which is kept
  system.stiffness.c += 1e-6;
  DirectCost cost;
  cost.factor = seconds([&] { (void)solver.prepare(system); });
  PlateProblem factored = problem;
  factored.stiffness = system.stiffness;
  constexpr int count = 2;
  std::vector<double> times;
  for (int round = 0; round < 3; ++round) {
    times.push_back(seconds([&] { (void)solver.advance(factored, {count, dt}, state); }));
  }
  cost.step = median(times) / count;
  return cost;
}

struct Row {
  int columns = 0, rows = 0;
  double triad = 0, step = 0, set_up = 0, frame = 0;  // [s]
  double step_per_triad = 0;
  double with_goal = 0;  // a kept frame, over one without
  double doubles = 0;    // memory of the solver per node
  std::optional<DirectCost> supernodal = {}, simplicial = {}, eigen = {};

  double with_set_up() const { return frame + set_up; }
};

Row measure(int columns, int rows, const Options& options, ThreadPool& threads) {
  const Grid grid{columns, rows, 1.0 / (columns - 1), 1.0 / (columns - 1)};
  const long nodes = grid.node_count();
  PlateProblem problem{grid, {1, 2, 1}, dynamics, {}, Field::Random(nodes, 3)};
  problem.tangents.su0.setConstant(0.1);
  const PlateState state{Field::Random(nodes, 3), Field::Random(nodes, 3)};
  Row row{.columns = columns, .rows = rows};

  // About half a second per size, but at least three rounds.
  const int rounds = static_cast<int>(std::clamp(3e6 / static_cast<double>(nodes), 3.0, 101.0));
  {
    const auto solver = make_plate_solver(SolverChoice::Spectral, {.threads = &threads});
    PlateState now = state;
    const auto advance = [&](int count) {
      now = solver->advance(problem, {count, dt}, std::move(now)).value();
    };
    SpectralPlate set_up({.threads = &threads});
    PlateSystem system{grid, problem.stiffness, dynamics.shift(dt)};
    (void)set_up.prepare(system);
    std::vector<double> a(static_cast<std::size_t>(5 * nodes), 0.0), b(a.size(), 1.0),
        c(a.size(), 2.0);
    PlateProblem pulled = problem;
    pulled.goal = 500;
    const auto other = make_plate_solver(SolverChoice::Spectral, {.threads = &threads});
    PlateState pulled_now = state;
    const auto advance_pulled = [&](int count) {
      pulled_now = other->advance(pulled, {count, dt}, std::move(pulled_now)).value();
    };
    advance(2);
    advance_pulled(2);
    std::vector<double> triads, steps, ratios, set_ups, frames, with_goals;
    for (int round = 0; round < rounds; ++round) {
      const auto triad = [&] {
        return seconds([&] {
          for (std::size_t k = 0; k < a.size(); ++k) a[k] = b[k] + 3 * c[k];
          asm volatile("" : : "r"(a.data()) : "memory");
        });
      };
      const double once = std::min(triad(), triad());
      const double one = seconds([&] { advance(1); });
      const double many = seconds([&] { advance(steps_per_frame + 1); });
      triads.push_back(once);
      steps.push_back((many - one) / steps_per_frame);
      ratios.push_back(steps.back() / once);
      frames.push_back(seconds([&] { advance(steps_per_frame); }));
      advance_pulled(1);  // into the cache
      with_goals.push_back(seconds([&] { advance_pulled(steps_per_frame); }) / frames.back());
      system.stiffness.c += 1e-6;
      set_ups.push_back(seconds([&] { (void)set_up.prepare(system); }));
    }
    row.triad = median(triads);
    row.step = median(steps);
    row.step_per_triad = median(ratios);
    row.set_up = median(set_ups);
    row.frame = median(frames);
    row.with_goal = median(with_goals);
    row.doubles =
        static_cast<double>(solver->memory()) / sizeof(double) / static_cast<double>(nodes);
  }
  const long direct = long{options.direct_side} * options.direct_side;
#ifdef PLIANT_BENCH_SUPERNODAL
  if (nodes <= direct) {
    bench::SupernodalSolver solver;
    row.supernodal = cost_of(solver, problem, state);
  }
#endif
  if (4 * nodes <= direct + 4L * options.direct_side && is_available(SolverChoice::Cholmod)) {
    row.simplicial = cost_of(*make_plate_solver(SolverChoice::Cholmod), problem, state);
  }
  if (4 * nodes <= direct + 4L * options.direct_side) {
    row.eigen = cost_of(*make_plate_solver(SolverChoice::Eigen), problem, state);
  }
  return row;
}

std::string times_of(const Row& row, const std::optional<DirectCost>& cost) {
  if (!cost) return "-";
  const double kept = steps_per_frame * cost->step;
  return fmt::format("{:.0f} / {:.0f}", (cost->factor + kept) / row.with_set_up(),
                     kept / row.frame);
}

void print_row(const Row& row) {
  fmt::print(
      "| {} x {} | {:.4f} | {:.4f} ({:.2f}) | {:.3f} | {:.2f} | {:.0f} | {:.3f} | {} | {} | {} | "
      "{:.1f} |\n",
      row.columns, row.rows, row.triad * 1e3, row.step * 1e3, row.step_per_triad, row.set_up * 1e3,
      row.with_set_up() * 1e3, 1 / row.with_set_up(), row.with_goal, times_of(row, row.supernodal),
      times_of(row, row.simplicial), times_of(row, row.eigen), row.doubles);
  std::fflush(stdout);
}

void print_csv(const Row& row, std::FILE* file) {
  const auto frame_of = [](const std::optional<DirectCost>& cost) {
    return cost ? fmt::format("{:.6g},{:.6g}", cost->factor + steps_per_frame * cost->step,
                              steps_per_frame * cost->step)
                : std::string(",");
  };
  fmt::print(file, "{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{}\n", row.columns, row.rows, row.triad,
             row.step, row.set_up, row.frame, frame_of(row.supernodal), frame_of(row.simplicial),
             frame_of(row.eigen));
}

// "51,101x801": boxes by columns and rows, 3 or more; one number: a square.
std::vector<std::pair<int, int>> parse_boxes(std::string_view text) {
  std::vector<std::pair<int, int>> boxes;
  while (!text.empty()) {
    const std::string_view box = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), box.size() + 1));
    auto& [columns, rows] = boxes.emplace_back();
    const auto cross = box.find('x');
    const std::string_view after = cross == std::string_view::npos ? box : box.substr(cross + 1);
    if (!read_value(box.substr(0, cross), columns) || !read_value(after, rows) ||
        std::min(columns, rows) < 3)
      return {};
  }
  return boxes;
}

}  // namespace

int main(int count, char* arguments[]) {
  Options options;
  const bool are_right =
      read_options(count, arguments,
                   {{"--boxes", &options.boxes},
                    {"--direct", &options.direct_side},
                    {"--threads", &options.threads},
                    {"--csv", &options.csv}},
                   "plate [--boxes 51,101x801,...] [--direct SIDE] [--threads N] [--csv FILE]");
  const auto boxes = parse_boxes(options.boxes);
  if (!are_right || boxes.empty()) return 2;
  ThreadPool threads(options.threads);
  fmt::print("kernels {}, {} thread(s); times in ms; times as long: new / kept\n\n",
             runnable_kernels(0)->name, threads.thread_count());
  fmt::print(
      "| nodes | triad | step (triads) | set-up | frame, new | frames/s | goal | supernodal | "
      "simplicial | eigen | doubles a node |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<Row> rows_done;
  for (const auto& [columns, rows] : boxes) {
    rows_done.push_back(measure(columns, rows, options, threads));
    print_row(rows_done.back());
  }
  if (options.csv.empty()) return 0;
  std::FILE* const file = std::fopen(options.csv.c_str(), "w");
  if (!file) {
    fmt::print(stderr, "plate: cannot write {}\n", options.csv);
    return 1;
  }
  fmt::print(file,
             "columns,rows,triad,step,set_up,frame,supernodal_new,supernodal_kept,simplicial_new,"
             "simplicial_kept,eigen_new,eigen_kept\n");
  for (const Row& row : rows_done) print_csv(row, file);
  return std::fclose(file) == 0 ? 0 : 1;
}
