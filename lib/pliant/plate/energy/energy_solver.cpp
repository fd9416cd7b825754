#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/exact/sparse_motion.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/sparse/refined_factor.hpp"
#include "pliant/plate/sparse/upper_column.hpp"
#include "pliant/plate/stencil.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {
namespace {

// The stencil of an outline that follows cells, between interior nodes; its material is even but
// for density and damping. Eq. (4), (5), (7).
template <class Real>
StencilTable<Real> even_hessian(const PlateSystem& system) {
  const Outline& outline = system.outline;
  const Grid& grid = outline.grid();
  StencilTable<Real> table(grid);
  const Stencil<Real> stencil(grid, system.stiffness);
  outline.for_each_run([&](const Outline::Run& run) {
    const int j = run.j;
    for (int i = run.i0; i <= run.i1; ++i) {
      const auto holds = [&](int di, int dj) { return outline.holds(i + di, j + dj); };
      const int ghosts_u = !holds(-1, 0) + !holds(1, 0), ghosts_v = !holds(0, -1) + !holds(0, 1);
      table.add(i, j, {0, 0}, {0, 0},
                6 * stencil.b + 4 * stencil.c + 6 * stencil.d + ghosts_u * stencil.b +
                    ghosts_v * stencil.d);
      const auto add = [&](int di, int dj, Real weight) {
        if (holds(di, dj)) table.add(i, j, {0, 0}, {di, dj}, weight);
      };
      add(1, 0, -4 * stencil.b - 2 * stencil.c);
      add(0, 1, -2 * stencil.c - 4 * stencil.d);
      add(-1, 1, stencil.c);
      add(1, 1, stencil.c);
      if (holds(1, 0)) add(2, 0, stencil.b);
      if (holds(0, 1)) add(0, 2, stencil.d);
    }
  });
  return table;
}

// Plates whose matrix comes from the bending energy, and plates with a map of density or damping:
// factored by supernodes. Sources: as `RefinedFactor`.
class EnergySolver final : public PlateSolver, private PreciseMatrix {
 public:
  EnergySolver(SolverChoice choice, const RunContext& context)
      : PlateSolver(context),
        factor_(*this, choice, context),
        precise_share_(context.memory),
        motion_(context) {}

  Result<void> prepare(const PlateSystem& system) override {
    if (is_factored_ && *system_ == system) return {};
    const bool has_same_pattern = is_factored_ && have_same_nodes(system_->outline, system.outline);
    is_factored_ = false;
    system_ = system;
    numbers_ = numbers_of_unknowns(system.outline);
    shifts_.resize(unknown_count(system.outline));
    masses_ = node_masses(*system_);
    const PlateEnergy energy(*system_);
    for_each_unknown([&](int unknown, int i, int j) {
      const int node = system.outline.grid().node(i, j);
      const double share = energy.share(i, j);
      const double drag = share * (system.factors ? factor_at(system.factors->damping, node) : 1);
      shifts_[unknown] = (system.shift - system.drag) * masses_[unknown] + system.drag * drag;
    });
    if (auto factored =
            factor_.factor(shifts_.size(), has_same_pattern, Eigen::VectorXd::Ones(shifts_.size()));
        !factored) {
      return factored;
    }
    is_factored_ = true;
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(is_factored_ && right_hand_sides.rows() == shifts_.size());
    return factor_.solve(right_hand_sides);
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    if (steps.are_exact()) return advance_exactly(problem, steps, std::move(state));
    const double dt = steps.solved_length();
    StageTimer set_up(context().profile, Stage::SetUp);
    if (auto ready = prepare(problem.system(dt)); !ready) return fail(ready.error());
    set_up.stop();
    const StageTimer solving(context().profile, Stage::Solve);
    const StepTerms terms = this->terms(problem, dt, state.displacement);
    Field right_hand_sides(terms.known.rows(), 3);
    const auto solve = [&](const Field& w, const Field& v) {
      for (int k = 0; k < 3; ++k) {
        right_hand_sides.col(k) = terms.known.col(k) + terms.shift.cwiseProduct(w.col(k)) +
                                  terms.inertia.cwiseProduct(v.col(k));
      }
      return factor_.solve_next(right_hand_sides);
    };
    factor_.begin_steps();
    return run_steps(context(), steps, problem, std::move(state), solve);
  }

  StepTerms terms(const PlateProblem& problem, double dt, const Field& displacement) override {
    return {known_forces(problem, displacement), shifts_, problem.dynamics.inertia(dt) * masses_};
  }

  SolverCounts counts() const override { return factor_.counts() + motion_.counts(); }
  std::size_t memory() const override {
    return factor_.memory() + precise_share_.bytes() + motion_.memory();
  }

 private:
  using Extended = long double;

