#include <memory>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/energy/grid_assembly.hpp"
#include "pliant/plate/solver_factories.hpp"
#include "pliant/plate/sparse/sparse_plate.hpp"

namespace pliant {
namespace {

// Plates of any outline, edges and material. Sources: as `RefinedFactor`.
class SparseSolver final : public PlateSolver {
 public:
  SparseSolver(SolverChoice choice, const RunContext& context)
      : PlateSolver(context), plate_(choice, context) {}

  Result<void> prepare(const PlateSystem& system) override {
    if (auto assembled = assemble(system); !assembled) return assembled;
    return plate_.prepare(system.shift, system.drag);
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(assembly_ && right_hand_sides.rows() == assembly_->size());
    return plate_.solve(right_hand_sides);
  }

  Result<Field> solve_roughly(const Field& right_hand_sides) override {
    PLIANT_EXPECTS(assembly_ && right_hand_sides.rows() == assembly_->size());
    return plate_.solve_roughly(right_hand_sides);
  }

  Result<PlateState> advance(const PlateProblem& problem, const TimeSteps& steps,
                             PlateState state) override {
    PLIANT_EXPECTS(is_on_nodes(problem, state));
    StageTimer set_up(context().profile, Stage::SetUp);
    if (auto assembled = assemble(problem.system(steps.length)); !assembled)
      return fail(assembled.error());
    if (auto ready = plate_.prepare(problem.dynamics, steps); !ready) return fail(ready.error());
    set_up.stop();
    const StageTimer solving(context().profile, Stage::Solve);
    ForceChange forces{{}, assembly_->forces(problem.load, problem.tangents, state.displacement)};
    if (steps.are_exact()) {
      forces.first =
          assembly_->forces(problem.first_load, problem.first_tangents, state.displacement);
    }
    return with_motion(problem, steps, std::move(state),
                       [&](Motion& motion, const StepFilter& accepts) {
                         return plate_.advance(problem.dynamics, steps, forces, motion, accepts);
                       });
  }

  StepTerms terms(const PlateProblem& problem, double dt, const Field& displacement) override {
    return plate_.terms(assembly_->forces(problem.load, problem.tangents, displacement),
                        problem.dynamics, dt);
  }

  SolverCounts counts() const override { return plate_.counts(); }
  std::size_t memory() const override { return plate_.memory(); }

 private:
  Result<void> assemble(const PlateSystem& system) {
    if (assembly_ && assembly_->is_of(system)) return {};
    assembly_.emplace(system);
    auto assembled = plate_.assemble(*assembly_);
    if (!assembled) assembly_.reset();
    return assembled;
  }

  std::optional<GridAssembly> assembly_;  // of the plate; none after a failure
  SparsePlate plate_;
};

}  // namespace

std::unique_ptr<PlateSolver> make_sparse_solver(SolverChoice choice, const RunContext& context) {
  return std::make_unique<SparseSolver>(choice, context);
}

}  // namespace pliant
