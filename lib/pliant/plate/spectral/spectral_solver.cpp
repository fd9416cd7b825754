#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/load_copy.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/spectral/spectral_motion.hpp"
#include "pliant/plate/spectral/spectral_plate.hpp"

namespace pliant {
namespace {

// A rectangle with a clamped edge opposite a pinned one is half of one with two clamped edges, of
// which the other half is its image at the pinned edge, negated. docs/model.md, "In sine space".
class Mirror {
 public:
  explicit Mirror(const Outline& outline) : grid_(outline.grid()), edges_(outline.edges()) {
    doubles_u_ = edges_.u0 != edges_.u1;
    doubles_v_ = edges_.v0 != edges_.v1;
  }

  bool doubles() const { return doubles_u_ || doubles_v_; }

  Outline outline() const {
    Grid grid = grid_;
    Edges edges = edges_;
    if (doubles_u_) {
      grid.columns = 2 * grid.columns - 1;
      edges.u0 = edges.u1 = Edge::Clamped;
    }
    if (doubles_v_) {
      grid.rows = 2 * grid.rows - 1;
      edges.v0 = edges.v1 = Edge::Clamped;
    }
    return {grid, edges};
  }

  // A field on the nodes, together with its images. Pinned edges are at 0.
  Field doubled(const Field& nodes) const {
    const Grid grid = outline().grid();
    Field all = Field::Zero(grid.node_count(), 3);
    for (int j = 1; j < grid.rows - 1; ++j) {
      const Place v = place(j, grid_.rows, doubles_v_, edges_.v0);
      for (int i = 1; i < grid.columns - 1; ++i) {
        const Place u = place(i, grid_.columns, doubles_u_, edges_.u0);
        all.row(grid.node(i, j)) = u.sign * v.sign * nodes.row(grid_.node(u.line, v.line));
      }
    }
    return all;
  }

  // The interior nodes of the half itself, written into a field on its nodes.
  void put_half(const Field& all, Field& nodes) const {
    const Grid grid = outline().grid();
    for (int j = 1; j < grid.rows - 1; ++j) {
      const Place v = place(j, grid_.rows, doubles_v_, edges_.v0);
      for (int i = 1; i < grid.columns - 1; ++i) {
        const Place u = place(i, grid_.columns, doubles_u_, edges_.u0);
        if (u.sign * v.sign > 0) nodes.row(grid_.node(u.line, v.line)) = all.row(grid.node(i, j));
      }
    }
  }

 private:
  struct Place {
    int line;     // of the half
    double sign;  // -1: an image; 0: at the pinned edge
  };

  static Place place(int line, int count, bool is_doubled, Edge first) {
    if (!is_doubled) return {line, 1};
    // The half comes first if the pinned edge is its last one.
    const int from_pinned = line - (count - 1);
    const bool is_first_pinned = first == Edge::Pinned;
    const int distance = from_pinned < 0 ? -from_pinned : from_pinned;
    const double sign = from_pinned == 0 ? 0 : (from_pinned > 0) == is_first_pinned ? 1 : -1;
    return {is_first_pinned ? distance : count - 1 - distance, sign};
  }

  Grid grid_;
  Edges edges_;
  bool doubles_u_, doubles_v_;
};

class SpectralSolver final : public PlateSolver {
 public:
  explicit SpectralSolver(const RunContext& context)
      : PlateSolver(context), plate_(context), motion_(plate_, context), load_(context.memory) {}

  Result<void> prepare(const PlateSystem& system) override {
    outline_ = system.outline;
    const Mirror mirror(outline_);
    if (!mirror.doubles()) return plate_.prepare(system);
    PlateSystem doubled = system;
    doubled.outline = mirror.outline();
    return plate_.prepare(doubled);
  }

  // With a transform to sine space and back.
  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(right_hand_sides.rows() == unknown_count(outline_));
    const Mirror mirror(outline_);
    if (mirror.doubles()) return solve_doubled(mirror, right_hand_sides);
    Field solution(right_hand_sides.rows(), 3);
    const long width = outline_.grid().columns - 2;
    plate_.solve({right_hand_sides.data(), width, right_hand_sides.rows()},
                 {solution.data(), width, solution.rows()});
    return solution;
  }

  Result<void> solve_for(const std::vector<int>& components, const Field& right_hand_sides,
                         std::span<const UnknownRun> runs, Field& solution) override {
    if (Mirror(outline_).doubles()) {
      return PlateSolver::solve_for(components, right_hand_sides, runs, solution);
    }
    const long width = outline_.grid().columns - 2;
    plate_.solve_for(components, {right_hand_sides.data(), width, right_hand_sides.rows()}, runs,
                     {solution.data(), width, solution.rows()});
    return {};
  }

