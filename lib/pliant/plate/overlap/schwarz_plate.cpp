#include "pliant/plate/overlap/schwarz_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/overlap/rectangle_cover.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/operator.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

// Size of the last round's change, relative to the solution. A round leaves a tenth of an error or
// less, so the solution is then accurate to some 1e-15.
constexpr double least_change = 1e-14;

// Views of fields on all nodes without gaps: pointer to the number of a node.
const double* at(const ConstNodesView& view, int component, long node) {
  return view.first + component * view.component_stride + node;
}
double* at(const NodesView& view, int component, long node) {
  return view.first + component * view.component_stride + node;
}

StencilWeights weights_of(const PlateSystem& system) {
  return {system.outline.grid(), system.stiffness, system.shift};
}

// (shift + L) p without what ghosts add.
void apply_to_run(const StencilWeights& weights, const double* p, long M, long count,
                  double* product) {
  for (long k = 0; k < count; ++k) {
    product[k] = weights.apply([&](long di, long dj) { return p[k + di + dj * M]; });
  }
}

}  // namespace

// Runs tasks that write different numbers. On a small plate they are not worth a thread.
template <class Work>
void SchwarzPlate::for_each(std::size_t count, const Work& work) {
  constexpr long worth_a_thread = 10'000;  // nodes
  const bool is_worth = system_.outline.grid().node_count() > worth_a_thread;
  pliant::for_each(is_worth ? context_.threads : nullptr, count, work);
}

// Calls work(component, block) for all blocks of rows and all components that are not solved yet.
template <class Work>
void SchwarzPlate::for_each_block(const Work& work) {
  int active[3];
  std::size_t count = 0;
  for (int component = 0; component < 3; ++component) {
    if (is_active_[component]) active[count++] = component;
  }
  const std::size_t blocks = rows_.block_count();
  for_each(count * blocks, [&](std::size_t k) { work(active[k / blocks], k % blocks); });
}

void SchwarzPlate::let_go() {
  problems_.clear();
  plates_.clear();
  numbers_ = NumberBlock();
  (void)memory_.try_resize(0);  // less memory is always available
}

Result<void> SchwarzPlate::prepare(const Outline& outline, const Stiffness& stiffness,
                                   double shift) try {
  const bool are_same_nodes = !problems_.empty() && have_same_nodes(outline, system_.outline);
  const Grid& grid = outline.grid();
  if (is_prepared_ && are_same_nodes && grid == system_.outline.grid() &&
      stiffness == system_.stiffness && shift == system_.shift) {
    return {};
  }
  is_prepared_ = false;
  system_.outline = outline;
  system_.stiffness = stiffness;
  system_.shift = shift;
  if (!are_same_nodes) {
    if (auto laid_out = lay_out(); !laid_out) return laid_out;
  }
  ++counts_.factorizations;
  for (const LocalProblem& problem : problems_) {
    const Grid with_rim{problem.subdomain.box.columns() + 2, problem.subdomain.box.rows() + 2,
                        grid.hu, grid.hv};
    if (auto ready = problem.plate->prepare({with_rim, stiffness, shift}); !ready) {
      let_go();
      return ready;
    }
  }
  // Rounding makes the updated residual differ from the true one by some eps |A| |e|, where e is
  // the error at the start of the updates; that is an error of up to condition x eps |e|.
  trusted_gain_ =
      std::clamp(std::numeric_limits<double>::epsilon() * estimate_condition(system_), 1e-10, 1e-5);
  is_prepared_ = true;
  return {};
} catch (const std::bad_alloc&) {
  let_go();
  return fail(no_memory_to_solve(outline.unknown_count(), "does not fit in memory"));
}