  // The factor of the steps is given up: the system is another one.
  Result<PlateState> advance_exactly(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state) {
    const Outline& outline = problem.outline;
    StageTimer set_up(context().profile, Stage::SetUp);
    is_factored_ = false;
    system_ = problem.system(steps.length);
    system_->shift = system_->drag = 0;
    numbers_ = numbers_of_unknowns(outline);
    masses_ = node_masses(*system_);
    shifts_ = Eigen::VectorXd::Zero(unknown_count(outline));
    const auto unknowns = static_cast<std::size_t>(shifts_.size());
    std::vector<double> inertia(unknowns), drag(unknowns);
    const PlateEnergy energy(*system_);
    for_each_unknown([&](int unknown, int i, int j) {
      const int node = outline.grid().node(i, j);
      const double factor = problem.factors ? factor_at(problem.factors->damping, node) : 1;
      inertia[unknown] = problem.dynamics.density * masses_[unknown];
      drag[unknown] = problem.dynamics.damping * energy.share(i, j) * factor;
    });
    auto stiffness = upper();
    if (!stiffness) return fail(stiffness.error());
    auto ready = motion_.prepare({*std::move(stiffness), std::move(inertia), std::move(drag)});
    if (!ready) return fail(ready.error());
    set_up.stop();
    const StageTimer solving(context().profile, Stage::Solve);
    PlateProblem first = problem;
    first.load = problem.first_load;
    first.tangents = problem.first_tangents;
    Field w = interior_of(outline, state.displacement), v = interior_of(outline, state.velocity);
    auto moved = motion_.advance(
        steps, {known_forces(first, state.displacement), known_forces(problem, state.displacement)},
        w, v);
    if (!moved) return fail(moved.error());
    return with_interior(problem, std::move(state), w, v);
  }

  // Calls f(unknown, i, j) for the unknowns, in their order.
  template <class F>
  void for_each_unknown(const F& f) const {
    int unknown = 0;
    system_->outline.for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i) f(unknown++, i, run.j);
    });
  }

  bool has_energy() const { return system_->outline.mask().empty(); }

  template <class Real>
  StencilTable<Real> hessian() const {
    return has_energy() ? PlateEnergy(*system_).hessian<Real>() : even_hessian<Real>(*system_);
  }

  // The forces on the unknowns by the load, the rim and the tangents.
  Field known_forces(const PlateProblem& problem, const Field& displacement) const {
    const Outline& outline = problem.outline;
    Field forces = problem.load;
    if (!has_energy()) {
      subtract_rim(outline, problem.stiffness, problem.tangents, displacement, forces);
      return weighted(interior_of(outline, forces));
    }
    const PlateEnergy energy(*system_);
    forces.setZero();
    Field rim = displacement;
    set_interior_to_zero(rim);
    if (!rim.isZero(0)) {
      energy.hessian<double>().for_each([&](int node, int other, double entry) {
        forces.row(node) -= entry * rim.row(other);
        if (other != node) forces.row(other) -= entry * rim.row(node);
      });
    }
    energy.add_tangents(problem.tangents, forces);
    return weighted(interior_of(outline, problem.load)) + interior_of(outline, forces);
  }

  void set_interior_to_zero(Field& nodes) const {
    for_each_unknown(
        [&](int, int i, int j) { nodes.row(system_->outline.grid().node(i, j)).setZero(); });
  }

  // A load times each node's share of area.
  Field weighted(Field loads) const {
    if (!system_->outline.edges().have_free()) return loads;
    const PlateEnergy energy(*system_);
    for_each_unknown([&](int unknown, int i, int j) { loads.row(unknown) *= energy.share(i, j); });
    return loads;
  }

  Result<SparseMatrix> upper() const override {
    const StencilTable<double> table = hessian<double>();
    const int size = static_cast<int>(shifts_.size());
    std::vector<UpperColumn> columns(static_cast<std::size_t>(size));
    table.for_each([&](int node, int other, double entry) {
      const int one = numbers_[node], two = numbers_[other];
      if (one < 0 || two < 0) return;
      columns[std::max(one, two)].add(std::min(one, two), entry);
    });
    SparseMatrix matrix(size, size);
    matrix.reserve(Eigen::Index{7} * size);
    for (int k = 0; k < size; ++k) {
      columns[k].add(k, shifts_[k]);
      columns[k].insert_into(matrix, k);
    }
    matrix.finalize();
    return matrix;
  }

  Result<void> open(std::size_t) override {
    const auto nodes = static_cast<std::size_t>(system_->outline.grid().node_count());
    const std::size_t bytes = nodes * (7 + 2) * sizeof(Extended);
    if (!precise_share_.try_resize(bytes)) {
      return fail(factor_too_large(shifts_.size(), precise_share_.complaint(bytes)));
    }
    precise_ = hessian<Extended>();
    return {};
  }

  Field residual(const Field& x, const Field& f) const override {
    Field result(f.rows(), 3);
    std::vector<Extended> left(static_cast<std::size_t>(f.rows()));
    for (int component = 0; component < 3; ++component) {
      for (Eigen::Index k = 0; k < f.rows(); ++k) {
        left[k] = f(k, component) - Extended{shifts_[k]} * x(k, component);
      }
      precise_->for_each([&](int node, int other, Extended entry) {
        const int one = numbers_[node], two = numbers_[other];
        if (one < 0 || two < 0) return;
        left[one] -= entry * x(two, component);
        if (one != two) left[two] -= entry * x(one, component);
      });
      for (Eigen::Index k = 0; k < f.rows(); ++k) {
        result(k, component) = static_cast<double>(left[k]);
      }
    }
    return result;
  }

  void close() override {
    precise_.reset();
    static_cast<void>(precise_share_.try_resize(0));  // to give back never fails
  }

  std::optional<PlateSystem> system_;  // of the factor
  bool is_factored_ = false;
  std::vector<int> numbers_;  // of the unknowns, by node
  Eigen::VectorXd masses_;    // of the unknowns, for a density of 1
  Eigen::VectorXd shifts_;
  RefinedFactor factor_;
  std::optional<StencilTable<Extended>> precise_;  // if solutions are corrected
  MemoryShare precise_share_;
  SparseMotion motion_;
};

}  // namespace

std::unique_ptr<PlateSolver> make_energy_solver(SolverChoice choice, const RunContext& context) {
  return std::make_unique<EnergySolver>(choice, context);
}

}  // namespace pliant
