#include "pliant/plate/contact/advance_with_contact.hpp"

#include <functional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/contact/contact_steps.hpp"
#include "pliant/plate/energy/grid_assembly.hpp"
#include "pliant/plate/sparse/plate_matrix.hpp"

namespace pliant {
namespace {

// Goes on from step to step as long as nothing touches.
class FreeSteps {
 public:
  FreeSteps(const Outline& outline, const TimeSteps& steps, StepContact& contact,
            const PlateState& from)
      : outline_(outline),
        steps_(steps),
        contact_(contact),
        motion_{interior_of(outline, from.displacement), interior_of(outline, from.velocity)} {}

  // Whether nothing touched on the way to `displacement`, of all nodes, in which a step ends.
  bool take(const Field& displacement) {
    Field next = interior_of(outline_, displacement);
    if (contact_.begin(count_, motion_.displacement, next)) return false;
    const double dt = steps_.solved_length();
    if (steps_.are_reflected()) {
      motion_.velocity = (next - motion_.displacement) / dt - motion_.velocity;
    } else {
      motion_.velocity = (next - motion_.displacement) / dt;
    }
    motion_.displacement = std::move(next);
    ++count_;
    return true;
  }

  int count() const { return count_; }
  Motion& motion() { return motion_; }

 private:
  const Outline& outline_;
  const TimeSteps& steps_;
  StepContact& contact_;
  Motion motion_;
  int count_ = 0;
};

Result<ContactPlate> contact_plate(PlateSolver& solver, const PlateProblem& problem, double dt,
                                   const Field& displacement) {
  const StageTimer set_up(solver.context().profile, Stage::SetUp);
  if (auto ready = solver.prepare(problem.system(dt)); !ready) return fail(ready.error());
  StepTerms terms = solver.terms(problem, dt, displacement);
  SolvedMatrix matrix = contact_matrix(solver, problem, dt, terms.shift);
  return ContactPlate{[&solver](const Field& forces) { return solver.solve(forces); },
                      std::move(matrix), std::move(terms), dt};
}

// The steps from `first` on, in which something touches.
Result<void> touch_on(PlateSolver& solver, PlateSolver& whole, ContactMemory& memory,
                      const PlateProblem& problem, const TimeSteps& steps, int first,
                      const Field& displacement, Motion& motion) {
  const auto plate = contact_plate(whole, problem, steps.length, displacement);
  if (!plate) return fail(plate.error());
  Result<ContactPlate> half;
  if (steps.are_reflected()) {
    half = contact_plate(solver, problem, steps.solved_length(), displacement);
    if (!half) return fail(half.error());
  }
  memory.keep_for(problem.system(steps.length));
  const StageTimer solving(solver.context().profile, Stage::Solve);
  for (int number = first; number < steps.count; ++number) {
    if (solver.context().is_stopped()) return interrupted();
    if (steps.are_reflected() && number > first) {
      const auto done = stands_without_contact(*half, number, *problem.contact, motion);
      if (!done) return fail(done.error());
      if (*done) continue;
    }
    auto stepped = step_with_contact(*plate, memory.problem, number, *problem.contact, motion);
    if (!stepped) return stepped;
  }
  return {};
}

}  // namespace

SolvedMatrix contact_matrix(PlateSolver& solver, const PlateProblem& problem, double dt,
                            const Eigen::VectorXd& shift) {
  const auto upper = [system = problem.system(dt), shift,
                      context = solver.context()]() -> Result<SparseMatrix> {
    const GridAssembly assembly(system);
    PlateMatrix matrix(context);
    if (auto assembled = matrix.assemble(assembly); !assembled) return fail(assembled.error());
    return matrix.shifted(shift);
  };
  return {shift.size(), [&solver](const Field& forces) { return solver.solve_roughly(forces); },
          upper};
}

void ContactMemory::keep_for(const PlateSystem& next) {
  if (system && *system == next) return;
  forget();
  system = next;
}

void ContactMemory::forget() {
  columns.forget();
  problem.forget();
  system.reset();
}

Result<PlateState> advance_with_contact(PlateSolver& solver, PlateSolver& whole,
                                        ContactMemory& memory, const PlateProblem& problem,
                                        const TimeSteps& steps, PlateState state) {
  PLIANT_EXPECTS(problem.contact && !problem.law && !steps.are_exact());
  FreeSteps free_steps(problem.outline, steps, *problem.contact, state);
  PlateProblem free = problem;
  free.contact = nullptr;
  bool touches = false;
  const std::function<bool(const Field&)> watch = [&](const Field& displacement) {
    touches = !free_steps.take(displacement);
    return !touches;
  };
  free.watch = &watch;
  auto advanced = solver.advance(free, steps, {state.displacement, state.velocity, {}});
  if (!advanced || !touches) return advanced;
  Motion& motion = free_steps.motion();
  auto done = touch_on(solver, whole, memory, problem, steps, free_steps.count(),
                       state.displacement, motion);
  if (!done) return fail(done.error());
  return with_interior(problem, std::move(state), motion.displacement, motion.velocity);
}

}  // namespace pliant