Result<void> SchwarzPlate::lay_out() {
  const Grid& grid = system_.outline.grid();
  std::vector<Box> cover = cover_by_rectangles(system_.outline);
  PLIANT_EXPECTS(!cover.empty());
  once_ = move_independent_back(cover);
  let_go();
  rows_ = RowBlocks(system_.outline);

  std::size_t largest = 0;
  std::size_t sides = 0;
  for (const Box& box : cover) {
    largest = std::max(largest, std::size_t(box.columns()) * std::size_t(box.rows()));
    sides += std::size_t(box.columns()) + std::size_t(box.rows());
  }
  // Fields are separated by a row of zeros, and their distance is never a multiple of a page.
  constexpr std::size_t unit = NumberBlock::line / sizeof(double);
  const std::size_t above = (std::size_t(grid.columns) + 2 + unit - 1) / unit * unit;
  const std::size_t field =
      (std::size_t(grid.node_count()) + 2 * above + 511) / 512 * 512 + 3 * unit;
  const std::size_t local_field = (largest + 511) / 512 * 512 + 3 * unit;
  const std::size_t count = 18 * field + 3 * local_field + 3 * rows_.block_count();
  constexpr std::size_t bytes_along_side = 2 * sizeof(RowBlocks::Edge) + 10 * sizeof(long);
  const std::size_t bytes = count * sizeof(double) + rows_.memory() + sides * bytes_along_side +
                            system_.outline.mask().size();
  if (!memory_.try_resize(bytes)) {
    return fail(no_memory_to_solve(system_.outline.unknown_count(), memory_.complaint(bytes)));
  }
  numbers_ = NumberBlock(count);
  std::fill_n(numbers_.begin(), count, 0.0);
  double* next = numbers_.begin();
  for (NodeField* fields : {&load_, &solution_, &residual_, &correction_, &direction_, &product_}) {
    for (double*& component : fields->of) {
      component = next + above;
      next += field;
    }
  }
  for (double*& component : local_correction_.of) {
    component = next;
    next += local_field;
  }
  block_sums_ = next;
  make_problems(cover);
  ++counts_.analyses;
  return {};
}

void SchwarzPlate::make_problems(const std::vector<Box>& cover) {
  for (const Box& box : cover) {
    LocalProblem problem{subdomain_of(system_.outline, box), nullptr};
    // Rectangles of one size share a plate.
    for (const LocalProblem& other : problems_) {
      const Box& earlier = other.subdomain.box;
      if (earlier.columns() == box.columns() && earlier.rows() == box.rows()) {
        problem.plate = other.plate;
      }
    }
    if (!problem.plate) {
      plates_.push_back(std::make_unique<SpectralPlate>(context_));
      problem.plate = plates_.back().get();
    }
    problems_.push_back(std::move(problem));
  }
}

std::size_t SchwarzPlate::memory() const {
  std::size_t bytes = memory_.bytes();
  for (const auto& plate : plates_) bytes += plate->memory();
  return bytes;
}

// r = f - (shift + L) x in extended precision: eq. (4), (5) and (13).
void SchwarzPlate::find_residual() {
  using Real = long double;
  const Stencil<Real> stencil(system_.outline.grid(), system_.stiffness);
  const long M = system_.outline.grid().columns;
  for_each_block([&](int component, std::size_t block) {
    const double* const x = solution_.of[component];
    const double* const f = load_.of[component];
    double* const r = residual_.of[component];
    auto edge = rows_.edges(block).begin();
    const auto last_edge = rows_.edges(block).end();
    for (const auto& [first, count] : rows_.runs(block)) {
      for (long node = first; node < first + count; ++node) {
        const double* const p = x + node;
        const auto at = [&](long di, long dj) { return Real{p[di + dj * M]}; };
        Real product = stencil.apply(system_.shift, at, at);
        if (edge != last_edge && edge->node == node) {
          product += (stencil.b * edge->along_u + stencil.d * edge->along_v) * p[0];
          ++edge;
        }
        r[node] = static_cast<double>(f[node] - product);
      }
    }
  });
}