  // Keeps the state in sine space for all steps.
  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override try {
    const Grid& grid = problem.outline.grid();
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    if (steps.are_exact()) return advance_exactly(problem, steps, std::move(state));
    // In sine space reflected steps find v from (rho/h) v + (rho/h^2 + eta/h) w: digits would be
    // lost.
    const bool is_overdamped =
        problem.dynamics.damping * steps.solved_length() > 100 * problem.dynamics.density;
    if (steps.are_reflected() && is_overdamped) {
      return PlateSolver::advance(problem, steps, std::move(state));
    }
    const double inertia = problem.dynamics.inertia(steps.solved_length());
    StageTimer set_up(context().profile, Stage::SetUp);
    if (auto prepared = prepare(problem.system(steps.solved_length())); !prepared) {
      return fail(prepared.error());
    }
    set_up.stop();
    const StageTimer solve(context().profile, Stage::Solve);
    if (auto taken = load_.take(problem); !taken) return fail(taken.error());
    subtract_rim(problem.outline, problem.stiffness, problem.tangents, state.displacement,
                 load_.nodes());

    const Mirror mirror(problem.outline);
    const bool is_done = mirror.doubles()
                             ? advance_doubled(mirror, inertia, steps, problem.watch, state)
                             : advance_alone(grid, inertia, steps, problem.watch, state);
    if (!is_done) return interrupted();
    clear_rim(problem.outline, state.velocity);
    return state;
  } catch (const std::bad_alloc&) {
    return fail(no_memory_to_solve(problem.outline.unknown_count(), "does not fit in memory"));
  }

  SolverCounts counts() const override { return plate_.counts() + motion_.counts(); }
  std::size_t memory() const override {
    return plate_.memory() + motion_.memory() + load_.memory();
  }

 private:
  static NodesView interior_view(const Grid& grid, Field& nodes) {
    return {nodes.data() + grid.node(1, 1), grid.columns, grid.node_count()};
  }
  static ConstNodesView interior_view(const Grid& grid, const Field& nodes) {
    return {nodes.data() + grid.node(1, 1), grid.columns, grid.node_count()};
  }

  Field solve_doubled(const Mirror& mirror, const Field& right_hand_sides) {
    const Field zero = Field::Zero(outline_.grid().node_count(), 3);
    const Field load = mirror.doubled(with_interior(outline_, zero, right_hand_sides));
    Field all = Field::Zero(load.rows(), 3);
    const Grid grid = mirror.outline().grid();
    plate_.solve(interior_view(grid, load), interior_view(grid, all));
    Field solution = zero;
    mirror.put_half(all, solution);
    return interior_of(outline_, solution);
  }

  using Watch = std::function<bool(const Field&)>;

  bool advance_alone(const Grid& grid, double inertia, const TimeSteps& steps, const Watch* watch,
                     PlateState& state) {
    std::function<bool()> ask;
    if (watch) ask = [&] { return (*watch)(state.displacement); };
    return plate_.advance(interior_view(grid, std::as_const(load_.nodes())), inertia, steps,
                          interior_view(grid, state.displacement),
                          interior_view(grid, state.velocity), ask);
  }

  bool advance_doubled(const Mirror& mirror, double inertia, const TimeSteps& steps,
                       const Watch* watch, PlateState& state) {
    const Grid grid = mirror.outline().grid();
    const Field load = mirror.doubled(load_.nodes());
    Field displacement = mirror.doubled(state.displacement);
    Field velocity = mirror.doubled(state.velocity);
    std::function<bool()> ask;
    if (watch) {
      ask = [&] {
        mirror.put_half(displacement, state.displacement);
        return (*watch)(state.displacement);
      };
    }
    if (!plate_.advance(interior_view(grid, load), inertia, steps,
                        interior_view(grid, displacement), interior_view(grid, velocity), ask)) {
      return false;
    }
    mirror.put_half(displacement, state.displacement);
    mirror.put_half(velocity, state.velocity);
    return true;
  }

  Result<PlateState> advance_exactly(const PlateProblem& problem, const TimeSteps& steps,
                                     PlateState state) {
    const StageTimer solve(context().profile, Stage::Solve);
    const Grid& grid = problem.outline.grid();
    first_load_ = problem.first_load;
    last_load_ = problem.load;
    subtract_rim(problem.outline, problem.stiffness, problem.first_tangents, state.displacement,
                 first_load_);
    subtract_rim(problem.outline, problem.stiffness, problem.tangents, state.displacement,
                 last_load_);
    const long first = grid.node(1, 1);
    const long count = grid.node_count();
    PlateSystem system{problem.outline, problem.stiffness};
    system.goal = problem.goal;
    auto done = motion_.advance(system, problem.dynamics, steps,
                                {first_load_.data() + first, grid.columns, count},
                                {last_load_.data() + first, grid.columns, count},
                                {state.displacement.data() + first, grid.columns, count},
                                {state.velocity.data() + first, grid.columns, count});
    if (!done) return fail(done.error());
    clear_rim(problem.outline, state.velocity);
    return state;
  }

  SpectralPlate plate_;
  SpectralMotion motion_;
  LoadCopy load_;
  Outline outline_;               // of the last system
  Field first_load_, last_load_;  // without the rim's part, for exact steps
};

}  // namespace

std::unique_ptr<PlateSolver> make_spectral_solver(const RunContext& context) {
  return std::make_unique<SpectralSolver>(context);
}

}  // namespace pliant