// q = (shift + L) p.
void SchwarzPlate::apply_operator() {
  const StencilWeights weights = weights_of(system_);
  const long M = system_.outline.grid().columns;
  for_each_block([&](int component, std::size_t block) {
    const double* const p = direction_.of[component];
    double* const q = product_.of[component];
    for (const auto& [first, count] : rows_.runs(block)) {
      apply_to_run(weights, p + first, M, count, q + first);
    }
    for (const auto& [node, along_u, along_v] : rows_.edges(block)) {
      q[node] += weights.ghosts(along_u, along_v) * p[node];
    }
  });
}

// z = B r, eq. (36): the rest of r is stored in `product_`.
void SchwarzPlate::apply_rounds() {
  for_each_block([&](int component, std::size_t block) {
    for (const auto& [first, count] : rows_.runs(block)) {
      std::copy_n(residual_.of[component] + first, count, product_.of[component] + first);
      std::fill_n(correction_.of[component] + first, count, 0.0);
    }
  });
  for (int component = 0; component < 3; ++component) {
    if (is_active_[component]) continue;
    std::fill_n(product_.of[component], system_.outline.grid().node_count(), 0.0);
  }
  const std::size_t count = problems_.size();
  for (std::size_t k = 0; k < count; ++k) visit(problems_[k], k + 1 == count && once_ == count);
  for (std::size_t k = count - once_; k-- > 0;) visit(problems_[k], k == 0);
}

void SchwarzPlate::visit(const LocalProblem& problem, bool is_last) {
  const long M = system_.outline.grid().columns;
  const long first = problem.subdomain.box.j0 * M + problem.subdomain.box.i0;
  const long width = problem.subdomain.box.columns();
  const ConstNodesView left{product_.of[0] + first, M, product_.of[1] - product_.of[0]};
  const NodesView corrected{local_correction_.of[0], width,
                            local_correction_.of[1] - local_correction_.of[0]};
  problem.plate->solve(left, corrected);
  for_each(3, [&](std::size_t component) {
    if (is_active_[component]) take_correction(problem, static_cast<int>(component), is_last);
  });
}

// Adds a rectangle's part y to z and subtracts A y from the rest. On the rectangle, the rest is
// then only the excess of the clamped sides over A, eq. (35); around it, the stencil's values.
void SchwarzPlate::take_correction(const LocalProblem& problem, int component, bool is_last) {
  const long M = system_.outline.grid().columns;
  const Box& box = problem.subdomain.box;
  const long width = box.columns();
  const double* const y = local_correction_.of[component];
  double* const z = correction_.of[component];
  double* const left = product_.of[component];
  for (int j = box.j0; j <= box.j1; ++j) {
    const long first = j * M + box.i0;
    const double* const row = y + (j - box.j0) * width;
    for (long i = 0; i < width; ++i) z[first + i] += row[i];
    if (!is_last) std::fill_n(left + first, width, 0.0);
  }
  if (is_last) return;
  const StencilWeights weights = weights_of(system_);
  const auto at = [&](long i, long j) {
    const bool is_here = box.i0 <= i && i <= box.i1 && box.j0 <= j && j <= box.j1;
    return is_here ? y[(j - box.j0) * width + (i - box.i0)] : 0;
  };
  for (const auto& [node, along_u, along_v] : problem.subdomain.facing) {
    left[node] += weights.ghosts(along_u, along_v) * at(node % M, node / M);
  }
  for (const long node : problem.subdomain.around) {
    const long i = node % M;
    const long j = node / M;
    left[node] -= weights.apply([&](int di, int dj) { return at(i + di, j + dj); });
  }
}

// <a,b> of the components that are not solved yet.
void SchwarzPlate::dot(const NodeField& a, const NodeField& b, Sums& total) {
  const std::size_t blocks = rows_.block_count();
  for_each_block([&](int component, std::size_t block) {
    LaneSum sum;
    for (const auto& [first, count] : rows_.runs(block)) {
      sum.add(a.of[component] + first, b.of[component] + first, count);
    }
    block_sums_[component * blocks + block] = sum.total();
  });
  for (int component = 0; component < 3; ++component) {
    total[component] = 0;
    if (!is_active_[component]) continue;
    for (std::size_t block = 0; block < blocks; ++block) {
      total[component] += block_sums_[component * blocks + block];
    }
  }
}

// to += factor * from.
void SchwarzPlate::add(const NodeField& from, const Sums& factor, const NodeField& to) {
  for_each_block([&](int component, std::size_t block) {
    if (factor[component] == 0) return;
    for (const auto& [first, count] : rows_.runs(block)) {
      const double* const a = from.of[component] + first;
      double* const b = to.of[component] + first;
      for (long k = 0; k < count; ++k) b[k] += factor[component] * a[k];
    }
  });
}

// p = z + factor p; for factor 0, p may contain anything before.
void SchwarzPlate::turn_direction(const Sums& factor) {
  for_each_block([&](int component, std::size_t block) {
    for (const auto& [first, count] : rows_.runs(block)) {
      const double* const z = correction_.of[component] + first;
      double* const p = direction_.of[component] + first;
      if (factor[component] == 0) {
        std::copy_n(z, count, p);
      } else {
        for (long k = 0; k < count; ++k) p[k] = z[k] + factor[component] * p[k];
      }
    }
  });
}

Result<void> SchwarzPlate::correct() {
  if (context_.is_stopped()) return interrupted();
  if (rounds_left_-- == 0) {
    return fail(ErrorCode::SolverFailed,
                fmt::format("the plate of {} unknowns is not solved after {} rounds over its {} "
                            "rectangles",
                            system_.outline.unknown_count(), max_rounds_, problems_.size()));
  }
  ++rounds_;
  apply_rounds();
  return {};
}

// Conjugate gradients from a recomputed residual, as long as its updates can be trusted. Eq. (37).
// Components that are not solved afterwards remain set in `is_unsolved`.
Result<void> SchwarzPlate::run(bool (&is_unsolved)[3]) {
  find_residual();
  if (auto corrected = correct(); !corrected) return corrected;
  Sums energy, change, size, target = {}, turn = {};
  dot(residual_, correction_, energy);
  dot(correction_, correction_, change);
  dot(solution_, solution_, size);
  for (int k = 0; k < 3; ++k) {
    const double enough = least_change * std::sqrt(size[k]);
    target[k] = std::max(enough, trusted_gain_ * std::sqrt(change[k]));
    is_unsolved[k] = is_active_[k] && target[k] > enough;
  }
  while (true) {
    if (!retire(energy, change, target))
      return fail(not_positive_definite(system_.outline.unknown_count(), 0));
    if (!is_any_active()) return {};
    turn_direction(turn);
    apply_operator();
    Sums curvature, step = {}, back = {};
    dot(direction_, product_, curvature);
    for (int k = 0; k < 3; ++k) {
      if (!is_active_[k]) continue;
      if (!(curvature[k] > 0))
        return fail(not_positive_definite(system_.outline.unknown_count(), 0));
      step[k] = energy[k] / curvature[k];
      back[k] = -step[k];
    }
    add(direction_, step, solution_);
    add(product_, back, residual_);
    if (auto corrected = correct(); !corrected) return corrected;
    Sums before;
    std::copy_n(energy, 3, before);
    dot(residual_, correction_, energy);
    dot(correction_, correction_, change);
    for (int k = 0; k < 3; ++k) turn[k] = is_active_[k] ? energy[k] / before[k] : 0;
  }
}

// Adds the last change to components that it changed by no more than their target; they are done.
// False if an energy is not finite, or negative, as is possible only for an indefinite matrix.
bool SchwarzPlate::retire(const Sums& energy, const Sums& change, const Sums& target) {
  Sums take = {};
  bool is_done[3] = {};
  for (int k = 0; k < 3; ++k) {
    if (!is_active_[k]) continue;
    if (!(energy[k] >= 0 && energy[k] < std::numeric_limits<double>::infinity())) return false;
    is_done[k] = std::sqrt(change[k]) <= target[k];
    take[k] = is_done[k] ? 1 : 0;
  }
  add(correction_, take, solution_);
  for (int k = 0; k < 3; ++k) is_active_[k] = is_active_[k] && !is_done[k];
  return true;
}

// Solves for `load_` from the guess in `solution_`.
Result<void> SchwarzPlate::iterate() {
  ++counts_.solves;
  rounds_left_ = max_rounds_;
  bool is_unsolved[3];
  for (int k = 0; k < 3; ++k) is_unsolved[k] = !settle_if_free(k);
  while (is_unsolved[0] || is_unsolved[1] || is_unsolved[2]) {
    std::copy_n(is_unsolved, 3, is_active_);
    if (auto done = run(is_unsolved); !done) return done;
  }
  return {};
}

// Without a load the solution is 0 for any guess. Returns whether there is no load.
bool SchwarzPlate::settle_if_free(int component) {
  for (std::size_t block = 0; block < rows_.block_count(); ++block) {
    for (const auto& [first, count] : rows_.runs(block)) {
      const double* const f = load_.of[component] + first;
      if (!std::all_of(f, f + count, [](double number) { return number == 0; })) return false;
    }
  }
  std::fill_n(solution_.of[component], system_.outline.grid().node_count(), 0.0);
  return true;
}

// Calls work(component, first node, count) for all runs of interior nodes.
template <class Work>
void SchwarzPlate::for_each_run(const Work& work) {
  std::fill_n(is_active_, 3, true);
  for_each_block([&](int component, std::size_t block) {
    for (const auto& [first, count] : rows_.runs(block)) work(component, first, count);
  });
}

Result<void> SchwarzPlate::solve(const ConstNodesView& load, const NodesView& solution) {
  PLIANT_EXPECTS(is_prepared_);
  for_each_run([&](int k, long first, long count) {
    std::copy_n(at(load, k, first), count, load_.of[k] + first);
    std::copy_n(at(solution, k, first), count, solution_.of[k] + first);
  });
  if (auto done = iterate(); !done) return done;
  for_each_run([&](int k, long first, long count) {
    std::copy_n(solution_.of[k] + first, count, at(solution, k, first));
  });
  return {};
}

void SchwarzPlate::precondition(const ConstNodesView& load, const NodesView& solution) {
  PLIANT_EXPECTS(is_prepared_);
  for_each_run([&](int k, long first, long count) {
    std::copy_n(at(load, k, first), count, residual_.of[k] + first);
  });
  apply_rounds();
  for_each_run([&](int k, long first, long count) {
    std::copy_n(correction_.of[k] + first, count, at(solution, k, first));
  });
}

Result<void> SchwarzPlate::advance(const ConstNodesView& load, double inertia, double dt,
                                   const NodesView& displacement, const NodesView& velocity) {
  PLIANT_EXPECTS(is_prepared_);
  const double shift = system_.shift;
  // With inertia the first guess continues the motion.
  const bool goes_on = inertia > 0;
  for_each_run([&](int component, long first, long count) {
    const double* const known = at(load, component, first);
    const double* const w = at(displacement, component, first);
    const double* const v = at(velocity, component, first);
    double* const f = load_.of[component] + first;
    double* const x = solution_.of[component] + first;
    for (long k = 0; k < count; ++k) {
      f[k] = known[k] + shift * w[k] + inertia * v[k];
      x[k] = goes_on ? w[k] + dt * v[k] : w[k];
    }
  });
  if (auto done = iterate(); !done) return done;
  for_each_run([&](int component, long first, long count) {
    const double* const x = solution_.of[component] + first;
    double* const w = at(displacement, component, first);
    double* const v = at(velocity, component, first);
    for (long k = 0; k < count; ++k) {
      v[k] = (x[k] - w[k]) / dt;
      w[k] = x[k];
    }
  });
  return {};
}

}  // namespace pliant
